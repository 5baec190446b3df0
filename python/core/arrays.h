// Arrays and texts between Python and C++.
#ifndef MJCF_PDG_PYTHON_CORE_ARRAYS_H_
#define MJCF_PDG_PYTHON_CORE_ARRAYS_H_

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <cstddef>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace mjcf_pdg::python {

namespace nb = nanobind;

// Copies the values of anything that numpy makes a float64 array of into `values`, row by row, and
// returns its shape. Throws nb::type_error for what is not of real numbers; numpy's own exceptions
// pass through. Messages begin with `name`.
std::vector<std::size_t> ReadArray(nb::handle array, const char* name, std::vector<double>& values);

// Reads a configuration, which is an array (nq,). Throws nb::value_error for another shape.
void ReadConfiguration(nb::handle array, const char* name, int nq, std::vector<double>& values);
std::vector<double> ReadConfiguration(nb::handle array, const char* name, int nq);

// Reads configurations, an array (n, nq), and returns n.
std::size_t ReadConfigurations(nb::handle array, const char* name, int nq,
                               std::vector<double>& values);

// Bytes that are not UTF-8 are replaced.
nb::str Text(const std::string& text);

// A new numpy array that owns `values`, which fill `shape` row by row.
template <typename T>
nb::object Array(std::vector<T> values, std::initializer_list<std::size_t> shape) {
  auto* const owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T>(owned->data(), shape, owner));
}

template <typename T>
nb::object Array(std::vector<T> values) {
  const std::size_t size = values.size();
  return Array(std::move(values), {size});
}

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_ARRAYS_H_
