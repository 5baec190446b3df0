// Relaxed scenes: more room for the planner, and less and less of it, until it is as the scene has
// it. Two ways to have it, because neither is good everywhere (bench/README.md, plan_bench):
// shrunken geoms of an arm leave gaps between its links, through which walls pass, and a body that
// may overlap passes through the seams between the geoms that a wall is made of.
//
// Sources: Hsu, Sanchez-Ante, Cheng & Latombe, Multi-level free-space dilation for sampling narrow
// passages in PRM planning (ICRA 2006); Saha, Latombe, Chang & Prinz, Finding narrow passages with
// probabilistic roadmaps: the small-step retraction method (Autonomous Robots, 2005).
#ifndef MJCF_PDG_SRC_PLAN_RELAXED_SCENES_H_
#define MJCF_PDG_SRC_PLAN_RELAXED_SCENES_H_

#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg {

// What moves is smaller (model/shrunk_model.h) by three quarters, then by half of that, and so on
// down to 2.3 %. Empty if nothing that moves can be smaller, or if meshes collide as their
// triangles: the way out where triangles cross is a guess, so that retracted paths are seldom near.
std::vector<Scene> ShrunkScenes(const Scene& scene);

// A pair that can move apart may overlap by the least width of its geom that moves (of the thinner
// one, if both do), then by a half of that, a quarter, down to a 64th. Pairs of exact meshes,
// height fields and SDFs keep what they have; empty if there are no others.
std::vector<Scene> DilatedScenes(const Scene& scene);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_RELAXED_SCENES_H_
