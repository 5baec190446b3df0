// What a search does, iteration by iteration, for those who want to watch it: Solver::SetObserver.
//
// A search makes descents, one from each start. A descent linearizes the contacts and the object
// norm, makes a step, and does so again where that ends (Tang & Kim, Sec. 5.3). Symbols and units:
// types.h.
#ifndef MJCF_PDG_OBSERVER_H_
#define MJCF_PDG_OBSERVER_H_

#include <array>
#include <functional>
#include <span>

namespace mjcf_pdg {

// A row of the linearization that a step was made from: c · dq + gap >= 0.
struct ObservedRow {
  std::array<int, 2> geom = {-1, -1};  // ids in the user's model; -1: the row of a joint limit
  int joint = -1;                      // id in the user's model; -1: the row of a contact
  double gap = 0.0;                    // what was left before the step [m]; of a turn, as an arc
  double multiplier = 0.0;             // λ of min ½‖r + J dq‖² over the rows [m]; 0: not active
};

// One iteration of a descent, or where it begins.
struct Iteration {
  const char* start = "";  // of the descent: a name from Components (pdg.h); "polish": a last one
  int descent = 0;         // number of the descent in this solve, from 0
  int step = 0;            // in the descent; 0: where it begins, which has no rows
  std::span<const double> q;  // nq: where the step ends
  // σ between q_in and q [m²]. In a scene of several kinematic trees, of those that are searched
  // together.
  double sigma = 0.0;
  double violation = 0.0;  // sum of the overlaps beyond what a descent aims at [m]
  bool free = false;       // by the solver's own distances; the verifier has not been asked
  std::span<const ObservedRow> rows;  // of the linearization that the step was made from
};

// Called once per iteration, by the thread that solves. What an Iteration refers to is valid until
// the call returns. The observer must neither throw nor call the solver.
using Observer = std::function<void(const Iteration&)>;

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_OBSERVER_H_
