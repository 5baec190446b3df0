// A file mapped into memory window by window: of files larger than memory, no more than a window
// counts as this process's.
#ifndef MJCF_PDG_APPS_INPUT_MAPPED_FILE_H_
#define MJCF_PDG_APPS_INPUT_MAPPED_FILE_H_

#include <cstddef>
#include <string>

namespace mjcf_pdg::app {

class MappedFile {
 public:
  // Throws Error if the file cannot be opened.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  // `count` bytes from `begin` on, valid until the next call; null if the file has fewer by now (to
  // read those of a mapping would end the process) or they cannot be mapped.
  const char* Bytes(std::size_t begin, std::size_t count);

 private:
  void Unmap();

  int descriptor_ = -1;
  char* window_ = nullptr;
  std::size_t window_begin_ = 0, window_size_ = 0;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_INPUT_MAPPED_FILE_H_
