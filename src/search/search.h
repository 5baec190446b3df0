// The search over starts: local optimization from each until enough of them agree.
//
// The direct start, q_in itself, settles shallow problems alone; varied starts follow
// (varied_starts.h), for exact meshes after starts of their own (exact_mesh_starts.h). What ends it
// is in stopping_rule.h, what becomes of a start in trials.h.
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

  // The first starts: q_in and `hint`, whose component is `hint_start` (null: no hint). True if
  // the answer is to be left at that: a frame that follows the last one.
  bool Begin(const StrategyInput& input, Component hint_start = Component::kUserPose);
  // One more start, from elsewhere.
  void Try(const VectorXd& q, Component start) { trials_.Try(q, start, Coarse()); }
  // All others.
  void Finish(const StrategyInput& input);

  // The gain of a last descent is worth its time at this effort, after Finish.
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
  double depth_ = 0.0;           // that q_in must be parted by [m]
  bool meshes_overlap_ = false;  // at q_in, as triangles
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_SEARCH_H_
