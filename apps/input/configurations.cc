#include "apps/input/configurations.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "apps/console/text.h"
#include "apps/input/qpos_file.h"
#include "apps/options.h"

namespace mjcf_pdg::app {
namespace {

std::string ValidKeys(const std::vector<std::string>& names) {
  constexpr std::size_t kEnough = 300;
  if (names.empty()) return "the model has no keyframes";
  std::string list;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (list.size() > kEnough) {
      list += ", ...";
      break;
    }
    list += (list.empty() ? "" : ", ") + (names[k].empty() ? std::to_string(k) : names[k]);
  }
  return "keyframes: " + list;
}

// The index of a keyframe by its name or else its index. Names come first, so that a keyframe
// called "2" can be asked for. -1 if there is none.
int KeyIndex(const std::vector<std::string>& names, const std::string& wanted) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!wanted.empty() && names[k] == wanted) return static_cast<int>(k);
  }
  int index = -1;
  const char* const last = wanted.data() + wanted.size();
  const auto [end, ec] = std::from_chars(wanted.data(), last, index);
  const bool is_index = ec == std::errc() && end == last && index >= 0;
  return is_index && index < static_cast<int>(names.size()) ? index : -1;
}

// The same. Throws Error if there is none.
int FindKey(const std::vector<std::string>& names, const std::string& wanted) {
  if (const int key = KeyIndex(names, wanted); key >= 0) return key;
  throw Error("--key: no keyframe '" + wanted + "' (" + ValidKeys(names) + ")");
}

// A label for an unnamed keyframe. Labels become names of keyframes in the output, so it must not
// be the name of another keyframe.
std::string UnnamedKeyLabel(const std::vector<std::string>& names, int key) {
  std::string label = "key" + std::to_string(key);
  while (std::find(names.begin(), names.end(), label) != names.end()) label += '_';
  return label;
}

Configuration FromKey(const Scene& scene, const std::vector<std::string>& names, int key) {
  Configuration configuration;
  configuration.key = key;
  configuration.name = names[static_cast<std::size_t>(key)];
  configuration.label =
      configuration.name.empty() ? UnnamedKeyLabel(names, key) : configuration.name;
  configuration.q = scene.KeyQpos(key);
  const mjModel& m = *scene.model();
  const std::ptrdiff_t n = m.nmocap;
  if (n > 0) {
    const double* pos = m.key_mpos + 3 * n * key;
    const double* quat = m.key_mquat + 4 * n * key;
    configuration.mocap_pos.assign(pos, pos + 3 * n);
    configuration.mocap_quat.assign(quat, quat + 4 * n);
  }
  return configuration;
}

void CheckRow(const Scene& scene, const std::vector<double>& q, const std::string& origin) {
  try {
    scene.CheckConfiguration(q);
  } catch (const Error& e) {
    throw Error(origin + ": " + e.what());
  }
}

std::vector<Configuration> FromFlags(const Scene& scene, const std::vector<std::string>& texts) {
  std::vector<Configuration> configurations(texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    configurations[i].q = ParseNumbers(texts[i], "--qpos");
    CheckRow(scene, configurations[i].q, "--qpos");
    configurations[i].label = "row" + std::to_string(i);
  }
  return configurations;
}

// The named keyframes; without names all of them, or qpos0 if there are none.
std::vector<Configuration> FromKeys(const Scene& scene, const std::vector<std::string>& wanted) {
  const std::vector<std::string> names = scene.KeyNames();
  std::vector<int> keys;
  for (const std::string& key : wanted) keys.push_back(FindKey(names, key));
  if (wanted.empty()) {
    for (std::size_t k = 0; k < names.size(); ++k) keys.push_back(static_cast<int>(k));
  }
  std::vector<Configuration> configurations;
  for (const int key : keys) configurations.push_back(FromKey(scene, names, key));
  if (configurations.empty()) {
    Configuration configuration;
    configuration.label = "qpos0";
    configuration.q = scene.DefaultQpos();
    configurations.push_back(std::move(configuration));
  }
  for (const Configuration& configuration : configurations) {
    const std::string kind = configuration.key < 0 ? "" : "keyframe ";
    CheckRow(scene, configuration.q, kind + "'" + configuration.label + "'");
  }
  return configurations;
}

}  // namespace

