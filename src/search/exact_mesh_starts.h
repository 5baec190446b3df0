// Starts for meshes that collide as triangles, and the rule by which a frame of a trajectory ends
// with the answer of the frame before. Elsewhere search/ asks MeshesOverlap, once a search.
//
// A translation takes a rigid body out of an overlap by a short way. For a link it may be a detour:
// a finger is carried over the rim of a cup where its joints could have moved it back through the
// wall. So links begin with the answer of their convex hulls (hull_stage.h) and with overlapping
// pairs parted one after the other (pair_by_pair.h). A descent from q_in comes last, and for rigid
// bodies only if translations found nothing near, because the depth of overlapping triangles says
// little about the way out.
#ifndef MJCF_PDG_SRC_SEARCH_EXACT_MESH_STARTS_H_
#define MJCF_PDG_SRC_SEARCH_EXACT_MESH_STARTS_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "problem/effort.h"
#include "problem/workspace.h"
#include "search/trials.h"
#include "search/varied_starts.h"
#include "start/pair_by_pair.h"
#include "start/selection.h"

namespace mjcf_pdg {

// True if some of the pairs that overlap at q_in collide as triangles.
bool MeshesOverlap(const std::vector<NearPair>& overlaps);
// True if free joints alone move the geoms of these pairs.
bool AllRigid(const SceneTables& tables, const std::vector<NearPair>& overlaps);

class ExactMeshStarts {
 public:
  ExactMeshStarts(Workspace& work, Trials& trials)
      : problem_(work.problem()), work_(work), trials_(trials), parting_(work), starts_(work) {}

  // Begins a search. To be called when its first starts, those of a hint, have been tried.
  void Begin() { hinted_ = trials_.outcome().free.size(); }
  // Tries all of these starts but that of the hulls. `center` is q_in moved inside its limits,
  // `depth` the deepest overlap there [m].
  void Try(const StrategyInput& input, const VectorXd& center, double depth, Random& random);

  // How to descend from a hint, which is taken to be near its answer.
  static LocalOptions FromHint();

  // True if this frame of a trajectory may end with the answer that the last frame's led to: only
  // free bodies can move, and the answer is close to the least σ it can have. Ask once per frame.
  bool Follows(const EffortPlan& plan);
  // A frame has been searched; `best_sigma` is its answer's, infinite if it has none [m²].
  void FrameSearched(double best_sigma);
  void Forget() { searched_.reset(); }
  bool following() const { return frames_followed_ > 0; }

 private:
  void TryRays(const std::vector<NearPair>& overlaps, const VectorXd& center);
  void TryFromWithin(const VectorXd& center, double depth, Random& random);

  const Problem& problem_;
  Workspace& work_;
  Trials& trials_;
  PairByPair parting_;
  StartSelection starts_;
  VectorXd start_;          // scratch
  std::size_t hinted_ = 0;  // number of candidates that the hint's descent has found
  struct Searched {
    VectorXd q_in;
    MocapPoses mocap;
    double rms = 0.0;  // √σ of its answer [m]
  };
  std::optional<Searched> searched_;  // the last frame that was searched and solved
  int frames_followed_ = 0;           // frames in a row that ended by Follows since then
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_EXACT_MESH_STARTS_H_
