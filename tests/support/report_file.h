// Reads a report that --html wrote.
#ifndef MJCF_PDG_TESTS_SUPPORT_REPORT_FILE_H_
#define MJCF_PDG_TESTS_SUPPORT_REPORT_FILE_H_

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

namespace mjcf_pdg::test {

inline std::string FromBase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
  }
  return bytes;
}

// The text of <script id="ID">.
inline std::string Script(const std::string& page, const std::string& id) {
  const std::string head = "id=\"" + id + "\">";
  const std::size_t begin = page.find(head);
  if (begin == std::string::npos) return "";
  const std::size_t end = page.find("</script>", begin);
  return page.substr(begin + head.size(), end - begin - head.size());
}

struct Block {
  nlohmann::json json;
  std::string bytes;
};

inline Block Unpack(const std::string& text) {
  const std::string packed = FromBase64(text);
  std::string bytes(std::size_t{1} << 22, '\0');
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                       reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data(), 4);
  return {nlohmann::json::parse(bytes.substr(4, length)),
          bytes.substr(4 + length, size - 4 - length)};
}

// The poses of a row, which follow its configurations.
inline std::string PoseBytes(const Block& row) {
  const std::size_t numbers = row.json["frames"].size() * row.json["nq"].get<std::size_t>();
  return row.bytes.substr(numbers * sizeof(double));
}

inline nlohmann::json Head(const std::string& page) {
  return nlohmann::json::parse(Script(page, "page"));
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_REPORT_FILE_H_
