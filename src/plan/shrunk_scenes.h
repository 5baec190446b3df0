// Scenes in which what moves is smaller: more room for a planner, and less and less of it, until it
// is as the scene has it. As bodies grow in a narrow passage they turn into the only way through.
//
// No way to be smaller is good everywhere. A bent tube as a whole is a short one, which passes
// anywhere; its geoms, each by itself, are as far apart as ever. Half of a U does not pass through
// a hole that is shaped like a U; its geoms do at any size, as they lie in those of a larger one.
// Of an arm that has its hand behind a wall smaller links are apart, so that the wall passes
// between them, and a small hand finds no slot; links that are thin still lead through it.
//
// Sources: Bayazit, Xie & Amato, Iterative relaxation of constraints: a framework for improving
// automated motion planning (IROS 2005); Saha, Latombe, Chang & Prinz, Finding narrow passages with
// probabilistic roadmaps: the small-step retraction method (Autonomous Robots, 2005).
#ifndef MJCF_PDG_SRC_PLAN_SHRUNK_SCENES_H_
#define MJCF_PDG_SRC_PLAN_SHRUNK_SCENES_H_

#include <vector>

#include "mjcf_pdg/scene.h"
#include "model/shrunk_model.h"

namespace mjcf_pdg {

// What moves has a sixteenth of its size or thickness (model/shrunk_model.h), then two, up to
// fifteen. Empty if nothing that moves can be smaller.
std::vector<Scene> ShrunkScenes(const Scene& scene, Shrunk what);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_SHRUNK_SCENES_H_
