// NumPy's .npy format, version 1.0 to 3.0: float64 (read: or float32), little-endian, C order, one
// or two dimensions.
#ifndef MJCF_PDG_APPS_NPY_H_
#define MJCF_PDG_APPS_NPY_H_

#include <string>
#include <string_view>
#include <vector>

namespace mjcf_pdg::app {

using Rows = std::vector<std::vector<double>>;

bool IsNpy(std::string_view bytes);  // has the magic string

// A one-dimensional array is one row. Throws Error, which begins with `what`, for other types and
// orders, and when the file is shorter or longer than its header says.
Rows ParseNpy(std::string_view bytes, const std::string& what);

// Version 1.0, shape (rows, width).
std::string FormatNpy(const Rows& rows, std::size_t width);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_NPY_H_
