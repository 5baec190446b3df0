// Signed distances and contact features of the pairs in which a mesh collides as its triangles.
//
// Meshes, boxes and convex hulls are triangles against triangles (bvh_pair.h, bvh_overlap.h);
// planes, spheres, capsules, ellipsoids and cylinders are signed distance functions on triangles
// (sdf_mesh.h). What the depth of an overlap is, those headers say.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_EXACT_CONTACTS_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_EXACT_CONTACTS_H_

#include <cstdint>
#include <vector>

#include "base/signed_gap.h"
#include "collide/exact/bvh_pair.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// What is asked of an exact pair.
enum class ExactQuery {
  kNearest,             // the nearest feature alone; of an overlap its deepest places
  kFeatures,            // all features within a margin; of an overlap its deepest places, measured
  kSearchedFeatures,    // the same, looking many times as long for those places
  kUnmeasuredFeatures,  // the same, of an overlap only that there is one
};

// One per thread: it remembers the nearest triangles of every pair, as a start for the next query.
class ExactContacts {
 public:
  // With a clearance, features begin with the nearest of all: whether meshes are far enough from
  // each other hangs on it. Without, one that is 1.25 times as far will do.
  ExactContacts(const SceneTables& tables, double clearance)
      : tables_(tables), rough_(clearance == 0.0), warm_(tables.pairs.size()) {}

  // Forgets the nearest triangles. Which of equally near ones Distance finds, and which of those
  // nearer than 1.25 times the distance Features begins with, may depend on them.
  void Forget() { warm_.assign(warm_.size(), NearestTriangles()); }

  // Signed distance of an exact pair at the pose, witness points in world axes [m]. False, and
  // `gap` left alone, when it is not below `cutoff`. Negative where the solids overlap, a body
  // wholly inside another included.
  bool Distance(const PosedModel& posed, int pair, double cutoff, SignedGap& gap);

  // The features below `margin`, the nearest or deepest first; empty when there is none. Those of
  // two triangle meshes that are much farther than the nearest are left out (bvh_pair.h). An
  // overlap comes as its deepest places, followed by the features that are apart; with skipped
  // depths, as one entry of distance -infinity with points and normal of some crossing triangles;
  // both points the same where none cross, one being inside the other. One by hardly more than
  // rounding is measured always (Graze).
  void Features(const PosedModel& posed, int pair, double margin, Depths depths,
                std::vector<SignedGap>& out);

  // Of pairs of triangle meshes, so far (bvh_pair.h).
  std::int64_t box_tests() const { return box_tests_; }

 private:
  void Ask(const PosedModel& posed, int pair, double margin, ExactQuery query,
           std::vector<SignedGap>& out);

  const SceneTables& tables_;
  const bool rough_;                    // Features may begin with one that is not quite the nearest
  std::vector<NearestTriangles> warm_;  // per pair; of a primitive only b counts
  std::vector<SignedGap> scratch_;
  std::int64_t box_tests_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_EXACT_CONTACTS_H_
