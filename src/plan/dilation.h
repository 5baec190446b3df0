// Dilated scenes: more room for the planner. Geoms may overlap by some depth there, so that a
// passage is wider by twice that.
//
// Source: Hsu, Sanchez-Ante, Cheng & Latombe, Multi-level free-space dilation for sampling narrow
// passages in PRM planning (ICRA 2006).
#ifndef MJCF_PDG_SRC_PLAN_DILATION_H_
#define MJCF_PDG_SRC_PLAN_DILATION_H_

#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg {

// The scene dilated by less and less: a pair that can move apart may overlap by the least width of
// its geom that moves (of the thinner one, if both do), then by a half of that, a quarter, down to
// a 64th. Pairs of exact meshes, height fields and SDFs keep what they have; empty if there are no
// others.
std::vector<Scene> DilatedScenes(const Scene& scene);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_DILATION_H_
