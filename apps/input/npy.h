// NumPy's .npy format, version 1.0 to 3.0: float64 (read: or float32), little-endian, C order, one
// or two dimensions. Read and written row by row, files on disk through a
// mapping, so that arrays may be larger than memory.
#ifndef MJCF_PDG_APPS_INPUT_NPY_H_
#define MJCF_PDG_APPS_INPUT_NPY_H_

#include <cstddef>
#include <istream>
#include <memory>
#include <string>
#include <vector>

#include "apps/input/mapped_file.h"

namespace mjcf_pdg::app {

// Every .npy file begins with this character, which no text does.
inline constexpr char kNpyBegin = '\x93';

class NpyReader {
 public:
  // Reads the header; a one-dimensional array is one row. Throws Error, which begins with `what`,
  // for other types and orders.
  NpyReader(std::istream& stream, std::string what);

  // Rows come from the file's memory from now on, instead of the stream, whose header ended at byte
  // `data_begin`. Throws Error if the file cannot be opened.
  void Map(const std::string& path, std::size_t data_begin);

  std::size_t rows() const { return rows_; }
  std::size_t width() const { return width_; }
  std::size_t data_bytes() const { return rows_ * width_ * value_bytes_; }
  // What the header says, for messages.
  std::string Shape() const;

  // False after the last row. Throws Error if the stream or the file ends before.
  bool Next(std::vector<double>& row);

 private:
  std::istream& stream_;
  const std::string what_;
  std::size_t rows_ = 0, width_ = 0, value_bytes_ = 0;
  std::size_t next_ = 0;
  std::vector<char> bytes_;  // of a row of the stream
  std::unique_ptr<MappedFile> file_;
  std::size_t data_begin_ = 0;

  const char* NextBytes();
};

// A header of version 1.0 for `rows` float64 rows; 128 bytes whatever the number of rows.
inline constexpr std::size_t kNpyHeaderBytes = 128;
std::string NpyHeader(std::size_t rows, std::size_t width);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_INPUT_NPY_H_
