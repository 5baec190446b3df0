// The narrow phase for exact pairs, in which a mesh collides as its triangles: signed distances and
// contact features. ContactFinder (collide/contacts.h) asks it.
//
// A feature is a pair of witness points with a normal from which the optimization makes one contact
// row; a pair of meshes has several. Meshes, boxes and convex hulls are compared triangle by
// triangle (bvh_pair.h, bvh_overlap.h); a plane, sphere, capsule, ellipsoid or cylinder is a signed
// distance function whose values on the mesh's triangles are searched (sdf_mesh.h). Those headers
// define the depth of an overlap.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_EXACT_CONTACTS_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_EXACT_CONTACTS_H_

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/signed_gap.h"
#include "collide/exact/bvh_pair.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// What to measure of an exact pair.
enum class ExactQuery {
  kNearest,             // apart: the nearest feature alone; overlapping: the deepest places
  kFeatures,            // overlapping: the deepest places; then all features that are apart
  kSearchedFeatures,    // as kFeatures, with a longer search for the deepest places (kManyParts)
  kUnmeasuredFeatures,  // as kFeatures, but of an overlap only the fact (distance -infinity)
};

// Remembers the nearest triangles of every pair as a start for the next query: use one object per
// thread.
class ExactContacts {
 public:
  // `tables` must outlive this object. With a `clearance` [m] other than 0, the first feature of
  // two meshes that are apart is the nearest one, since it decides whether they are far enough
  // apart. With 0 it may be up to 1.25 times as far, which is found faster.
  ExactContacts(const SceneTables& tables, double clearance)
      : tables_(tables), rough_(clearance == 0.0) {
    const bool any =
        std::any_of(tables.pairs.begin(), tables.pairs.end(),
                    [](const KeptPair& pair) { return pair.kind == PairKind::kExact; });
    if (any) warm_.resize(tables.pairs.size());
  }

  // Drops the remembered triangles. Answers may depend on them: which of several equally near
  // triangles Distance reports and, without a clearance, with which feature Features begins.
  void Forget() { warm_.assign(warm_.size(), NearestTriangles()); }

  // Measures the signed distance of the exact pair SceneTables::pairs[pair], which is negative
  // where the solids overlap, also if one is wholly inside the other. Returns true and fills `gap`
  // (world frame W) if the distance is below `cutoff` [m]; otherwise leaves `gap` alone.
  bool Distance(const PosedModel& posed, int pair, double cutoff, SignedGap& gap);

  // Appends the features whose distance is below `margin` [m], in the world frame W: nothing if
  // there are none. If the geoms are apart, the nearest comes first; features of two triangle
  // meshes that are much farther than the nearest are left out (BvhPair::Features). If they
  // overlap, the deepest places come first (AppendOverlaps), then features that are apart. With
  // Depths::kSkipped an overlap is one entry of distance -infinity alone: its points and normal are
  // those of two crossing triangles; if none cross, since one geom is inside the other, p1 = p2 and
  // n mean nothing. An overlap of two triangle meshes by hardly more than rounding is measured in
  // any case (Graze).
  void Features(const PosedModel& posed, int pair, double margin, Depths depths,
                std::vector<SignedGap>& out);

  // The number of box tests between triangle meshes since construction (BvhPair::box_tests).
  std::int64_t box_tests() const { return box_tests_; }

 private:
  // Appends the answer to `query` in W; margin in m.
  void Ask(const PosedModel& posed, int pair, double margin, ExactQuery query,
           std::vector<SignedGap>& out);

  const SceneTables& tables_;
  const bool rough_;  // Features may begin with a feature that is not quite the nearest
  // The nearest triangles per pair. Of a primitive and a mesh only `b`, the mesh's triangle, is
  // set.
  std::vector<NearestTriangles> warm_;  // per kept pair; empty if none is exact
  std::vector<SignedGap> scratch_;
  std::int64_t box_tests_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_EXACT_CONTACTS_H_
