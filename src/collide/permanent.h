// Pairs that overlap wherever the joints go: links that are drawn into each other. Not in the
// paper.
#ifndef MJCF_PDG_SRC_COLLIDE_PERMANENT_H_
#define MJCF_PDG_SRC_COLLIDE_PERMANENT_H_

#include <array>
#include <vector>

#include "model/scene_tables.h"

namespace mjcf_pdg {

// The kept pairs (geom ids, ascending) that overlap at qpos0, in every keyframe and in each of 200
// random configurations of all joints, inside limits. This is evidence, not proof. Takes one query
// where nothing overlaps at qpos0, and else as many as it needs to see each pair apart once.
std::vector<std::array<int, 2>> FindPermanentOverlaps(const SceneTables& tables);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_PERMANENT_H_
