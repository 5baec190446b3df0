#include "import/ply_check.h"

#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace mjcf_pdg {
namespace {

struct Property {
  int count_size = 0;  // bytes of a list's length; 0: the property is no list
  int size = 0;        // bytes of a value
};

struct Element {
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string format;
  std::vector<Element> elements;
};

// Bytes of a PLY type; 0 if there is no such type.
int SizeOf(const std::string& type) {
  static const std::map<std::string, int> sizes = {
      {"char", 1},  {"uchar", 1},  {"short", 2}, {"ushort", 2}, {"int", 4},     {"uint", 4},
      {"float", 4}, {"double", 8}, {"int8", 1},  {"uint8", 1},  {"int16", 2},   {"uint16", 2},
      {"int32", 4}, {"uint32", 4}, {"int64", 8}, {"uint64", 8}, {"float32", 4}, {"float64", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

std::optional<Header> ReadHeader(std::istream& stream) {
  Header header;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string keyword, word;
    words >> keyword;
    if (keyword == "end_header") return header;
    if (keyword == "format") words >> header.format;
    if (keyword == "element" && !(words >> word >> header.elements.emplace_back().count)) return {};
    if (keyword != "property") continue;
    Property property;
    words >> word;
    if (word == "list") {
      words >> word;
      property.count_size = SizeOf(word);
      words >> word;
      if (property.count_size == 0) return {};
    }
    property.size = SizeOf(word);
    if (property.size == 0 || header.elements.empty()) return {};
    header.elements.back().properties.push_back(property);
  }
  return {};
}

// The values after the header, to be skipped or read in order. The functions fail at the end of the
// stream.
class Body {
 public:
  Body(std::istream& stream, const std::string& format)
      : stream_(stream), ascii_(format == "ascii"), big_endian_(format == "binary_big_endian") {}

  bool Skip(std::uint64_t count, int size) {
    for (std::uint64_t i = 0; ascii_ && i < count; ++i) {
      if (!(stream_ >> word_)) return false;
    }
    if (ascii_) return true;
    const auto bytes = static_cast<std::streamsize>(count * static_cast<std::uint64_t>(size));
    return stream_.ignore(bytes).gcount() == bytes;
  }

  std::optional<std::uint64_t> ReadLength(int size) {
    if (ascii_) {
      if (!(stream_ >> word_)) return {};
      return std::strtoull(word_.c_str(), nullptr, 10);
    }
    std::uint64_t length = 0;
    for (int i = 0; i < size; ++i) {
      const int byte = stream_.get();
      if (byte < 0) return {};
      const auto digit = static_cast<std::uint64_t>(byte);
      length = big_endian_ ? length << 8 | digit : length | digit << 8 * i;
    }
    return length;
  }

 private:
  std::istream& stream_;
  std::string word_;
  bool ascii_, big_endian_;
};

}  // namespace

bool IsWholePly(std::istream& stream) {
  constexpr std::uint64_t kLongest = 1u << 20;  // corners of a face: a longer list is damage
  const std::optional<Header> header = ReadHeader(stream);
  if (!header) return false;
  Body body(stream, header->format);
  for (const Element& element : header->elements) {
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      for (const Property& property : element.properties) {
        std::uint64_t count = 1;
        if (property.count_size > 0) {
          const std::optional<std::uint64_t> length = body.ReadLength(property.count_size);
          if (!length || *length > kLongest) return false;
          count = *length;
        }
        if (!body.Skip(count, property.size)) return false;
      }
    }
  }
  return true;
}

}  // namespace mjcf_pdg
