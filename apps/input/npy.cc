#include "apps/input/npy.h"

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "apps/console/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

static_assert(std::endian::native == std::endian::little,
              ".npy data are copied as they are in memory");

constexpr std::string_view kMagic("\x93NUMPY", 6);
// NumPy itself refuses longer headers when it reads untrusted files.
constexpr std::size_t kMaxHeader = 65536;

// The dict of the header, the stream then at the first value.
std::string ReadHeader(std::istream& stream, const std::string& what) {
  const auto read = [&](std::size_t count) {
    std::string bytes(count, '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(count));
    if (stream.gcount() != static_cast<std::streamsize>(count)) {
      throw Error(what + ": truncated .npy header");
    }
    return bytes;
  };
  const bool begins = static_cast<char>(stream.peek()) == kNpyBegin;
  if (!begins || read(kMagic.size()) != kMagic) throw Error(what + ": is not a .npy file");
  const int version = static_cast<unsigned char>(read(2)[0]);
  if (version < 1 || version > 3) {
    throw Error(what + ": .npy version " + std::to_string(version) + " is not known");
  }
  const std::string size = read(version == 1 ? 2 : 4);
  std::size_t length = 0;
  for (std::size_t i = 0; i < size.size(); ++i) {
    length |= std::size_t{static_cast<unsigned char>(size[i])} << (8 * i);
  }
  if (length > kMaxHeader) {
    throw Error(what + ": .npy header of " + std::to_string(length) + " bytes is too long");
  }
  return read(length);
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

template <typename Value>
void Copy(const char* data, std::vector<double>& row) {
  for (double& x : row) {
    Value value;
    std::memcpy(&value, data, sizeof(Value));
    x = value;
    data += sizeof(Value);
  }
}

}  // namespace

NpyReader::NpyReader(std::istream& stream, std::string what)
    : stream_(stream), what_(std::move(what)) {
  const std::string header = ReadHeader(stream, what_);
  value_bytes_ = SizeOf(Field(header, "descr", what_), what_);
  if (Field(header, "fortran_order", what_).substr(0, 5) != "False") {
    throw Error(what_ + ": .npy array in Fortran order (save numpy.ascontiguousarray of it)");
  }
  const std::vector<std::size_t> shape = ParseShape(Field(header, "shape", what_), what_);
  rows_ = shape[0];
  width_ = shape[1];
  if (width_ == 0) throw Error(what_ + ": the rows are empty");
  // Divides instead of multiplying: the shape of a broken file may overflow.
  const std::size_t most = std::numeric_limits<std::ptrdiff_t>::max();
  if (rows_ > most / width_ / value_bytes_) throw Error(what_ + ": no array is " + Shape());
}

std::string NpyReader::Shape() const {
  return std::to_string(rows_) + " x " + std::to_string(width_) +
         (value_bytes_ == sizeof(double) ? " float64" : " float32");
}

void NpyReader::Map(const std::string& path, std::size_t data_begin) {
  file_ = std::make_unique<MappedFile>(path);
  data_begin_ = data_begin;
}

// Those of the next row; null if there are not as many.
const char* NpyReader::NextBytes() {
  const std::size_t count = width_ * value_bytes_;
  if (file_) return file_->Bytes(data_begin_ + next_ * count, count);
  bytes_.resize(count);
  stream_.read(bytes_.data(), static_cast<std::streamsize>(count));
  return stream_.gcount() == static_cast<std::streamsize>(count) ? bytes_.data() : nullptr;
}

bool NpyReader::Next(std::vector<double>& row) {
  if (next_ == rows_) return false;
  const char* const bytes = NextBytes();
  if (!bytes) {
    throw Error(what_ + ": ends in row " + std::to_string(next_) + ", but the .npy header says " +
                Shape());
  }
  ++next_;
  row.resize(width_);
  if (value_bytes_ == sizeof(double)) {
    Copy<double>(bytes, row);
  } else {
    Copy<float>(bytes, row);
  }
  return true;
}

std::string NpyHeader(std::size_t rows, std::size_t width) {
  std::string dict = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(rows) +
                     ", " + std::to_string(width) + "), }";
  // As NumPy writes them, headers end in a line break and fill a multiple of 64 bytes.
  const std::size_t preamble = kMagic.size() + 4;
  dict.resize(kNpyHeaderBytes - preamble - 1, ' ');
  dict += '\n';
  std::string bytes(kMagic);
  bytes += '\x01';
  bytes += '\x00';
  bytes += static_cast<char>(dict.size() & 0xFF);
  bytes += static_cast<char>(dict.size() >> 8);
  return bytes + dict;
}

}  // namespace mjcf_pdg::app
