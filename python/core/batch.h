#ifndef MJCF_PDG_PYTHON_CORE_BATCH_H_
#define MJCF_PDG_PYTHON_CORE_BATCH_H_

#include <nanobind/nanobind.h>

namespace mjcf_pdg::python {

namespace nb = nanobind;

// Solves the rows of qpos (n, nq). `progress` is None or a function that hears from time to time
// how many rows are done. Returns the fields of mjcf_pdg.Results. Ctrl-C ends it when the rows that
// are being solved are done.
nb::dict SolveRows(nb::handle model, nb::handle qpos, int threads, nb::object progress,
                   const nb::kwargs& given);

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_BATCH_H_
