// Which pairs of geoms count: the verifier's own reading of MuJoCo's collision filters.
//
// Source: MuJoCo's documentation, "Computation / Collision detection / Selection". Explicit <pair>s
// always count. Other geoms count if they are on different bodies that a joint can separate, not on
// parent and child (unless the filter is off or the parent is static), not excluded, and if their
// contype and conaffinity match.
#ifndef MJCF_PDG_SRC_VERIFY_PAIRS_H_
#define MJCF_PDG_SRC_VERIFY_PAIRS_H_

#include <mujoco/mujoco.h>

#include <array>
#include <set>
#include <utility>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::verify {

// Of a pair with a geom of this type (mjtGeom) nothing is proven: verifier.h says what decides it.
bool IsSdf(int type);

struct CheckedPair {
  int geom1 = 0, geom2 = 0;  // ids, ordered by type (mjtGeom), then by id
  double allowed = 0.0;      // overlap that a negative margin + gap allows [m], >= 0
  double margin = 0.0;       // nearer than this MuJoCo pushes on the pair [m]
  bool sdf = false;          // one of the geoms is an SDF
  bool terrain = false;      // not sdf, and geom 1 is a height field
  bool exact = false;        // neither of these, and a mesh of it collides as its triangles
  bool separable = true;     // some movable joint lies between the two geoms

  bool convex() const { return !sdf && !terrain && !exact; }
};

// Returns all pairs that count, sorted by the lower, then the higher geom id. `exact` says for each
// geom whether it collides as its triangles. Overlaps are allowed
// as the model and options.allow say. Throws Error if the options name no body or geom.
std::vector<CheckedPair> FindPairs(const mjModel& m, const SceneOptions& options,
                                   const std::vector<char>& exact);

// Pairs of geoms (lower id, higher id).
using LeftOut = std::set<std::pair<int, int>>;

// The pairs that the options exclude, and those of `ignored`. Throws Error for an unknown name.
LeftOut PairsLeftOut(const mjModel& m, const SceneOptions& options,
                     const std::vector<std::array<int, 2>>& ignored);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_PAIRS_H_
