// Keyword arguments, named as on the command line.
#ifndef MJCF_PDG_PYTHON_CORE_OPTIONS_H_
#define MJCF_PDG_PYTHON_CORE_OPTIONS_H_

#include <nanobind/nanobind.h>

#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/tracker.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::python {

namespace nb = nanobind;

// Who takes an option; a function takes those of several users.
enum Users : unsigned {
  kNorm = 1,    // what may move and how it is measured
  kVerify = 2,  // what counts as free
  kSolve = 4,
  kTrack = 8,
  kRows = 16,  // of all rows together
};

struct Asked {
  SceneOptions scene;
  Options options;
  TrackOptions track;   // but for its `options`
  double smooth = 0.0;  // TrajectoryOptions::smooth
};

// As the command line asks: contacts, and distances up to a metre.
Asked CommandLineDefaults();

// Reads keyword arguments into `asked`. Throws Error for a name that none of `users` takes and for
// a word that is none of an option's, nb::type_error for a value of another type. Ranges are left
// to the library.
void ReadOptions(const nb::kwargs& given, unsigned users, Asked& asked);

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_OPTIONS_H_
