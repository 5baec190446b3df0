#include "collide/sdf/posed_field.h"

#include <limits>

#include "collide/exact/primitive_sdf.h"

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double BoxDistance(const Vector3d& half, const Vector3d& x) {
  const Vector3d beyond = x.cwiseAbs() - half;
  const double largest = beyond.maxCoeff();
  return largest <= 0.0 ? largest : beyond.cwiseMax(0.0).norm();
}

Vector3d BoxNormal(const Vector3d& half, const Vector3d& x) {
  const Vector3d beyond = x.cwiseAbs() - half;
  Eigen::Index face = 0;
  Vector3d n = Vector3d::Zero();
  if (beyond.maxCoeff(&face) <= 0.0) {
    n[face] = 1.0;
  } else {
    n = beyond.cwiseMax(0.0);
  }
  return n.cwiseProduct((x.array() < 0.0).select(-Vector3d::Ones(), Vector3d::Ones()));
}

}  // namespace

PosedField::PosedField(const PosedModel& posed, int geom)
    : m_(*posed.model()), d_(*posed.data()), geom_(geom), type_(m_.geom_type[geom]) {
  origin_W_ = AsVector(d_.geom_xpos + 3 * geom);
  R_ = AsMatrix(d_.geom_xmat + 9 * geom);
  if (type_ != mjGEOM_SDF || m_.geom_plugin[geom] < 0) return;
  const int mesh = m_.geom_dataid[geom];
  mjtNum pos[3], quat[4], mat[9];
  mju_negPose(pos, quat, m_.mesh_pos + 3 * mesh, m_.mesh_quat + 4 * mesh);
  mju_quat2Mat(mat, quat);
  origin_W_ += R_ * AsVector(pos);
  R_ = R_ * AsMatrix(mat);
}

double PosedField::At(const Vector3d& x_W) const {
  return AtLocal(R_.transpose() * (x_W - origin_W_));
}

Vector3d PosedField::Normal(const Vector3d& x_W) const {
  const Vector3d n = NormalAtLocal(R_.transpose() * (x_W - origin_W_));
  const double length = n.norm();
  return length > 0.0 ? Vector3d(R_ * n / length) : Vector3d::UnitZ();
}

// Of a convex hull it is the largest distance from the plane of a face: exact inside, and outside
// no more than the true one.
int PosedField::FarthestFace(const Vector3d& x, double& distance) const {
  const int mesh = m_.geom_dataid[geom_], first = m_.mesh_polyadr[mesh];
  const float* vertices = m_.mesh_vert + 3 * m_.mesh_vertadr[mesh];
  int farthest = first;
  distance = -kInfinity;
  for (int face = first; face < first + m_.mesh_polynum[mesh]; ++face) {
    const float* corner = vertices + 3 * m_.mesh_polyvert[m_.mesh_polyvertadr[face]];
    const Vector3d on_face(corner[0], corner[1], corner[2]);
    const double beyond = AsVector(m_.mesh_polynormal + 3 * face).dot(x - on_face);
    if (beyond <= distance) continue;
    distance = beyond;
    farthest = face;
  }
  return farthest;
}

double PosedField::AtLocal(const Vector3d& x) const {
  const Vector3d size = AsVector(m_.geom_size + 3 * geom_);
  switch (type_) {
    case mjGEOM_SDF: {
      const mjpPlugin* plugin = m_.geom_plugin[geom_] < 0 ? nullptr : mjc_getSDF(&m_, geom_);
      int id = plugin ? m_.geom_plugin[geom_] : m_.geom_dataid[geom_];
      mjtGeom type = mjGEOM_SDF;
      const mjSDF field = {&plugin, &id, mjSDFTYPE_SINGLE, nullptr, nullptr, &type};
      return mjc_distance(&m_, &d_, &field, x.data());
    }
    case mjGEOM_BOX:
      return BoxDistance(size, x);
    case mjGEOM_MESH: {
      double distance;
      FarthestFace(x, distance);
      return distance;
    }
    default:
      return PrimitiveSdf{type_, size}.At(x).f;
  }
}

Vector3d PosedField::NormalAtLocal(const Vector3d& x) const {
  const Vector3d size = AsVector(m_.geom_size + 3 * geom_);
  switch (type_) {
    case mjGEOM_SDF:
      return SdfGradient(x);
    case mjGEOM_BOX:
      return BoxNormal(size, x);
    case mjGEOM_MESH: {
      double distance;
      return AsVector(m_.mesh_polynormal + 3 * FarthestFace(x, distance));
    }
    default:
      return PrimitiveSdf{type_, size}.At(x).gradient;
  }
}

// By central differences: functions of plugins need not have derivatives that fit them.
Vector3d PosedField::SdfGradient(const Vector3d& x) const {
  const double step = 1e-6 * m_.geom_rbound[geom_];
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d by = step * Vector3d::Unit(axis);
    gradient[axis] = AtLocal(x + by) - AtLocal(x - by);
  }
  return gradient;
}

}  // namespace mjcf_pdg
