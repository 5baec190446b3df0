#include "apps/qpos_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "apps/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

// Largest input [bytes]: far above any use, so that an endless stream does not fill the memory.
constexpr std::size_t kMaxBytes = std::size_t{1} << 31;

std::string Extension(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

bool IsText(const std::string& ending) { return ending == ".csv" || ending == ".txt"; }

std::string ReadAll(std::FILE* file, const std::string& what) {
  std::string bytes;
  char buffer[65536];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, file)) {
    bytes.append(buffer, n);
    if (bytes.size() > kMaxBytes) throw Error(what + ": larger than 2 GiB");
  }
  if (std::ferror(file)) throw Error(what + ": cannot be read");
  return bytes;
}

std::string ReadBytes(const std::string& path) {
  if (path == "-") return ReadAll(stdin, "stdin");
  std::error_code ec;
  const fs::file_status status = fs::status(path, ec);
  if (!fs::exists(status)) throw Error(path + ": no such file");
  if (fs::is_directory(status)) throw Error(path + ": is a directory");
  const std::string ending = Extension(path);
  // A pipe (/dev/fd/63) has no ending; its content shows the format.
  if (fs::is_regular_file(status) && ending != ".npy" && !IsText(ending)) {
    throw Error(path + ": a file of configurations must end in .npy, .csv or .txt");
  }
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw Error(path + ": cannot be opened");
  return ReadAll(file.get(), path);
}

QposFile ParseText(std::string_view text, const std::string& what) {
  if (text.find('\0') != std::string_view::npos) {
    throw Error(what + ": is binary, neither text nor .npy");
  }
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);  // byte order mark
  QposFile file;
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.substr(0, 1) == "#") continue;  // as numpy.savetxt begins header lines
    const std::string origin = what + " line " + std::to_string(line_number);
    std::vector<double> row = ParseNumbers(line, origin);
    if (row.empty()) continue;
    file.rows.push_back(std::move(row));
    file.origin.push_back(origin);
  }
  return file;
}

QposFile ParseBytes(const std::string& bytes, const std::string& path, const std::string& what) {
  if (!IsNpy(bytes)) {
    if (Extension(path) == ".npy") throw Error(what + ": is not a .npy file");
    return ParseText(bytes, what);
  }
  QposFile file;
  file.rows = ParseNpy(bytes, what);
  for (std::size_t i = 0; i < file.rows.size(); ++i) {
    file.origin.push_back(what + " row " + std::to_string(i));
  }
  return file;
}

}  // namespace

QposFile ReadQposFile(const std::string& path, std::size_t width) {
  const std::string what = path == "-" ? "stdin" : path;
  const std::string bytes = ReadBytes(path);
  if (bytes.empty()) throw Error(what + ": is empty");
  QposFile file = ParseBytes(bytes, path, what);
  if (file.rows.empty()) throw Error(what + ": holds no configuration");
  for (std::size_t i = 0; i < file.rows.size(); ++i) {
    if (file.rows[i].size() == width) continue;
    throw Error(file.origin[i] + ": " + std::to_string(file.rows[i].size()) +
                " values, the model needs " + std::to_string(width));
  }
  return file;
}

void CheckQposFileName(const std::string& flag, const std::string& path) {
  if (path.empty() || path == "-") return;
  const std::string ending = Extension(path);
  if (ending != ".npy" && !IsText(ending)) {
    throw Error(flag + ": " + path + " must end in .npy, .csv or .txt");
  }
}

std::string FormatQposFile(const Rows& rows, std::size_t width, const std::string& path) {
  const std::string ending = Extension(path);
  if (ending == ".npy") return FormatNpy(rows, width);
  const char separator = ending == ".csv" ? ',' : ' ';
  std::string text;
  for (const std::vector<double>& row : rows) {
    for (std::size_t i = 0; i < width; ++i) {
      char number[32];
      // The shortest digits that read back as the same number.
      const auto [end, ec] = std::to_chars(number, number + sizeof number, row[i]);
      if (i > 0) text += separator;
      text.append(number, end);
    }
    text += '\n';
  }
  return text;
}

}  // namespace mjcf_pdg::app
