// Files of configurations larger than what is held of them in memory.
#include "apps/input/qpos_file.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "mjcf_pdg/types.h"
#include "tests/support/temporary_folder.h"

namespace mjcf_pdg::test {
namespace {

constexpr std::size_t kWidth = 7, kRows = 800000;  // 45 MB, three windows of the mapping

double Value(std::size_t row, std::size_t k) { return static_cast<double>(row * kWidth + k); }

class QposFileTest : public testing::Test {
 protected:
  QposFileTest() : path_((folder_ / "rows.npy").string()) {
    std::ofstream file(path_, std::ios::binary);
    file << app::NpyHeader(kRows, kWidth);
    std::vector<double> row(kWidth);
    for (std::size_t i = 0; i < kRows; ++i) {
      for (std::size_t k = 0; k < kWidth; ++k) row[k] = Value(i, k);
      file.write(reinterpret_cast<const char*>(row.data()), sizeof(double) * kWidth);
    }
  }

  TemporaryFolder folder_;
  const std::string path_;
};

TEST_F(QposFileTest, AMappedArrayIsReadToItsEnd) {
  app::QposFile file(path_, kWidth);
  std::vector<double> row;
  std::string origin;
  std::size_t rows = 0, wrong = 0;
  for (; file.Next(row, origin); ++rows) {
    for (std::size_t k = 0; k < kWidth; ++k) wrong += row[k] != Value(rows, k);
  }
  EXPECT_EQ(rows, kRows);
  EXPECT_EQ(wrong, 0u);
}

// To touch a page of a mapping that the file has no more would end the process.
TEST_F(QposFileTest, AFileThatShrinksWhileItIsReadIsAnError) {
  app::QposFile file(path_, kWidth);
  std::vector<double> row;
  std::string origin;
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(file.Next(row, origin));
  std::filesystem::resize_file(path_, 128 + 8 * kWidth * 20);
  std::size_t more = 0;
  try {
    while (file.Next(row, origin)) ++more;
    ADD_FAILURE() << "all rows were read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("ends in row 20"));
  }
  EXPECT_EQ(more, 10u);
}

}  // namespace
}  // namespace mjcf_pdg::test
