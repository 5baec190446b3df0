#include "apps/output/output_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "apps/console/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

void WriteFile(const std::string& path, const std::string& content, const char* mode) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), mode), std::fclose);
  bool good = file && std::fwrite(content.data(), 1, content.size(), file.get()) == content.size();
  if (file) good = std::fclose(file.release()) == 0 && good;
  if (!good) throw std::runtime_error(path + ": cannot be written");
}

// The absolute path without symbolic links, also of a file that does not exist yet.
fs::path Resolve(const std::string& path) {
  std::error_code ec;
  const fs::path absolute = fs::absolute(path, ec);
  fs::path resolved = fs::weakly_canonical(absolute, ec);
  return ec ? absolute : resolved;
}

bool SameFile(const std::string& a, const std::string& b) {
  std::error_code ec;
  return fs::equivalent(a, b, ec) || Resolve(a) == Resolve(b);
}

// The name of a hidden file beside the target: there, renaming does not cross file systems, and
// relative paths inside the file stay right.
std::string HiddenName(const fs::path& target) {
  const std::string name = "." + target.stem().string() + "." + std::to_string(::getpid()) +
                           ".tmp" + target.extension().string();
  return (target.parent_path() / name).string();
}

// Throws Error if the hidden file cannot be made. Trying is the only sure way to know.
void TryWriting(const std::string& complaint, const std::string& hidden) {
  try {
    WriteFile(hidden, "", "wxb");
  } catch (const std::runtime_error&) {
    throw Error(complaint + ": cannot be written");
  }
  std::error_code ec;
  fs::remove(hidden, ec);
}

}  // namespace

OutputFiles::~OutputFiles() {
  for (const Output& output : outputs_) {
    std::error_code ec;
    if (!output.staged.empty() && !output.rows) fs::remove(output.staged, ec);
  }
  for (auto folder = new_folders_.rbegin(); folder != new_folders_.rend(); ++folder) {
    std::error_code ec;
    fs::remove(*folder, ec);  // the inner ones are the later ones
  }
}

void OutputFiles::AddFolder(const std::string& flag, const std::string& path) {
  const std::string complaint = flag + ": " + path;
  const fs::path target = Resolve(path);
  std::error_code ec;
  if (!fs::is_directory(target.parent_path(), ec)) {
    throw Error(flag + ": " + target.parent_path().string() + ": no such folder");
  }
  if (fs::is_directory(target, ec)) return;
  if (fs::exists(target, ec)) throw Error(complaint + ": is not a folder");
  if (!fs::create_directory(target, ec)) throw Error(complaint + ": cannot be made");
  new_folders_.push_back(target.string());
}

void OutputFiles::Add(const std::string& flag, const std::string& path,
                      const std::vector<std::string>& inputs) {
  if (path.empty()) return;
  Output output{flag, path, path, "", "", nullptr};
  const std::string complaint = flag + ": " + path;
  const bool to_stdout = path == "-";
  for (const Output& other : outputs_) {
    const bool same =
        to_stdout ? other.path == "-" : other.path != "-" && SameFile(other.path, path);
    if (same) throw Error(complaint + ": " + other.flag + " already writes there");
  }
  if (!to_stdout) {
    for (const std::string& input : inputs) {
      if (SameFile(input, path)) throw Error(complaint + ": is an input file");
    }
    std::error_code ec;
    const fs::file_status status = fs::status(path, ec);
    if (fs::is_directory(status)) throw Error(complaint + ": is a directory");
    const fs::path target = Resolve(path);
    if (!fs::is_directory(target.parent_path(), ec)) throw Error(complaint + ": no such folder");
    if (fs::exists(status) && ::access(path.c_str(), W_OK) != 0) {
      throw Error(complaint + ": cannot be written");
    }
    output.target = target.string();
    // A device or a pipe is written directly, because renaming a file to it would replace it.
    if (!fs::exists(status) || fs::is_regular_file(status)) {
      output.staged = HiddenName(target);
      TryWriting(complaint, output.staged);
    }
  }
  outputs_.push_back(std::move(output));
}

bool OutputFiles::uses_stdout() const {
  return std::any_of(outputs_.begin(), outputs_.end(),
                     [](const Output& output) { return output.path == "-"; });
}

OutputFiles::Output& OutputFiles::Find(const std::string& path) {
  const auto found = std::find_if(outputs_.begin(), outputs_.end(),
                                  [&](const Output& output) { return output.path == path; });
  if (found == outputs_.end()) throw std::logic_error("output " + path + " was not added");
  return *found;
}

void OutputFiles::Stage(const std::string& path, const std::string& content) {
  if (path.empty()) return;
  Output& output = Find(path);
  if (output.staged.empty()) {
    output.stream_content = content;
  } else {
    WriteFile(output.staged, content, "wb");
  }
}

std::string OutputFiles::StagedName(const std::string& path) {
  const Output& output = Find(path);
  if (output.staged.empty()) throw Error(output.flag + ": " + path + " is not a file");
  return output.staged;
}

void OutputFiles::Stream(const std::string& path, std::size_t kept) {
  if (path.empty() || path == "-") return;
  Output& output = Find(path);
  if (!output.staged.empty()) output.staged = PartName(output.target);
  output.rows =
      std::make_unique<RowFile>(output.staged.empty() ? output.target : output.staged, kept);
}

void OutputFiles::Append(const std::string& path, const std::string& row) {
  if (path.empty()) return;
  if (path == "-") {
    WriteStdout(row);
  } else {
    Find(path).rows->Append(row);
  }
}

void OutputFiles::Overwrite(const std::string& path, const std::string& begin) {
  if (!path.empty() && path != "-") Find(path).rows->Overwrite(begin);
}

void OutputFiles::Commit() {
  for (Output& output : outputs_) {
    if (output.staged.empty()) continue;
    struct stat old{};
    if (::stat(output.target.c_str(), &old) == 0)
      ::chmod(output.staged.c_str(), old.st_mode & 07777);
  }
  for (const Output& output : outputs_) {
    if (output.path == "-") {
      if (!output.stream_content.empty()) WriteStdout(output.stream_content);
    } else if (!output.stream_content.empty()) {
      WriteFile(output.target, output.stream_content, "wb");
    }
  }
  for (Output& output : outputs_) {
    std::error_code ec;
    if (output.staged.empty() || !fs::exists(output.staged, ec)) continue;
    fs::rename(output.staged, output.target, ec);
    if (ec) throw std::runtime_error(output.path + ": cannot be written: " + ec.message());
    output.staged.clear();
  }
  new_folders_.clear();
}

}  // namespace mjcf_pdg::app
