#include "import/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "import/glb_check.h"
#include "import/ply_check.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string InSmallLetters(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// ---- STL ----

constexpr std::uint64_t kStlHeader = 84, kStlTriangle = 50;  // bytes

// Decides by the first kStlHeader bytes, the last four of which are a binary file's count of
// triangles: those of an ASCII file begin with "solid" and are all printable.
bool IsAsciiStl(const std::string& head) {
  const std::size_t begin = head.find_first_not_of(" \t\r\n");
  return begin != std::string::npos && InSmallLetters(head.substr(begin, 5)) == "solid" &&
         std::all_of(head.begin(), head.end(),
                     [](unsigned char c) { return std::isprint(c) || std::isspace(c); });
}

// The text as assimp can read it; throws Error if it ends too early.
std::string AsciiStl(const std::string& path, const std::string& text) {
  const std::string small = InSmallLetters(text);
  const std::size_t end = small.rfind("endsolid"), facet = small.rfind("endfacet");
  if (end == std::string::npos || (facet != std::string::npos && facet > end)) {
    throw Error(path + ": the file ends too early: no 'endsolid' after the last facet");
  }
  const auto as_assimp_wants = [&](const char* word) {
    return text.find(word) == small.find(word);
  };
  return as_assimp_wants("solid") && as_assimp_wants("facet") ? text : small;
}

// The bytes of an STL file as assimp can read them.
std::string Stl(const std::string& path, std::string bytes) {
  const std::string head = bytes.substr(0, kStlHeader);
  if (IsAsciiStl(head)) return AsciiStl(path, bytes);
  if (head.size() < kStlHeader) return bytes;
  std::uint32_t count;
  std::memcpy(&count, head.data() + kStlHeader - sizeof count, sizeof count);
  const std::uint64_t end = kStlHeader + kStlTriangle * count;
  if (count > 0 && bytes.size() > end && bytes.size() - end < kStlTriangle) bytes.resize(end);
  return bytes;
}

// ---- COLLADA: if the unit is no number, assimp silently takes metres ----

void CheckColladaUnit(const std::string& path, const std::string& text) {
  const std::size_t unit = text.find("<unit");
  if (unit == std::string::npos) return;
  const std::string tag = text.substr(unit, text.find('>', unit) - unit);
  const std::size_t meter = tag.find("meter=");
  if (meter == std::string::npos) return;
  const std::size_t begin = meter + std::strlen("meter=") + 1;  // after the quote
  if (begin > tag.size()) return;
  const std::string value = tag.substr(begin, tag.find(tag[begin - 1], begin) - begin);
  char* rest;
  const double metres = std::strtod(value.c_str(), &rest);
  const bool is_number = rest != value.c_str() && std::strspn(rest, " \t\r\n") == std::strlen(rest);
  if (is_number && metres > 0.0 && std::isfinite(metres)) return;
  throw Error(path + ": its unit, meter=\"" + value + "\", is not a positive number");
}

// ---- OFF: assimp makes room for what the header promises ----

// Whether the file has room for its counts of vertices and faces, each of which takes two bytes at
// least. True if the counts cannot be read: assimp tells why.
bool IsOffWithRoom(std::istream& stream, std::uintmax_t bytes) {
  std::string line;
  while (std::getline(stream, line)) {
    const std::size_t begin = line.find_first_of("0123456789#");
    if (begin == std::string::npos || line[begin] == '#') continue;
    char* rest = nullptr;
    const double vertices = std::strtod(line.c_str() + begin, &rest);
    const double faces = std::strtod(rest, nullptr);
    return vertices + faces <= static_cast<double>(bytes) / 2.0;
  }
  return true;
}

}  // namespace

std::string MeshFormat(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  return ending.empty() ? "" : InSmallLetters(ending.substr(1));
}

std::string CheckMeshFile(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) throw Error(path + ": no such file");
  if (!std::filesystem::is_regular_file(path, ec)) throw Error(path + ": is not a file");
  if (std::filesystem::file_size(path, ec) == 0) throw Error(path + ": the file is empty");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(path + ": cannot be read");
  std::string mark(kByteOrderMark.size(), '\0');
  stream.read(mark.data(), static_cast<std::streamsize>(mark.size()));
  const bool is_marked = mark == kByteOrderMark;
  const auto rewind = [&] {
    stream.clear();
    stream.seekg(is_marked ? static_cast<std::streamoff>(mark.size()) : 0);
  };

  const std::string format = MeshFormat(path);
  rewind();
  if (format == "ply" && !IsWholePly(stream)) {
    throw Error(path + ": the file ends too early or its header is wrong");
  }
  rewind();
  if (format == "off" && !IsOffWithRoom(stream, std::filesystem::file_size(path, ec))) {
    throw Error(path + ": its header promises more than the file has room for");
  }
  if (!is_marked && format != "stl" && format != "dae" && format != "glb") return "";
  rewind();
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  if (format == "dae") CheckColladaUnit(path, bytes);
  if (format == "glb" && GlbHasMissingCorners(bytes)) {
    throw Error(path + ": a face has a corner that does not exist");
  }
  const std::string wanted = format == "stl" ? Stl(path, bytes) : bytes;
  return is_marked || wanted != bytes ? wanted : "";
}

}  // namespace mjcf_pdg
