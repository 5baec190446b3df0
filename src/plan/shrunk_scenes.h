// Scenes in which what moves is smaller: more room for a planner, and less and less of it, until it
// is as the scene has it. As bodies grow in a narrow passage they turn into the only way through.
//
// Sources: Bayazit, Xie & Amato, Iterative relaxation of constraints: a framework for improving
// automated motion planning (IROS 2005); Saha, Latombe, Chang & Prinz, Finding narrow passages with
// probabilistic roadmaps: the small-step retraction method (Autonomous Robots, 2005).
#ifndef MJCF_PDG_SRC_PLAN_SHRUNK_SCENES_H_
#define MJCF_PDG_SRC_PLAN_SHRUNK_SCENES_H_

#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg {

// Each body that moves has a sixteenth of its size (model/shrunk_model.h), then twice as much, up
// to a half; then it lacks half as much each time, down to 3 %. Empty if nothing that moves can be
// smaller.
std::vector<Scene> ShrunkScenes(const Scene& scene);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_SHRUNK_SCENES_H_
