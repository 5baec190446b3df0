// Output files that appear whole, and none before all are staged and standard output is written.
// Outputs of many rows are streamed: they grow as PATH.part, and become PATH when they are whole.
#ifndef MJCF_PDG_APPS_OUTPUT_FILES_H_
#define MJCF_PDG_APPS_OUTPUT_FILES_H_

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "apps/row_file.h"

namespace mjcf_pdg::app {

// Use: Add every output, stage its content into a hidden file beside it, then Commit renames all.
// What was staged and not committed is removed.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  // For outputs that are added later. Made if there is none, and then gone again without Commit.
  void AddFolder(const std::string& flag, const std::string& path);
  // Throws Error if `path` cannot be written, is one of `inputs`, or was added before. An empty
  // path is ignored. "-" is stdout.
  void Add(const std::string& flag, const std::string& path,
           const std::vector<std::string>& inputs);
  bool uses_stdout() const;

  // No-op for an empty path. Throws std::runtime_error when the disk does not take it.
  void Stage(const std::string& path, const std::string& content);
  // For writers that want a file name: the hidden file's, in the folder of the output and with its
  // ending. The caller creates it.
  std::string StagedName(const std::string& path);

  // The output gets its content row by row: in PATH.part, of which `kept` bytes stay, or at once if
  // it is a stream. The file is made by the first row and stays if there is no Commit.
  void Stream(const std::string& path, std::size_t kept = 0);
  static std::string PartName(const std::string& path) { return path + ".part"; }
  // No-op for an empty path. Throws std::runtime_error when the disk does not take the row.
  void Append(const std::string& path, const std::string& row);
  // Replaces the first bytes of a streamed file.
  void Overwrite(const std::string& path, const std::string& begin);

  void Commit();

 private:
  struct Output {
    std::string flag;
    std::string path;    // as given
    std::string target;  // symbolic links resolved
    std::string staged;  // hidden file; empty: a stream (stdout, a device), written by Commit
    std::string stream_content;
    std::unique_ptr<RowFile> rows;  // null: not streamed, or stdout
  };

  Output& Find(const std::string& path);

  std::vector<Output> outputs_;
  std::vector<std::string> new_folders_;  // absolute
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_FILES_H_
