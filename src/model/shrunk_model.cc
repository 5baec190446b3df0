#include "model/shrunk_model.h"

#include <algorithm>
#include <vector>

namespace mjcf_pdg {
namespace {

bool HasSizeOfItsOwn(int type) {
  return type != mjGEOM_PLANE && type != mjGEOM_HFIELD && type != mjGEOM_SDF;
}

// nmesh: a geom that does not become smaller has the mesh, as it is at rest or an SDF.
std::vector<char> MeshesAtRest(const SceneTables& tables) {
  const mjModel& m = *tables.model;
  std::vector<char> rests(m.nmesh, 0);
  for (int g = 0; g < m.ngeom; ++g) {
    const bool has_mesh = m.geom_type[g] == mjGEOM_MESH || m.geom_type[g] == mjGEOM_SDF;
    const bool stays = m.geom_type[g] == mjGEOM_SDF || !tables.body_moves[m.geom_bodyid[g]];
    if (has_mesh && stays && m.geom_dataid[g] >= 0) rests[m.geom_dataid[g]] = 1;
  }
  return rests;
}

// ngeom: a tendon wraps around the geom, so that its size is part of the tendon's length.
std::vector<char> WrappedGeoms(const mjModel& m) {
  std::vector<char> wrapped(m.ngeom, 0);
  for (int w = 0; w < m.nwrap; ++w) {
    if (m.wrap_type[w] == mjWRAP_SPHERE || m.wrap_type[w] == mjWRAP_CYLINDER) {
      wrapped[m.wrap_objid[w]] = 1;
    }
  }
  return wrapped;
}

// Brings the geom nearer to a point of its body's frame.
void Draw(mjModel& m, int geom, const Eigen::Vector3d& center_B, double factor) {
  Eigen::Map<Eigen::Vector3d> pos(m.geom_pos + 3 * geom);
  pos = center_B + factor * (pos - center_B);
  // What MuJoCo notes of frames that coincide: their origins do no more.
  mjtByte& same = m.geom_sameframe[geom];
  if (same == mjSAMEFRAME_BODY) same = mjSAMEFRAME_BODYROT;
  if (same == mjSAMEFRAME_INERTIA) same = mjSAMEFRAME_INERTIAROT;
}

template <typename T>
void Scale(T* begin, int count, double factor) {
  std::transform(begin, begin + count, begin, [factor](T x) { return static_cast<T>(factor * x); });
}

}  // namespace

std::shared_ptr<const mjModel> ShrunkModel(const SceneTables& tables, double share,
                                           ShrunkAbout about) {
  const double factor = 1.0 - share;
  const std::shared_ptr<mjModel> model(mj_copyModel(nullptr, tables.model), mj_deleteModel);
  mjModel& m = *model;
  const std::vector<char> rests = MeshesAtRest(tables), wrapped = WrappedGeoms(m);
  std::vector<char> smaller(m.nmesh, 0);
  bool any = false;
  for (int g = 0; g < m.ngeom; ++g) {
    if (!tables.body_moves[m.geom_bodyid[g]] || !HasSizeOfItsOwn(m.geom_type[g])) continue;
    if (wrapped[g]) continue;
    if (m.geom_type[g] == mjGEOM_MESH) {
      const int mesh = m.geom_dataid[g];
      if (rests[mesh]) continue;
      if (!smaller[mesh]) {
        Scale(m.mesh_vert + 3 * m.mesh_vertadr[mesh], 3 * m.mesh_vertnum[mesh], factor);
      }
      smaller[mesh] = 1;
    }
    if (about == ShrunkAbout::kBodies) {
      Draw(m, g, tables.body_spheres[m.geom_bodyid[g]].center_B, factor);
    }
    Scale(m.geom_size + 3 * g, 3, factor);
    Scale(m.geom_aabb + 6 * g, 6, factor);
    m.geom_rbound[g] *= factor;
    any = true;
  }
  return any ? model : nullptr;
}

}  // namespace mjcf_pdg
