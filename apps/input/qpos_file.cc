#include "apps/input/qpos_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/console/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

// Far above any row; keeps a stream without line breaks from eating the machine.
constexpr std::size_t kLongestLine = std::size_t{1} << 26;

constexpr char kByteOrderMark[] = "\xEF\xBB\xBF";

std::string Extension(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

bool IsText(const std::string& ending) { return ending == ".csv" || ending == ".txt"; }

// False at the end. The line break is not part of the line.
bool ReadLine(std::istream& stream, const std::string& what, std::string& line) {
  line.clear();
  for (int c = stream.get(); c != std::istream::traits_type::eof(); c = stream.get()) {
    if (c == '\n') return true;
    if (c == '\0') throw Error(what + ": is binary, neither text nor .npy");
    if (line.size() == kLongestLine) throw Error(what + ": a line of more than 64 MiB");
    line += static_cast<char>(c);
  }
  if (stream.bad()) throw Error(what + ": cannot be read");
  return !line.empty();
}

// `qpos` of a line that `solve` or `check` wrote.
std::vector<double> QposOf(const std::string& line, const std::string& origin) {
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object()) throw Error(origin + ": is not a JSON object");
  const auto found = json.find("qpos");
  if (found == json.end()) throw Error(origin + ": has no qpos");
  std::vector<double> row;
  for (const nlohmann::json& value : *found) {
    if (!value.is_number()) throw Error(origin + ": qpos holds something that is no number");
    row.push_back(value.get<double>());
  }
  return row;
}

void CheckRegularFile(const std::string& path) {
  std::error_code ec;
  const fs::file_status status = fs::status(path, ec);
  if (!fs::status_known(status)) throw Error(path + ": " + ec.message());
  if (!fs::exists(status)) throw Error(path + ": no such file");
  if (fs::is_directory(status)) throw Error(path + ": is a directory");
  const std::string ending = Extension(path);
  // A pipe (/dev/fd/63) has no ending: its content tells.
  if (fs::is_regular_file(status) && ending != ".npy" && ending != ".jsonl" && !IsText(ending)) {
    throw Error(path + ": a file of configurations must end in .npy, .csv, .txt or .jsonl");
  }
}

// A file on disk must hold what its header says, no less and no more. It is mapped.
void MapFile(const std::string& path, std::size_t data_begin, NpyReader& npy) {
  std::error_code ec;
  if (path == "-" || !fs::is_regular_file(path, ec)) return;
  const std::size_t available = fs::file_size(path) - data_begin;
  if (available != npy.data_bytes()) {
    throw Error(path + ": " + std::to_string(available) +
                " bytes of data, but the .npy header says " + npy.Shape());
  }
  npy.Map(path, data_begin);
}

}  // namespace

QposFile::QposFile(const std::string& path, std::size_t width)
    : what_(path == "-" ? "stdin" : path), width_(width), json_(Extension(path) == ".jsonl") {
  if (path == "-") {
    stream_ = &std::cin;
  } else {
    CheckRegularFile(path);
    file_.open(path, std::ios::binary);
    if (!file_) throw Error(path + ": cannot be opened");
    stream_ = &file_;
  }
  const int first = stream_->peek();
  if (first == std::istream::traits_type::eof()) throw Error(what_ + ": is empty");
  if (static_cast<char>(first) == kNpyBegin || Extension(path) == ".npy") {
    npy_.emplace(*stream_, what_);
    MapFile(path, static_cast<std::size_t>(stream_->tellg()), *npy_);
    if (npy_->rows() > 0 && npy_->width() != width_) {
      throw Error(what_ + " row 0: " + std::to_string(npy_->width()) + " values, the model needs " +
                  std::to_string(width_));
    }
  }
}

std::optional<std::size_t> QposFile::size() const {
  if (npy_) return npy_->rows();
  std::error_code ec;
  if (!fs::is_regular_file(what_, ec)) return std::nullopt;
  std::ifstream file(what_, std::ios::binary);
  std::vector<char> piece(std::size_t{1} << 16);
  std::size_t lines = 0;
  do {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    lines += static_cast<std::size_t>(std::count(piece.data(), piece.data() + file.gcount(), '\n'));
  } while (file);
  return lines;
}

bool QposFile::Next(std::vector<double>& row, std::string& origin) {
  if (npy_) {
    origin = what_ + " row " + std::to_string(rows_);
    if (!npy_->Next(row)) row.clear();
  } else if (!NextLine(row, origin)) {
    row.clear();
  }
  if (row.empty()) {
    if (rows_ == 0) throw Error(what_ + ": holds no configuration");
    return false;
  }
  ++rows_;
  if (row.size() != width_) {
    throw Error(origin + ": " + std::to_string(row.size()) + " values, the model needs " +
                std::to_string(width_));
  }
  return true;
}

// The next line with something on it.
bool QposFile::NextLine(std::vector<double>& row, std::string& origin) {
  while (ReadLine(*stream_, what_, line_)) {
    ++line_number_;
    std::string_view text = line_;
    if (line_number_ == 1 && text.starts_with(kByteOrderMark)) text.remove_prefix(3);
    if (text.starts_with('#')) continue;  // numpy.savetxt writes its header so
    origin = what_ + " line " + std::to_string(line_number_);
    const bool json = json_ || text.starts_with('{');
    row = json ? QposOf(std::string(text), origin) : ParseNumbers(text, origin);
    if (!row.empty()) return true;
  }
  return false;
}

void CheckQposFileName(const std::string& flag, const std::string& path) {
  if (path.empty() || path == "-") return;
  const std::string ending = Extension(path);
  if (ending != ".npy" && ending != ".jsonl" && !IsText(ending)) {
    throw Error(flag + ": " + path + " must end in .npy, .csv, .txt or .jsonl");
  }
}

bool IsNpyFile(const std::string& path) { return Extension(path) == ".npy"; }

std::string FormatQposRow(const std::vector<double>& row, const std::string& path) {
  if (IsNpyFile(path)) {
    std::string bytes(row.size() * sizeof(double), '\0');
    std::memcpy(bytes.data(), row.data(), bytes.size());
    return bytes;
  }
  const std::string ending = Extension(path);
  if (ending == ".jsonl") return nlohmann::json({{"qpos", row}}).dump() + '\n';
  const char separator = ending == ".csv" ? ',' : ' ';
  std::string text;
  for (std::size_t i = 0; i < row.size(); ++i) {
    char number[32];
    // The shortest digits that read back as the same number.
    const auto [end, ec] = std::to_chars(number, number + sizeof number, row[i]);
    if (i > 0) text += separator;
    text.append(number, end);
  }
  return text + '\n';
}

}  // namespace mjcf_pdg::app
