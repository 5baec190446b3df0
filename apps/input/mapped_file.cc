#include "apps/input/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

// Mapping one anew takes microseconds, reading it milliseconds [bytes].
constexpr std::size_t kWindow = std::size_t{1} << 24;

}  // namespace

MappedFile::MappedFile(const std::string& path)
    : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw Error(path + ": cannot be opened");
}

MappedFile::~MappedFile() {
  Unmap();
  ::close(descriptor_);
}

void MappedFile::Unmap() {
  if (window_) ::munmap(window_, window_size_);
  window_ = nullptr;
}

const char* MappedFile::Bytes(std::size_t begin, std::size_t count) {
  struct stat status = {};
  if (::fstat(descriptor_, &status) != 0) return nullptr;
  const std::size_t size = static_cast<std::size_t>(status.st_size);
  if (begin > size || count > size - begin) return nullptr;
  const bool inside = window_ && begin >= window_begin_ && count <= window_size_ &&
                      begin - window_begin_ <= window_size_ - count;
  if (!inside) {
    Unmap();
    const std::size_t page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    window_begin_ = begin / page * page;
    window_size_ = std::min(std::max(kWindow, begin - window_begin_ + count), size - window_begin_);
    void* const mapped = ::mmap(nullptr, window_size_, PROT_READ, MAP_PRIVATE, descriptor_,
                                static_cast<off_t>(window_begin_));
    if (mapped == MAP_FAILED) return nullptr;
    window_ = static_cast<char*>(mapped);
  }
  return window_ + (begin - window_begin_);
}

}  // namespace mjcf_pdg::app
