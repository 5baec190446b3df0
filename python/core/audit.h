#ifndef MJCF_PDG_PYTHON_CORE_AUDIT_H_
#define MJCF_PDG_PYTHON_CORE_AUDIT_H_

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>

namespace mjcf_pdg::python {

namespace nb = nanobind;

// What `mjcf-pdg audit --json` says of a model, as a dictionary.
nb::dict AuditModel(nb::handle model, std::size_t samples, std::uint64_t seed, double tolerance,
                    bool exact_mesh);

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_AUDIT_H_
