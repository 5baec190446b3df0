// Output files that appear only when they are complete, and only after all are staged and standard
// output is written.
#ifndef MJCF_PDG_APPS_OUTPUT_FILES_H_
#define MJCF_PDG_APPS_OUTPUT_FILES_H_

#include <string>
#include <vector>

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
  // Writes streams (stdout, devices), then renames all hidden files to their targets. Throws
  // std::runtime_error if one of these fails.
  void Commit();

 private:
  struct Output {
    std::string flag;
    std::string path;    // as given
    std::string target;  // symbolic links resolved
    std::string staged;  // hidden file; empty: a stream (stdout, a device), written by Commit
    std::string stream_content;
  };

  Output& Find(const std::string& path);

  std::vector<Output> outputs_;
  std::vector<std::string> new_folders_;  // folders that AddFolder has made, absolute paths
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_FILES_H_
