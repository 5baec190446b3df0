#include "apps/output/row_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace mjcf_pdg::app {
namespace {

// False, with errno set, if not all bytes could be written.
bool WriteAll(int descriptor, const std::string& bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t n = ::write(descriptor, bytes.data() + written, bytes.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    written += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

RowFile::RowFile(std::string path, std::size_t size) : path_(std::move(path)), size_(size) {}

RowFile::~RowFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void RowFile::Open() {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw std::runtime_error(path_ + ": " + std::strerror(errno));
  // Devices and pipes have no length.
  if (::ftruncate(descriptor_, static_cast<off_t>(size_)) == 0) {
    ::lseek(descriptor_, 0, SEEK_END);
  }
}

void RowFile::Append(const std::string& row) {
  if (descriptor_ < 0) Open();
  if (!WriteAll(descriptor_, row)) {
    const std::string why = std::strerror(errno);
    if (::ftruncate(descriptor_, static_cast<off_t>(size_)) == 0) {
      ::lseek(descriptor_, 0, SEEK_END);
    }
    throw std::runtime_error(path_ + ": " + why);
  }
  size_ += row.size();
}

void RowFile::Overwrite(const std::string& begin) {
  if (descriptor_ < 0) return;
  if (::pwrite(descriptor_, begin.data(), begin.size(), 0) != static_cast<ssize_t>(begin.size())) {
    throw std::runtime_error(path_ + ": " + std::strerror(errno));
  }
}

}  // namespace mjcf_pdg::app
