// PLY files cut off anywhere.
#include "import/ply_check.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace mjcf_pdg::test {
namespace {

std::string Header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment two vertices, a face\nelement vertex 2\nproperty float x\n"
         "property uchar red\nelement face 1\nproperty list ushort int vertex_index\nend_header\n";
}

bool IsWhole(const std::string& text) {
  std::istringstream stream(text);
  return IsWholePly(stream);
}

TEST(PlyCheckTest, EveryByteOfABinaryFileIsNeeded) {
  const std::string vertices(10, '\0'), corners(12, '\7');
  const std::string little = Header("binary_little_endian") + vertices + '\3' + '\0' + corners;
  const std::string big = Header("binary_big_endian") + vertices + '\0' + '\3' + corners;
  for (const std::string& whole : {little, big}) {
    EXPECT_TRUE(IsWhole(whole));
    for (std::size_t n = 0; n < whole.size(); ++n) EXPECT_FALSE(IsWhole(whole.substr(0, n))) << n;
  }
}

TEST(PlyCheckTest, EveryWordOfAnAsciiFileIsNeeded) {
  const std::string whole = Header("ascii") + "1.5 200 -2 7\n3 0 1 1\n";
  EXPECT_TRUE(IsWhole(whole));
  for (std::size_t n = 0; n + 2 < whole.size(); ++n) EXPECT_FALSE(IsWhole(whole.substr(0, n))) << n;
}

TEST(PlyCheckTest, UnknownTypesAndListsWithoutEndAreNotWhole) {
  EXPECT_FALSE(
      IsWhole("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n1\n"));
  EXPECT_FALSE(IsWhole("ply\nformat ascii 1.0\nproperty float x\nend_header\n1\n"));
  EXPECT_FALSE(IsWhole("ply\nformat ascii 1.0\nelement face many\nend_header\n1\n"));
  EXPECT_FALSE(IsWhole(Header("binary_little_endian") + std::string(10, '\0') + "\xff\xff\xff"));
}

}  // namespace
}  // namespace mjcf_pdg::test
