// The search over starts: local optimization from each until enough of them agree.
//
// The first start is q_in itself, which solves shallow problems alone. Exact meshes then get starts
// of their own (exact_mesh_starts.h), and varied starts follow (varied_starts.h). trials.h runs a
// start and keeps what it finds; stopping_rule.h decides when the search ends.
#ifndef MJCF_PDG_SRC_SEARCH_SEARCH_H_
#define MJCF_PDG_SRC_SEARCH_SEARCH_H_

#include <cstdint>

#include "problem/effort.h"
#include "problem/strategy.h"
#include "problem/workspace.h"
#include "search/exact_mesh_starts.h"
#include "search/trials.h"
#include "search/varied_starts.h"

namespace mjcf_pdg {

class Search {
 public:
  explicit Search(Workspace& work);

  // Tries the first starts: q_in and the input's hint, which is recorded as `hint_start`. Returns
  // true if the search may end there, as a frame of a trajectory that follows the last one.
  bool Begin(const StrategyInput& input, Component hint_start = Component::kUserPose);
  // Tries one more start, which another stage has found.
  void Try(const VectorXd& q, Component start) { trials_.Try(q, start, Coarse()); }
  // Tries all other starts until the search is done.
  void Finish(const StrategyInput& input);

  // After Finish: keeps the answer, for a frame of a trajectory that may follow it. The search on
  // hulls has no use for that.
  void FrameSearched() { meshes_.FrameSearched(trials_.BestSigma()); }
  // After Finish: whether a last descent to full precision is worth its time at this effort.
  bool WorthPolishing() const;
  Trials& trials() { return trials_; }
  const Trials& trials() const { return trials_; }
  void Forget() { meshes_.Forget(); }

 private:
  const Problem& problem_;
  Workspace& work_;
  Trials trials_;
  VariedStarts varied_;
  ExactMeshStarts meshes_;
  EffortPlan plan_;
  VectorXd center_;              // q_in inside its limits
  double depth_ = 0.0;           // the deepest overlap at q_in, clearance included [m]
  bool meshes_overlap_ = false;  // some pair that collides as triangles overlaps at q_in
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_SEARCH_H_
