// Exact meshes (--exact-mesh): which mesh geoms collide as their triangles instead of their convex
// hulls, and the triangle meshes of all geoms that need them for that.
// solve/make_tables.cc calls these while it fills the SceneTables.
#ifndef MJCF_PDG_SRC_MODEL_EXACT_MESH_H_
#define MJCF_PDG_SRC_MODEL_EXACT_MESH_H_

#include <vector>

#include "mjcf_pdg/scene.h"
#include "model/scene_tables.h"

namespace mjcf_pdg {

// Fills tables.exact and tables.convex from tables.model. Without options.exact_mesh no geom is
// exact; a model that marks meshes then gets a warning in tables.warnings. With it, the geoms that
// the model's text "mjcf_pdg.exact_mesh" names (separated by blanks) are exact, or all mesh geoms
// if there is no such text. Throws Error for a name that is not a mesh geom's. A geom is convex if
// it is exact and its mesh is its own hull (convex_mesh.h).
void MarkExactGeoms(const SceneOptions& options, SceneTables& tables);

// Fills tables.bvhs and tables.tree_units, once tables.pairs and tables.size are known. The
// meshes and boxes of exact pairs get their triangles; a mesh that is not exact gets those of its
// convex hull. Meshes that are not closed are named in tables.warnings. Throws Error for a mesh
// without area or hull.
void BuildBvhs(SceneTables& tables);

// True if a kept pair with a signed distance contains a geom marked exact, even if it is convex.
bool HasExactMeshes(const SceneTables& tables);

// A copy of the tables in which no pair is exact: meshes collide as their convex hulls.
SceneTables WithHulls(SceneTables tables);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_EXACT_MESH_H_
