#include "apps/html/packed.h"

#include <zlib.h>

#include <cstdint>
#include <stdexcept>

#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

std::string Deflated(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  const int status =
      compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 9);
  if (status != Z_OK) throw std::runtime_error("zlib cannot pack the report");
  packed.resize(size);
  return packed;
}

std::string Base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t three = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      three = three << 8 | (k + j < bytes.size() ? static_cast<unsigned char>(bytes[k + j]) : 0u);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += k + j > bytes.size() ? '=' : kDigits[three >> (18 - 6 * j) & 63];
    }
  }
  return text;
}

}  // namespace

std::string Pack(const nlohmann::ordered_json& json, std::string_view bytes) {
  const std::string text = JsonLine(json);
  std::string block;
  for (int k = 0; k < 4; ++k) block += static_cast<char>(text.size() >> (8 * k) & 255);
  return Base64(Deflated(block.append(text).append(bytes)));
}

}  // namespace mjcf_pdg::app