void AddWhich(CLI::App& command, WhichArguments& arguments) {
  CLI::Option* key = command
                         .add_option("--key", arguments.keys,
                                     "a keyframe; may be repeated (default: all, or qpos0)")
                         ->type_name("NAME|INDEX");
  CLI::Option* qpos =
      command.add_option("--qpos", arguments.qpos, "nq numbers in quotes; may be repeated")
          ->type_name("\"V V ...\"");
  CLI::Option* file = AddPath(
      command, "--qpos-file",
      ".npy (floats, n x nq), .csv or .txt, one configuration a row, or .jsonl of ours; - is stdin",
      arguments.file);
  file->type_name("FILE|-");
  key->allow_extra_args(false);
  qpos->allow_extra_args(false);
  key->excludes(qpos)->excludes(file);
  qpos->excludes(file);
}

RowSource::RowSource(const Scene& scene, const WhichArguments& arguments) : scene_(scene) {
  if (!arguments.qpos.empty()) {
    listed_ = FromFlags(scene, arguments.qpos);
  } else if (!arguments.file.empty()) {
    file_ = std::make_unique<QposFile>(arguments.file, static_cast<std::size_t>(scene.nq()));
  } else {
    listed_ = FromKeys(scene, arguments.keys);
  }
}

bool RowSource::Next(Configuration& row) {
  if (!file_) {
    if (next_ == listed_.size()) return false;
    row = listed_[next_++];
    return true;
  }
  if (!file_->Next(row.q, origin_)) return false;
  CheckRow(scene_, row.q, origin_);
  row.label = "row" + std::to_string(next_++);
  return true;
}

std::optional<std::size_t> RowSource::size() const {
  return file_ ? file_->size() : listed_.size();
}

namespace {

// A number, "nan" and "inf" included, and then what parts it from the next.
bool BeginsWithNumber(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return end != text.c_str() && std::string(", \t").find(*end) != std::string::npos;
}

// Whether a text that is no keyframe's name was meant to be one: it is an index, a single word, or
// begins with a word.
bool MeansName(const std::string& text, int entries) {
  constexpr const char *kDigits = "0123456789", *kNumbers = "0123456789+-.eE, \t";
  if (text.find_first_not_of(kDigits) == std::string::npos) return entries > 1;  // an index
  const bool listed = text.find_first_of(", \t") != std::string::npos;
  const bool other = text.find_first_not_of(kNumbers) != std::string::npos;
  return other && (!listed || !BeginsWithNumber(text));
}

}  // namespace

Configuration ReadConfiguration(const Scene& scene, const std::string& text,
                                const std::string& flag) {
  const std::vector<std::string> names = scene.KeyNames();
  const bool named = std::find(names.begin(), names.end(), text) != names.end();
  Configuration configuration;
  if (const int key = KeyIndex(names, text); key >= 0 && (named || scene.nq() > 1)) {
    configuration = FromKey(scene, names, key);
  } else if (MeansName(text, scene.nq())) {
    throw Error(flag + ": no keyframe '" + text + "' (" + ValidKeys(names) + ")");
  } else {
    configuration.q = ParseNumbers(text, flag);
    configuration.label = flag.substr(flag.find_first_not_of('-'));
  }
  CheckRow(scene, configuration.q, flag);
  return configuration;
}

std::vector<CLI::Option*> AddEnds(CLI::App& command, EndsArguments& arguments) {
  std::vector<CLI::Option*> options;
  for (auto [flag, target] : {std::pair{"--from", &arguments.from}, {"--to", &arguments.to}}) {
    options.push_back(command.add_option(flag, *target, "a configuration: nq numbers in quotes")
                          ->type_name("\"V V ...\""));
  }
  return options;
}

Ends ReadEnds(const Scene& scene, const EndsArguments& arguments) {
  Ends ends{ParseNumbers(arguments.from, "--from"), ParseNumbers(arguments.to, "--to")};
  CheckRow(scene, ends.from, "--from");
  CheckRow(scene, ends.to, "--to");
  return ends;
}

}  // namespace mjcf_pdg::app
