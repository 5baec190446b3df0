// Which mesh geoms collide as their triangles, and the triangles of every geom that they can meet.
#ifndef MJCF_PDG_SRC_MODEL_EXACT_MESH_H_
#define MJCF_PDG_SRC_MODEL_EXACT_MESH_H_

#include <vector>

#include "mjcf_pdg/scene.h"
#include "model/scene_tables.h"

namespace mjcf_pdg {

// Fills tables.exact: the geoms that the model's text "mjcf_pdg.exact_mesh" names (blanks between
// them), all mesh geoms if it has no such text, none unless options.exact_mesh is set. Throws Error
// for a name that is no mesh geom's. Fills tables.convex: those of them that are convex.
void MarkExactGeoms(const SceneOptions& options, SceneTables& tables);

// Fills tables.solids for the geoms of exact pairs, once the pairs are known: exact meshes, convex
// hulls of other meshes, boxes. Meshes that are not closed are named in tables.warnings. Throws
// Error for a mesh without area or hull.
void BuildBvhs(SceneTables& tables);

// Some geoms that count collide as their triangles.
bool HasExactMeshes(const SceneTables& tables);

// The same scene whose meshes collide as their convex hulls.
SceneTables WithHulls(SceneTables tables);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_EXACT_MESH_H_
