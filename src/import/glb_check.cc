#include "import/glb_check.h"

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

namespace mjcf_pdg {
namespace {

using nlohmann::json;

// The little-endian number of `size` bytes at the offset; 0 if it is not all inside `bytes`.
std::uint64_t Unsigned(std::string_view bytes, std::uint64_t offset, int size) {
  if (offset > bytes.size() || bytes.size() - offset < static_cast<std::uint64_t>(size)) return 0;
  std::uint64_t value = 0;
  for (int i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
  return value;
}

// Bytes of an index of this glTF component type; 0 if it is no type of an index.
int IndexSize(int component_type) {
  switch (component_type) {
    case 5121:
      return 1;
    case 5123:
      return 2;
    case 5125:
      return 4;
    default:
      return 0;
  }
}

bool HasMissingCorners(const json& gltf, const json& primitive, std::string_view buffer) {
  if (!primitive.contains("indices")) return false;
  const json& accessors = gltf.at("accessors");
  const json& indices = accessors.at(primitive.at("indices").get<std::size_t>());
  if (!indices.contains("bufferView") || indices.contains("sparse")) return false;
  const json& view = gltf.at("bufferViews").at(indices.at("bufferView").get<std::size_t>());
  if (view.at("buffer") != 0 || gltf.at("buffers").at(0).contains("uri")) return false;
  const auto positions = primitive.at("attributes").at("POSITION").get<std::size_t>();
  const auto vertices = accessors.at(positions).at("count").get<std::uint64_t>();
  const auto count = indices.at("count").get<std::uint64_t>();
  const auto begin =
      view.value("byteOffset", std::uint64_t{0}) + indices.value("byteOffset", std::uint64_t{0});
  const int size = IndexSize(indices.at("componentType").get<int>());
  if (size == 0 || begin > buffer.size() || count > (buffer.size() - begin) / size) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (Unsigned(buffer, begin + i * size, size) >= vertices) return true;
  }
  return false;
}

}  // namespace

bool GlbHasMissingCorners(const std::string& bytes) {
  constexpr std::uint64_t kHeader = 12, kChunkHeader = 8;
  const std::string_view all = bytes;
  const std::uint64_t text = kHeader + kChunkHeader;
  const std::uint64_t text_size = Unsigned(all, kHeader, 4);
  const std::uint64_t buffer = text + text_size + kChunkHeader;
  if (buffer > all.size()) return false;
  const json gltf = json::parse(all.substr(text, text_size), nullptr, false);
  try {
    for (const json& mesh : gltf.at("meshes")) {
      for (const json& primitive : mesh.at("primitives")) {
        if (HasMissingCorners(gltf, primitive, all.substr(buffer))) return true;
      }
    }
  } catch (const json::exception&) {  // assimp will report what is wrong
  }
  return false;
}

}  // namespace mjcf_pdg
