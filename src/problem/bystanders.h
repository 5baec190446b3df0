// Trees that a solve of the whole scene has moved although nothing was wrong with them. A scene
// that is solved island by island has none.
#ifndef MJCF_PDG_SRC_PROBLEM_BYSTANDERS_H_
#define MJCF_PDG_SRC_PROBLEM_BYSTANDERS_H_

#include <vector>

#include "collide/contacts.h"
#include "model/island.h"
#include "problem/problem.h"

namespace mjcf_pdg {

class Bystanders {
 public:
  explicit Bystanders(const SceneTables& scene);

  // Puts trees that neither overlap at q_in nor are outside their limits, and that no held
  // constraint concerns, back to `q_in` (nq, as the user gave it) in `q`. Returns whether that
  // changes q: whether it is still free is not known. A tree that is the only one stays: it was
  // moved because something is wrong with it.
  bool PutBack(const Problem& problem, const std::vector<NearPair>& overlaps,
               const std::vector<double>& q_in, std::vector<double>& q);

 private:
  const MovableTrees trees_;
  std::vector<char> joined_;  // by tree: by a held equality constraint or tendon
  std::vector<char> concerned_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_BYSTANDERS_H_
