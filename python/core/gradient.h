#ifndef MJCF_PDG_PYTHON_CORE_GRADIENT_H_
#define MJCF_PDG_PYTHON_CORE_GRADIENT_H_

#include <nanobind/nanobind.h>

namespace mjcf_pdg::python {

namespace nb = nanobind;

// Gradients of results of solve: q_in and q are (n, nq), `status` is a sequence of n names. Returns
// sigma (n, nv), q (n, nv, nv), NaN where there is none, and active_set_changes (n).
nb::dict DifferentiateRows(nb::handle model, nb::handle q_in, nb::handle q, nb::handle status,
                           int threads, const nb::kwargs& given);

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_GRADIENT_H_
