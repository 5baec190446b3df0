// Signed distances and near pairs at a configuration: the solver's eyes.
//
// Candidates come from bounding volumes over *all* kept pairs, not from MuJoCo's contacts: with a
// positive margin MuJoCo 4.0 drops or misplaces box-box contacts, and it misses capsules that
// pierce boxes. Distances, depths and normals are signed pair distances: our own of convex geoms
// (convex_distance.h) and of capsules and boxes, mj_geomDistance where there is no answer,
// triangles for exact meshes (exact_contacts.h). An exact pair that overlaps is told as the
// penetration depth of its convex hulls where that is at most twice what its triangles say: a move
// by it is certain to part them. SDF and height field pairs have contacts only; those come from
// mj_collision.
#ifndef MJCF_PDG_SRC_COLLIDE_CONTACTS_H_
#define MJCF_PDG_SRC_COLLIDE_CONTACTS_H_

#include <cstdint>
#include <vector>

#include "collide/convex/convex_distance.h"
#include "collide/exact/exact_contacts.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// A kept pair within the margin. Contact-only and exact pairs may appear several times, once per
// contact or feature.
struct NearPair {
  int pair = 0;           // index into SceneTables::pairs
  double distance = 0.0;  // signed [m]; -infinity: an overlap whose depth was not asked
  Vector3d p1_W, p2_W;    // witness points on geom 1 and geom 2
  Vector3d n_W;           // unit, from geom 1 to geom 2; distance = n · (p2 - p1)
  // A local feature of two geoms that are not both convex: the plane holds nearby, no bound follows
  // from its distance, and of an overlap the normal is a guess.
  bool local = false;
};

// One per thread. Counts its queries.
class ContactFinder {
 public:
  // `clearance`: how far apart pairs shall be [m] (ExactContacts).
  explicit ContactFinder(const SceneTables& tables, double clearance = 0.0);

  void SetMocap(const MocapPoses& poses) { posed_.SetMocap(poses); }
  void Pose(const Eigen::Ref<const VectorXd>& q) { posed_.Pose(q); }
  const PosedModel& posed() const { return posed_; }
  // What follows does not depend on the queries before ...
  void Forget() {
    exact_.Forget();
    ForgetConvex();
  }
  // ... but for exact pairs.
  void ForgetConvex() { convex_.Forget(); }

  // All kept pairs nearer than `margin` at the posed configuration, in the scene's order, those
  // of SDFs and height fields last; exact pairs with their features (exact_contacts.h). One query.
  const std::vector<NearPair>& Find(double margin, Depths depths = Depths::kMeasured);

  // Appends the features of an exact pair within the margin; nothing if there are none.
  void AppendFeatures(int pair, double margin, Depths depths, std::vector<NearPair>& out);

  // Normals of the pair are those of nearest points only while it is apart, so it should stay so.
  bool NeedsGap(int pair) const { return tables_.pairs[pair].exact; }

  // Signed distance of one kept pair at the posed configuration. Exact when below `cutoff` [m];
  // otherwise returns false and leaves `near` alone. Contact-only pairs: false.
  bool Distance(int pair, double cutoff, NearPair& near);

  // A lower bound of the pair's distance from bounding volumes alone; -inf if nothing is known.
  double DistanceBound(int pair) const;

  std::int64_t queries() const { return queries_; }
  // Pair distances asked of MuJoCo or of our own tests; those of exact pairs do not count.
  std::int64_t distances() const { return distances_; }
  std::int64_t box_tests() const { return exact_.box_tests(); }

 private:
  bool BoundsNear(const KeptPair& kept, double margin) const;
  bool HullGap(int pair, double overlap, SignedGap& gap);
  bool GeomGap(int pair, double cutoff, SignedGap& gap);
  void FindContactOnly(double margin);
  bool BodiesNear(const BodyPair& bodies, double margin) const;
  bool BoxesNear(int geom1, int geom2, double margin) const;

  const SceneTables& tables_;
  mjModel model_;  // the scene's query model with our own margin
  PosedModel posed_;
  ExactContacts exact_;
  ConvexDistance convex_;
  std::vector<SignedGap> features_;
  std::vector<NearPair> near_;
  std::vector<Vector3d> centers_W_;  // of body_spheres
  std::int64_t queries_ = 0, distances_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONTACTS_H_
