// Exact meshes: the starts that triangles need, and when a frame of theirs follows the last one.
// Of the search this is the one file that knows what triangles are.
//
// Translations take a rigid body out the short way, but a finger over the rim of a cup, where its
// joints could take it back through the wall: links are parted pair by pair first, after the answer
// of their convex hulls. The direct start knows only how deep the meshes overlap, which says little
// of the way out: it comes last, and only if translations found nothing near.
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

// Some of these overlaps at q_in are of triangles.
bool MeshesOverlap(const std::vector<NearPair>& overlaps);
// Only free joints move the geoms of these pairs.
bool AllRigid(const SceneTables& tables, const std::vector<NearPair>& overlaps);

class ExactMeshStarts {
 public:
  ExactMeshStarts(Workspace& work, Trials& trials)
      : problem_(work.problem()), work_(work), trials_(trials), parting_(work), starts_(work) {}

  // A search begins whose first starts have been made.
  void Begin() { hinted_ = trials_.outcome().free.size(); }
  // All but those of the hulls, from `center`, q_in inside its limits. `depth`: the deepest overlap
  // [m].
  void Try(const StrategyInput& input, const VectorXd& center, double depth, Random& random);

  // A descent from a hint, which is near its answer.
  static LocalOptions FromHint();

  // Only free bodies of exact meshes move, and the answer from the last frame's is near what it
  // must be: the frame may end there. To be asked once a frame.
  bool Follows(const EffortPlan& plan);
  // A frame was searched; infinite if nothing was found free [m²].
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
  std::size_t hinted_ = 0;  // candidates that a hint led to
  struct Searched {
    VectorXd q_in;
    MocapPoses mocap;
    double rms = 0.0;  // √σ of its answer [m]
  };
  std::optional<Searched> searched_;  // the last frame that was searched and solved
  int frames_followed_ = 0;           // since then
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_EXACT_MESH_STARTS_H_
