#include "arrays.h"

#include <cstring>
#include <string>

namespace mjcf_pdg::python {
namespace {

using namespace nb::literals;

// A view of an array's memory, held while this lives.
class Buffer {
 public:
  explicit Buffer(nb::handle array) {
    held_ = PyObject_GetBuffer(array.ptr(), &view_, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) == 0;
    if (!held_) PyErr_Clear();
  }
  ~Buffer() {
    if (held_) PyBuffer_Release(&view_);
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  bool IsFloat64() const { return held_ && view_.format && std::strcmp(view_.format, "d") == 0; }
  std::vector<std::size_t> Shape() const { return {view_.shape, view_.shape + view_.ndim}; }
  std::size_t ndim() const { return static_cast<std::size_t>(view_.ndim); }
  std::size_t length() const { return static_cast<std::size_t>(view_.shape[0]); }
  void Copy(std::vector<double>& values) const {
    const auto* const first = static_cast<const double*>(view_.buf);
    values.assign(first, first + view_.len / view_.itemsize);
  }

 private:
  Py_buffer view_;
  bool held_ = false;
};

nb::object AsFloat64(nb::handle array, const char* name) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::object given = numpy.attr("asarray")(array);
  const std::string kind = nb::cast<std::string>(given.attr("dtype").attr("kind"));
  if (std::string("biufO").find(kind) == std::string::npos) {
    const std::string words = std::string(name) + " must be of real numbers, not of " +
                              nb::cast<std::string>(given.attr("dtype").attr("name"));
    throw nb::type_error(words.c_str());
  }
  return numpy.attr("asarray")(given, "dtype"_a = "float64", "order"_a = "C");
}

std::string Describe(const std::vector<std::size_t>& shape) {
  std::string text = "(";
  for (const std::size_t size : shape) text += std::to_string(size) + ", ";
  if (shape.size() > 1) text.resize(text.size() - 2);
  if (shape.size() == 1) text.resize(text.size() - 1);
  return text + ")";
}

[[noreturn]] void RefuseShape(const char* name, const std::vector<std::size_t>& shape,
                              const std::string& wanted) {
  const std::string words =
      std::string(name) + " has the shape " + Describe(shape) + ", the model needs " + wanted;
  throw nb::value_error(words.c_str());
}

}  // namespace

std::vector<std::size_t> ReadArray(nb::handle array, const char* name,
                                   std::vector<double>& values) {
  {
    const Buffer buffer(array);
    if (buffer.IsFloat64()) {
      buffer.Copy(values);
      return buffer.Shape();
    }
  }
  const nb::object converted = AsFloat64(array, name);
  const Buffer buffer(converted);
  buffer.Copy(values);
  return buffer.Shape();
}

void ReadConfiguration(nb::handle array, const char* name, int nq, std::vector<double>& values) {
  const auto length = static_cast<std::size_t>(nq);
  {  // the way of control loops, without a shape on the heap
    const Buffer buffer(array);
    if (buffer.IsFloat64() && buffer.ndim() == 1 && buffer.length() == length) {
      buffer.Copy(values);
      return;
    }
  }
  const std::vector<std::size_t> shape = ReadArray(array, name, values);
  if (shape.size() != 1 || shape[0] != length) {
    RefuseShape(name, shape, "(" + std::to_string(nq) + ",)");
  }
}

std::vector<double> ReadConfiguration(nb::handle array, const char* name, int nq) {
  std::vector<double> values;
  ReadConfiguration(array, name, nq, values);
  return values;
}

std::size_t ReadConfigurations(nb::handle array, const char* name, int nq,
                               std::vector<double>& values) {
  const std::vector<std::size_t> shape = ReadArray(array, name, values);
  if (shape.size() != 2 || shape[1] != static_cast<std::size_t>(nq)) {
    RefuseShape(name, shape, "(n, " + std::to_string(nq) + ")");
  }
  return shape[0];
}

nb::str Text(const std::string& text) {
  return nb::steal<nb::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
}

}  // namespace mjcf_pdg::python
