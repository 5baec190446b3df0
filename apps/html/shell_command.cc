#include "apps/html/shell_command.h"

#include <nlohmann/json.hpp>

namespace mjcf_pdg::app {
namespace {

std::string Quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_./,=:+-") == std::string::npos;
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string ShellCommand(const std::vector<std::string>& words) {
  std::string command = "mjcf-pdg";
  for (const std::string& word : words) command += " " + Quoted(word);
  return command;
}

std::string NormCommand(const std::string& model, const std::vector<std::string>& options) {
  std::vector<std::string> words = {"norm", model};
  words.insert(words.end(), options.begin(), options.end());
  return ShellCommand(words);
}

std::string QposWords(const std::vector<double>& q) {
  std::string numbers;
  for (const double value : q) {
    numbers += (numbers.empty() ? "" : " ") + nlohmann::json(value).dump();
  }
  return numbers;
}

std::string RowCommand::Of(const Configuration& row, const std::string& output) const {
  std::vector<std::string> all = words;
  all.insert(all.end(), options.begin(), options.end());
  if (row.mocap_pos.empty()) {
    all.insert(all.end(), {"--qpos", QposWords(row.q)});
  } else {
    all.insert(all.end(), {"--key", std::to_string(row.key)});
  }
  all.insert(all.end(), {output, "-"});
  return ShellCommand(all);
}

}  // namespace mjcf_pdg::app
