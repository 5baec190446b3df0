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

// Of lengths along the axes of the geom's frame.
Eigen::Vector3d Factors(const mjModel& m, int geom, double share, Shrunk what) {
  if (what != Shrunk::kThickness) return Eigen::Vector3d::Constant(1.0 - share);
  const Eigen::Vector3d half = Eigen::Map<const Eigen::Vector3d>(m.geom_aabb + 6 * geom + 3);
  Eigen::Vector3d factors = Eigen::Vector3d::Ones() - share * half.minCoeff() * half.cwiseInverse();
  // Edges that differ by rounding are as long as each other.
  constexpr double kLonger = 1.001;
  for (int axis = 0; axis < 3; ++axis) {
    const double others = std::max(half[(axis + 1) % 3], half[(axis + 2) % 3]);
    if (half[axis] > kLonger * others) factors[axis] = 1.0;
  }
  return factors;
}

void ScaleVertices(mjModel& m, int mesh, const Eigen::Vector3d& factors) {
  Eigen::Map<Eigen::Matrix3Xf> vertices(m.mesh_vert + 3 * m.mesh_vertadr[mesh], 3,
                                        m.mesh_vertnum[mesh]);
  vertices.array().colwise() *= factors.cast<float>().array();
}

void ScaleGeom(mjModel& m, int geom, const Eigen::Vector3d& factors) {
  Eigen::Map<Eigen::Vector3d> size(m.geom_size + 3 * geom);
  switch (m.geom_type[geom]) {
    case mjGEOM_SPHERE:
      size[0] *= factors[0];
      break;
    case mjGEOM_CAPSULE:  // half of its length counts without the caps
      size[1] = factors[2] * (size[1] + size[0]) - factors[0] * size[0];
      size[0] *= factors[0];
      break;
    case mjGEOM_CYLINDER:
      size[0] *= factors[0];
      size[1] *= factors[2];
      break;
    default:
      size = size.cwiseProduct(factors);
  }
  Eigen::Map<Eigen::Matrix<mjtNum, 3, 2>> box(m.geom_aabb + 6 * geom);  // centre and half edges
  box.array().colwise() *= factors.array();
  m.geom_rbound[geom] *= factors.maxCoeff();
}

}  // namespace

std::shared_ptr<const mjModel> ShrunkModel(const SceneTables& tables, double share, Shrunk what) {
  const std::shared_ptr<mjModel> model(mj_copyModel(nullptr, tables.model), mj_deleteModel);
  mjModel& m = *model;
  const std::vector<char> rests = MeshesAtRest(tables), wrapped = WrappedGeoms(m);
  std::vector<char> smaller(m.nmesh, 0);
  bool any = false;
  for (int g = 0; g < m.ngeom; ++g) {
    if (!tables.body_moves[m.geom_bodyid[g]] || !HasSizeOfItsOwn(m.geom_type[g])) continue;
    if (wrapped[g]) continue;
    const Eigen::Vector3d factors = Factors(m, g, share, what);
    if (m.geom_type[g] == mjGEOM_MESH) {
      const int mesh = m.geom_dataid[g];
      if (rests[mesh]) continue;
      if (!smaller[mesh]) ScaleVertices(m, mesh, factors);
      smaller[mesh] = 1;
    }
    if (what == Shrunk::kBodies) {
      Draw(m, g, tables.body_spheres[m.geom_bodyid[g]].center_B, 1.0 - share);
    }
    ScaleGeom(m, g, factors);
    any = true;
  }
  return any ? model : nullptr;
}

}  // namespace mjcf_pdg
