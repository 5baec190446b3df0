// The search for a better optimum that goes on beside the one that is followed: a descent from
// another start, a few queries in a tick, while the command moves on.
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

  // What a tick's search is for.
  struct Wanted {
    const VectorXd& own;     // nq, the optimum that is followed
    double own_sigma = 0.0;  // [m²]
    double sigma = 0.0;      // less is sought [m²]
    int queries = 0;         // at most
    int obstacles = 0;       // how often obstacles have moved until now
  };
  // Goes on with the present descent, or begins the next one. Returns true if a configuration of
  // less than `wanted.sigma` was found that is free by the solver's distances: q(), start().
  bool Search(const Wanted& wanted);
  const VectorXd& q() const { return q_; }
  Component start() const { return start_; }

  // Forgets the present descent; the next one begins with the first kind of start.
  void Reset();
  std::int64_t lcp_steps() const { return local_.lcp_steps(); }

 private:
  void Begin(const VectorXd& own, double own_sigma);
  const LocalResult& Step(const Wanted& wanted);

  const Problem& problem_;
  Workspace& work_;
  LocalOptimization local_;
  StartSelection starts_;
  Random random_;
  VectorXd q_;  // where the present descent began; what was found
  Component start_ = Component::kNone;
  int next_ = 0;          // number of descents that have begun
  bool running_ = false;  // there is a present descent, which has made
  int steps_ = 0;         // so many steps, the last when
  int obstacles_ = 0;     // obstacles had moved so often
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_ELSEWHERE_H_
