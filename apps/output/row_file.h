// A file that grows by whole rows, whatever ends the program: what stands in it can be gone on
// with.
#ifndef MJCF_PDG_APPS_OUTPUT_ROW_FILE_H_
#define MJCF_PDG_APPS_OUTPUT_ROW_FILE_H_

#include <cstddef>
#include <string>

namespace mjcf_pdg::app {

class RowFile {
 public:
  // `path`: a file, or a device or pipe that exists. Made at the first Append; `size` bytes of what
  // the file holds are kept.
  explicit RowFile(std::string path, std::size_t size = 0);
  ~RowFile();
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;

  // Writes the row as one piece. If the disk does not take it, the file ends with the row before,
  // and std::runtime_error is thrown.
  void Append(const std::string& row);
  // Replaces the file's first bytes, once there is a file.
  void Overwrite(const std::string& begin);

 private:
  void Open();

  const std::string path_;
  std::size_t size_;
  int descriptor_ = -1;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_ROW_FILE_H_
