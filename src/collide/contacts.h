// Collision queries of the solver: near pairs and signed distances at a configuration, by a broad
// phase over bounding volumes and a narrow phase per pair of geoms.
//
// The broad phase goes through *all* kept pairs and does not use MuJoCo's contacts: with a positive
// margin MuJoCo 4.0 drops or misplaces box-box contacts, and it misses capsules that pierce boxes.
// The narrow phase gives signed distances: of a capsule and a box by capsule_box.h, of other convex
// geoms by convex_distance.h or, where that has no answer, by mj_geomDistance, and of exact pairs
// (a mesh collides as its triangles) by exact_contacts.h. Where an exact pair overlaps and the
// penetration depth of its convex hulls is at most twice the depth that the triangles tell, the
// hulls' depth and normal are reported: that translation is certain to separate the meshes. Pairs
// with a height field are measured by terrain_contacts.h. Pairs with an SDF have no proven
// distance: sdf_contacts.h looks for the places where they are near, and mj_collision does.
#ifndef MJCF_PDG_SRC_COLLIDE_CONTACTS_H_
#define MJCF_PDG_SRC_COLLIDE_CONTACTS_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "collide/broad_phase.h"
#include "collide/convex/convex_distance.h"
#include "collide/exact/exact_contacts.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

class TerrainContacts;
class SdfContacts;

// A kept pair that is nearer than the margin, in the world frame W. Pairs of convex geoms appear
// once; exact pairs and those with a height field once per feature (exact_contacts.h,
// terrain_contacts.h), the deepest or nearest first; those with an SDF once per feature
// (sdf_contacts.h) and then once per MuJoCo contact.
struct NearPair {
  int pair = 0;  // index into SceneTables::pairs
  // Signed distance [m], of MuJoCo's contacts contact.dist; -infinity: the geoms overlap, and the
  // depth was not asked for.
  double distance = 0.0;
  Vector3d p1_W, p2_W;  // witness points on geom 1 and geom 2 [m]
  Vector3d n_W;         // unit, from geom 1 to geom 2; distance = n · (p2 - p1)
  // The pair's. Unless it is kConvex, the plane through the witness points separates the two
  // surfaces only near these points, `distance` proves nothing about the rest of the geoms, and for
  // an overlap n is only a likely direction to separate them.
  PairKind kind = PairKind::kConvex;
};

// Keeps its own pose and remembers earlier answers as starting points: use one object per thread.
class ContactFinder {
 public:
  // `tables` must outlive this object. `clearance` is the distance that pairs shall keep [m];
  // whether it is 0 decides how exactly ExactContacts looks for the nearest triangles.
  // `data`: to be posed in turn with another finder of the same model (PosedModel::shared_data).
  explicit ContactFinder(const SceneTables& tables, double clearance = 0.0,
                         std::shared_ptr<mjData> data = nullptr);
  ~ContactFinder();

  void SetMocap(const MocapPoses& poses) { posed_.SetMocap(poses); }
  // Poses the model at q (nq entries). The queries below refer to this configuration.
  void Pose(const Eigen::Ref<const VectorXd>& q) {
    all_moved_ |= posed_.PosesAll() || tables_.moving_trees.empty();
    posed_.Pose(q);
  }
  const PosedModel& posed() const { return posed_; }
  // Drops all remembered starting points, so that later answers do not depend on earlier queries.
  // In an island, whatever else can move may stand elsewhere from here on.
  void Forget() {
    posed_.PoseAllNext();
    exact_.Forget();
    ForgetConvex();
  }
  // Drops those of convex geoms only.
  void ForgetConvex() { convex_.Forget(); }

  // All kept pairs nearer than `margin` [m], in the order of SceneTables::pairs, those with an SDF
  // last. `depths` says what to measure of overlapping exact pairs. Counts as one query. The result
  // is valid until the next Find.
  const std::vector<NearPair>& Find(double margin, Depths depths = Depths::kMeasured);

  // Appends the features of a pair that is exact or has a height field that are nearer than
  // `margin` [m], if any.
  void AppendFeatures(int pair, double margin, Depths depths, std::vector<NearPair>& out);

  // Measures the signed distance of one kept pair. Returns true and fills `near` if it is below
  // `cutoff` [m]; otherwise, and for pairs with an SDF, returns false and leaves `near` alone.
  bool Distance(int pair, double cutoff, NearPair& near);

  // A lower bound of the pair's distance [m] from bounding spheres alone; -infinity if a geom has
  // none.
  double DistanceBound(int pair) const;

  // Counts since construction: calls of Find, distances of two convex geoms, hulls or prisms
  // (whoever measured them), and box tests between triangle meshes.
  std::int64_t queries() const { return queries_; }
  std::int64_t distances() const;
  std::int64_t box_tests() const { return exact_.box_tests(); }

 private:
  // Second broad phase: false if the geoms' oriented boxes prove a distance above `margin` [m].
  bool BoundsNear(const KeptPair& kept, double margin) const;
  // The gap of an overlapping exact pair's convex hulls, if it should replace the gap of the
  // triangles, whose signed distance is `overlap` [m]; else false.
  bool HullGap(int pair, double overlap, SignedGap& gap);
  // The signed distance of the pair's geoms, meshes as their convex hulls, in W. Returns false if
  // it is not below `cutoff` [m]; `gap` may be overwritten even then.
  bool GeomGap(int pair, double cutoff, SignedGap& gap);
  // Appends to near_ what is near of pairs with an SDF; the second of one, by its functions.
  void FindSdfs(double margin);
  void AppendSdfFeatures(int pair, double margin);
  bool BoxesNear(int geom1, int geom2, double margin) const;

  const SceneTables& tables_;
  mjModel model_;  // a copy of tables_.query_model, whose margin FindSdfs overrides
  PosedModel posed_;
  ExactContacts exact_;
  const std::unique_ptr<TerrainContacts> terrain_;
  const std::unique_ptr<SdfContacts> sdf_;
  ConvexDistance convex_;
  std::vector<SignedGap> features_;
  std::vector<NearPair> near_;
  BroadPhase broad_phase_;
  bool all_moved_ = true;  // more than an island was posed since the last Find
  std::int64_t queries_ = 0, distances_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONTACTS_H_
