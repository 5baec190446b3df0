#include "model/exact_mesh.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "base/names.h"
#include "mesh/convex_mesh.h"
#include "mesh/mesh_hull.h"
#include "mesh/triangle_bvh.h"

namespace mjcf_pdg {
namespace {

constexpr char kMark[] = "mjcf_pdg.exact_mesh";

void MarkNamed(const std::string& names, SceneTables& tables) {
  const mjModel& m = *tables.model;
  std::istringstream words(names);
  for (std::string name; words >> name;) {
    const std::string where = std::string("text '") + kMark + "': ";
    const int geom = mj_name2id(&m, mjOBJ_GEOM, name.c_str());
    if (geom < 0) throw Error(where + "no geom named '" + name + "'");
    if (m.geom_type[geom] != mjGEOM_MESH) throw Error(where + "geom '" + name + "' is not a mesh");
    tables.exact[geom] = 1;
  }
}

Matrix3Xd MeshVertices(const mjModel& m, int mesh) {
  return Eigen::Map<const Eigen::Matrix3Xf>(m.mesh_vert + 3 * m.mesh_vertadr[mesh], 3,
                                            m.mesh_vertnum[mesh])
      .cast<double>();
}

Matrix3Xi MeshFaces(const mjModel& m, int mesh) {
  return Eigen::Map<const Matrix3Xi>(m.mesh_face + 3 * m.mesh_faceadr[mesh], 3,
                                     m.mesh_facenum[mesh]);
}

Matrix3Xi FacesOf(const MeshHull& hull) {
  return Eigen::Map<const Matrix3Xi>(hull.faces.data(), 3, std::ssize(hull.faces) / 3);
}

Matrix3Xi HullFaces(const mjModel& m, int mesh) {
  const std::optional<MeshHull> hull = HullOf(m, mesh);
  if (!hull) throw Error("the mesh has no convex hull");
  return FacesOf(*hull);
}

bool IsConvex(const mjModel& m, int mesh) {
  const std::optional<MeshHull> hull = HullOf(m, mesh);
  return hull && IsItsOwnHull({MeshVertices(m, mesh), MeshFaces(m, mesh)}, FacesOf(*hull));
}

// The twelve triangles of a box with these half sizes [m].
TriangleBvh BoxOf(const Vector3d& half, double tree_units) {
  Matrix3Xd corners(3, 8);
  for (int k = 0; k < 8; ++k) {
    const Vector3d signs(k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0);
    corners.col(k) = signs.cwiseProduct(half);
  }
  Matrix3Xi faces(3, 12);
  faces << 0, 2, 4, 5, 0, 1, 2, 3, 0, 4, 1, 3,  //
      2, 3, 5, 7, 1, 5, 6, 6, 4, 6, 3, 7,       //
      1, 1, 6, 6, 4, 4, 3, 7, 2, 2, 5, 5;
  return TriangleBvh(corners, faces, tree_units);
}

void MarkConvex(SceneTables& tables) {
  const mjModel& m = *tables.model;
  std::map<int, bool> known;  // by mesh asset
  for (int g = 0; g < m.ngeom; ++g) {
    if (!tables.exact[g]) continue;
    const auto [entry, is_new] = known.try_emplace(m.geom_dataid[g], false);
    if (is_new) entry->second = IsConvex(m, entry->first);
    tables.convex[g] = entry->second;
  }
}

}  // namespace

void MarkExactGeoms(const SceneOptions& options, SceneTables& tables) {
  const mjModel& m = *tables.model;
  tables.exact.assign(m.ngeom, 0);
  tables.convex.assign(m.ngeom, 0);
  const int text = mj_name2id(&m, mjOBJ_TEXT, kMark);
  if (!options.exact_mesh) {
    if (text < 0) return;
    tables.warnings.push_back(std::string("text '") + kMark +
                              "' marks meshes that collide as their convex hulls here: exact "
                              "meshes (--exact-mesh) were not asked for");
    return;
  }
  if (text >= 0) {
    MarkNamed(m.text_data + m.text_adr[text], tables);
  } else {
    for (int g = 0; g < m.ngeom; ++g) tables.exact[g] = m.geom_type[g] == mjGEOM_MESH;
  }
  MarkConvex(tables);
}

void BuildBvhs(SceneTables& tables) {
  const mjModel& m = *tables.model;
  tables.bvhs.assign(m.ngeom, nullptr);
  tables.tree_units = TreeUnits(tables.size);
  // By mesh asset and whether the triangles are its own (true) or those of its hull.
  std::map<std::pair<int, bool>, std::shared_ptr<const TriangleBvh>> built;
  for (const KeptPair& pair : tables.pairs) {
    if (pair.kind != PairKind::kExact) continue;
    for (const int g : {pair.geom1, pair.geom2}) {
      if (tables.bvhs[g]) continue;
      if (m.geom_type[g] == mjGEOM_BOX) {
        tables.bvhs[g] = std::make_shared<const TriangleBvh>(
            BoxOf(Eigen::Map<const Vector3d>(m.geom_size + 3 * g), tables.tree_units));
      }
      if (m.geom_type[g] != mjGEOM_MESH) continue;
      const int mesh = m.geom_dataid[g];
      const bool exact = tables.exact[g];
      std::shared_ptr<const TriangleBvh>& bvh = built[{mesh, exact}];
      try {
        if (!bvh) {
          bvh = std::make_shared<const TriangleBvh>(MeshVertices(m, mesh),
                                                    exact ? MeshFaces(m, mesh) : HullFaces(m, mesh),
                                                    tables.tree_units);
        }
      } catch (const Error& e) {
        throw Error("geom " + QuotedNameOrPlace(m, g) + ": " + e.what());
      }
      tables.bvhs[g] = bvh;
      if (bvh->closed()) continue;
      tables.warnings.push_back("mesh geom " + QuotedNameOrPlace(m, g) + " is not closed (" +
                                std::to_string(bvh->open_edges()) +
                                " open edges): a surface without inside");
    }
  }
}

bool HasExactMeshes(const SceneTables& tables) {
  return std::any_of(tables.pairs.begin(), tables.pairs.end(), [&](const KeptPair& pair) {
    return (pair.kind == PairKind::kConvex || pair.kind == PairKind::kExact) &&
           (tables.exact[pair.geom1] || tables.exact[pair.geom2]);
  });
}

SceneTables WithHulls(SceneTables tables) {
  for (KeptPair& pair : tables.pairs) {
    if (pair.kind == PairKind::kExact) pair.kind = PairKind::kConvex;
  }
  return tables;
}

}  // namespace mjcf_pdg
