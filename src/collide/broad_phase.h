// The first broad phase of ContactFinder: which bodies may be near each other, by the spheres
// around their geoms.
//
// Of many pairs a list is kept of those that are near, with some distance to spare, and searched
// instead of all until a body has moved too far for that. It is made by a sweep over the spheres
// along the axis on which they are spread widest, or from all pairs where those are not many more
// than the bodies, as in an island. What Near returns does not depend on the list.
#ifndef MJCF_PDG_SRC_COLLIDE_BROAD_PHASE_H_
#define MJCF_PDG_SRC_COLLIDE_BROAD_PHASE_H_

#include <vector>

#include "model/kinematics.h"

namespace mjcf_pdg {

class BroadPhase {
 public:
  // `tables` must outlive this object.
  explicit BroadPhase(const SceneTables& tables);

  // The pairs, as indices of SceneTables::body_pairs, whose spheres are no farther apart than
  // `margin` [m], ascending. `all_moved`: since the last call more may have been posed than an
  // island. Valid until the next call; allocates nothing once the lists have grown.
  const std::vector<int>& Near(const PosedModel& posed, double margin, bool all_moved);

 private:
  struct Swept {
    int body = 0;
    double low = 0.0, high = 0.0;  // the sphere's ends along the axis, half of the reach around it
  };
  void MoveCenters(const mjData& data, bool all_moved);
  bool AreNear(int pair, double margin) const;
  bool ListHolds(double margin);
  void MakeList(double reach);
  void Sweep(double reach);
  int PairOf(int body1, int body2) const;  // -1: none

  const SceneTables& tables_;
  std::vector<int> moving_bodies_;   // that Pose moves: in an island its own (model/island.h)
  std::vector<Vector3d> centers_W_;  // of SceneTables::body_spheres, as posed

  bool lists_ = false, sweeps_ = false;
  std::vector<Swept> swept_;         // in the order of the last sweep, so that sorting is quick
  std::vector<int> begin_;           // by body: its first pair as body1; one more entry
  std::vector<int> of_all_, found_;  // pairs of spheres without bounds; of others, near
  std::vector<int> listed_;          // ascending
  std::vector<Vector3d> listed_W_;   // the centers when the list was made; empty: there is none
  double listed_reach_ = 0.0;        // pairs no farther apart were listed [m]
  double moved_ = 0.0;               // the farthest that a body had moved since [m]
  std::vector<int> near_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_BROAD_PHASE_H_
