// What the library answers, as dictionaries: the fields of the data classes in
// mjcf_pdg/_answers.py.
#ifndef MJCF_PDG_PYTHON_CORE_ANSWERS_H_
#define MJCF_PDG_PYTHON_CORE_ANSWERS_H_

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::python {

namespace nb = nanobind;

const char* NameOf(Status status);
const char* NameOf(Cause cause);  // "" for none

// True if σ is within 1 % of its lower bound.
bool IsProven(const Result& result);

// The geom's name, or its id if it has none.
nb::object GeomOf(const Scene& scene, int geom);

// The result of q_in (nq).
nb::dict ToDict(const Scene& scene, std::vector<double> q_in, const Result& result);
nb::dict ToDict(const Scene& scene, const Verdict& verdict);
nb::dict ToDict(const Scene& scene, const Motion& motion);

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_ANSWERS_H_
