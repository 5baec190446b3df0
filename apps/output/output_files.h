// Output files that appear whole, and none before all are staged and standard output is written.
// Outputs of many rows are streamed: they grow as PATH.part, and become PATH when they are whole.
#ifndef MJCF_PDG_APPS_OUTPUT_OUTPUT_FILES_H_
#define MJCF_PDG_APPS_OUTPUT_OUTPUT_FILES_H_

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "apps/output/row_file.h"

namespace mjcf_pdg::app {

// The outputs of one run. Add every output, Stage its content into a hidden file beside its target,
// then Commit, which renames all of them. The destructor removes what was staged but not committed.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  // Makes the folder `path` for outputs that are added later, unless it exists. Without Commit a
  // folder that was made is removed again. Throws Error if it cannot be made.
  void AddFolder(const std::string& flag, const std::string& path);
  // Adds the output of a flag; "-" is stdout, and an empty path is ignored. Throws Error if `path`
  // cannot be written, is one of the files `inputs`, or was added before.
  void Add(const std::string& flag, const std::string& path,
           const std::vector<std::string>& inputs);
  bool uses_stdout() const;

  // Keeps the content of an output that was added, for Commit; does nothing if `path` is empty.
  // Throws std::runtime_error if the disk does not take it.
  void Stage(const std::string& path, const std::string& content);
  // The name of the output's hidden file, for writers that need a file name: it is in the folder of
  // the output and has its ending. The caller creates the file. Throws Error if the output is a
  // stream.
  std::string StagedName(const std::string& path);

  // The output gets its content row by row: in PATH.part, of which `kept` bytes stay, or at once if
  // it is a stream. The file is made by the first row and stays if there is no Commit.
  void Stream(const std::string& path, std::size_t kept = 0);
  static std::string PartName(const std::string& path) { return path + ".part"; }
  // No-op for an empty path. Throws std::runtime_error when the disk does not take the row.
  void Append(const std::string& path, const std::string& row);
  // Replaces the first bytes of a streamed file.
  void Overwrite(const std::string& path, const std::string& begin);

  // Outputs without content are not written.
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
  std::vector<std::string> new_folders_;  // folders that AddFolder has made, absolute paths
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_OUTPUT_FILES_H_
