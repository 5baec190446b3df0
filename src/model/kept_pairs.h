// Finds the pairs of geoms whose overlap counts, since MuJoCo's filters keep them, and a bounding
// sphere of each body's geoms: the input of the broad phase (collide/contacts.h).
#ifndef MJCF_PDG_SRC_MODEL_KEPT_PAIRS_H_
#define MJCF_PDG_SRC_MODEL_KEPT_PAIRS_H_

#include <vector>

#include "mjcf_pdg/scene.h"
#include "model/scene_tables.h"

namespace mjcf_pdg {

// Fills tables.pairs, body_pairs, body_spheres, has_sdf_pairs and largest_kept, which must
// be empty. Reads tables.model, column_of_dof, exact, convex, excluded and ignored; of the options
// those of allowed overlaps, margins and flags. Follows engine_collision_driver.c of MuJoCo 4.0:
// explicit <pair>s always count; of all others those count that pass the contype/conaffinity, weld,
// parent-child and <exclude> filters. Throws Error for a geom of such a pair whose type we do not
// know.
void FillKeptPairs(const SceneOptions& options, SceneTables& tables);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_KEPT_PAIRS_H_
