// The search for a better optimum that goes on beside the one that is followed: a descent from
// another start, a few steps in a tick, while the command moves on.
#ifndef MJCF_PDG_SRC_TRACK_ELSEWHERE_H_
#define MJCF_PDG_SRC_TRACK_ELSEWHERE_H_

#include <cstdint>

#include "base/random.h"
#include "optimize/local_optimization.h"
#include "problem/components.h"
#include "problem/workspace.h"
#include "start/selection.h"

namespace mjcf_pdg {

class Elsewhere {
 public:
  explicit Elsewhere(Workspace& work);

  // Goes on with the present descent, or begins the next one, as long as the workspace's budget
  // lasts. `own` is the optimum that is followed, of `own_sigma`. Returns true if a configuration
  // of less than `wanted_sigma` was found that is free by the solver's distances: q(), start().
  bool Search(const VectorXd& own, double own_sigma, double wanted_sigma);
  const VectorXd& q() const { return q_; }
  Component start() const { return start_; }

  // Forgets the present descent; the next one begins with the first kind of start.
  void Reset();
  std::int64_t lcp_steps() const { return local_.lcp_steps(); }

 private:
  void Begin(const VectorXd& own, double own_sigma);

  const Problem& problem_;
  Workspace& work_;
  LocalOptimization local_;
  StartSelection starts_;
  Random random_;
  VectorXd q_;  // where the present descent stands
  Component start_ = Component::kNone;
  int next_ = 0;    // number of descents that have begun
  int slices_ = 0;  // ticks that the present descent has had; 0: there is none
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_ELSEWHERE_H_
