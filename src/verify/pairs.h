// Which pairs of geoms count: the independent check's own reading of MuJoCo's filters.
//
// Source: MuJoCo's documentation, "Computation / Collision detection / Selection": explicit <pair>s
// always; else two geoms of different bodies that a joint can part, not parent and child (unless
// the filter is off or the parent is static), not excluded, whose contype and conaffinity meet.
#ifndef MJCF_PDG_SRC_VERIFY_PAIRS_H_
#define MJCF_PDG_SRC_VERIFY_PAIRS_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::verify {

struct CheckedPair {
  int geom1 = 0, geom2 = 0;   // by type, then by id
  double allowed = 0.0;       // overlap that a negative margin + gap allows [m], >= 0
  bool contact_only = false;  // an SDF or a height field: MuJoCo's contacts are all there is
  bool exact = false;         // one of them or both collide as their triangles
  bool separable = true;      // some movable joint lies between the two
};

// All pairs. `exact`: per geom, collides as its triangles.
std::vector<CheckedPair> FindPairs(const mjModel& m, const SceneOptions& options,
                                   const std::vector<char>& exact);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_PAIRS_H_
