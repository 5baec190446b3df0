// NumPy's .npy format: reads versions 1.0 to 3.0 with float64 or float32, writes version 1.0 with
// float64; little-endian, C order, one or two dimensions.
#ifndef MJCF_PDG_APPS_NPY_H_
#define MJCF_PDG_APPS_NPY_H_

#include <string>
#include <string_view>
#include <vector>

namespace mjcf_pdg::app {

using Rows = std::vector<std::vector<double>>;

bool IsNpy(std::string_view bytes);  // true if it begins with the format's magic string

// Returns the rows of the array in the file `bytes`; a one-dimensional array is one row. Throws
// Error, which begins with `what`, for other types and orders, or if the file is shorter or longer
// than its header says.
Rows ParseNpy(std::string_view bytes, const std::string& what);

// The bytes of a file with an array of shape (number of rows, width). Each row has `width` values.
std::string FormatNpy(const Rows& rows, std::size_t width);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_NPY_H_
