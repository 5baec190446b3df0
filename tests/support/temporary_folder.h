// A folder for the files of a test.
#ifndef MJCF_PDG_TESTS_SUPPORT_TEMPORARY_FOLDER_H_
#define MJCF_PDG_TESTS_SUPPORT_TEMPORARY_FOLDER_H_

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

namespace mjcf_pdg::test {

// Makes a new folder below GoogleTest's TempDir() and removes it, with its content, in the
// destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = ::testing::TempDir() + "mjcf_pdg_" + std::string(6, 'X');  // for mkdtemp
    if (!mkdtemp(pattern.data())) throw std::system_error(errno, std::generic_category(), pattern);
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_TEMPORARY_FOLDER_H_
