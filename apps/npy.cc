#include "apps/npy.h"

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <system_error>

#include "apps/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

static_assert(std::endian::native == std::endian::little,
              ".npy data are copied as they are in memory");

constexpr std::string_view kMagic("\x93NUMPY", 6);
// NumPy itself refuses longer headers when it reads untrusted files.
constexpr std::size_t kMaxHeader = 65536;

struct Header {
  std::string_view text;   // a Python dict
  std::size_t data_begin;  // offset of the first value
};

Header FindHeader(std::string_view bytes, const std::string& what) {
  const std::size_t size_bytes = bytes.size() > 6 && bytes[6] == 1 ? 2 : 4;
  if (bytes.size() < kMagic.size() + 2 + size_bytes) throw Error(what + ": truncated .npy header");
  const int version = static_cast<unsigned char>(bytes[6]);
  if (version < 1 || version > 3) {
    throw Error(what + ": .npy version " + std::to_string(version) + " is not known");
  }
  std::size_t length = 0;
  for (std::size_t i = 0; i < size_bytes; ++i) {
    length |= std::size_t{static_cast<unsigned char>(bytes[8 + i])} << (8 * i);
  }
  const std::size_t begin = 8 + size_bytes;
  if (length > kMaxHeader) {
    throw Error(what + ": .npy header of " + std::to_string(length) + " bytes is too long");
  }
  if (bytes.size() - begin < length) throw Error(what + ": truncated .npy header");
  return {bytes.substr(begin, length), begin + length};
}

// What follows 'key': in the header's dict, up to the next comma outside parentheses.
std::string_view Field(std::string_view header, std::string_view key, const std::string& what) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    std::size_t begin = header.find(quoted);
    if (begin == std::string_view::npos) continue;
    begin = header.find_first_not_of(" :", begin + quoted.size());
    if (begin == std::string_view::npos) break;
    int depth = 0;
    std::size_t end = begin;
    for (; end < header.size(); ++end) {
      const char c = header[end];
      if (depth == 0 && (c == ',' || c == '}')) break;
      depth += (c == '(' || c == '[') - (c == ')' || c == ']');
    }
    return header.substr(begin, end - begin);
  }
  throw Error(what + ": .npy header has no '" + std::string(key) + "'");
}

// Bytes of a value; throws Error for types that are not read.
std::size_t SizeOf(std::string_view descr, const std::string& what) {
  if (descr.size() == 5 && descr.substr(1, 3) == "<f8") return sizeof(double);
  if (descr.size() == 5 && descr.substr(1, 3) == "<f4") return sizeof(float);
  const std::string hint = descr.find('>') == std::string_view::npos ? "" : " (big-endian)";
  throw Error(what + ": .npy type " + OneLine(descr.substr(0, 40)) + hint +
              " is neither '<f8' nor '<f4', little-endian floats");
}

template <typename Value>
void CopyRows(const char* data, Rows& rows) {
  for (std::vector<double>& row : rows) {
    for (double& x : row) {
      Value value;
      std::memcpy(&value, data, sizeof(Value));
      x = value;
      data += sizeof(Value);
    }
  }
}

std::vector<std::size_t> ParseShape(std::string_view text, const std::string& what) {
  std::vector<std::size_t> shape;
  std::size_t i = 0;
  while (i < text.size()) {
    if (text[i] == '(' || text[i] == ')' || text[i] == ',' || text[i] == ' ') {
      ++i;
      continue;
    }
    std::size_t value = 0;
    const auto [end, ec] = std::from_chars(text.data() + i, text.data() + text.size(), value);
    if (ec != std::errc()) throw Error(what + ": bad .npy shape " + OneLine(text.substr(0, 60)));
    shape.push_back(value);
    i = static_cast<std::size_t>(end - text.data());
  }
  if (shape.empty() || shape.size() > 2) {
    throw Error(what + ": .npy shape " + OneLine(text.substr(0, 60)) +
                " has not 1 or 2 dimensions");
  }
  if (shape.size() == 1) shape.insert(shape.begin(), 1);
  return shape;
}

}  // namespace

bool IsNpy(std::string_view bytes) { return bytes.substr(0, kMagic.size()) == kMagic; }

Rows ParseNpy(std::string_view bytes, const std::string& what) {
  const Header header = FindHeader(bytes, what);
  const std::size_t size = SizeOf(Field(header.text, "descr", what), what);
  if (Field(header.text, "fortran_order", what).substr(0, 5) != "False") {
    throw Error(what + ": .npy array in Fortran order (save numpy.ascontiguousarray of it)");
  }
  const std::vector<std::size_t> shape = ParseShape(Field(header.text, "shape", what), what);
  const std::size_t available = bytes.size() - header.data_begin;
  const std::size_t rows = shape[0], width = shape[1];
  // Divides instead of multiplying: the shape of a broken file may overflow.
  const bool fits = rows == 0 || width <= available / size / rows;
  if (!fits || available != rows * width * size) {
    throw Error(what + ": " + std::to_string(available) +
                " bytes of data, but the .npy header says " + std::to_string(rows) + " x " +
                std::to_string(width) + (size == sizeof(double) ? " float64" : " float32"));
  }
  if (width == 0) throw Error(what + ": the rows are empty");
  Rows result(rows, std::vector<double>(width));
  const char* data = bytes.data() + header.data_begin;
  if (size == sizeof(double)) {
    CopyRows<double>(data, result);
  } else {
    CopyRows<float>(data, result);
  }
  return result;
}

std::string FormatNpy(const Rows& rows, std::size_t width) {
  std::string dict = "{'descr': '<f8', 'fortran_order': False, 'shape': (" +
                     std::to_string(rows.size()) + ", " + std::to_string(width) + "), }";
  // The data begin at a multiple of 64, as NumPy writes them, after a line break.
  const std::size_t preamble = kMagic.size() + 4;
  dict.append(63 - (preamble + dict.size()) % 64, ' ');
  dict += '\n';
  std::string bytes(kMagic);
  bytes += '\x01';
  bytes += '\x00';
  bytes += static_cast<char>(dict.size() & 0xFF);
  bytes += static_cast<char>(dict.size() >> 8);
  bytes += dict;
  for (const std::vector<double>& row : rows) {
    bytes.append(reinterpret_cast<const char*>(row.data()), width * sizeof(double));
  }
  return bytes;
}

}  // namespace mjcf_pdg::app
