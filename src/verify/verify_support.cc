#include "verify/verify_support.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/kinematics.h"

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// All vertices, those inside the hull too: they are never the farthest.
double FarthestVertex(const mjModel& m, int mesh, const Vector3d& n) {
  double farthest = -kInfinity;
  const float* p = m.mesh_vert + 3 * m.mesh_vertadr[mesh];
  for (int v = 0; v < m.mesh_vertnum[mesh]; ++v, p += 3) {
    farthest = std::max(farthest, n.x() * p[0] + n.y() * p[1] + n.z() * p[2]);
  }
  return farthest;
}

// How far the geom reaches along n from its own origin, in its own frame.
double Reach(const mjModel& m, int geom, const Vector3d& n) {
  const Vector3d size = AsVector(m.geom_size + 3 * geom);
  switch (m.geom_type[geom]) {
    case mjGEOM_SPHERE:
      return size[0];
    case mjGEOM_CAPSULE:
      return size[0] + size[1] * std::abs(n.z());
    case mjGEOM_ELLIPSOID:
      return size.cwiseProduct(n).norm();
    case mjGEOM_CYLINDER:
      return size[0] * std::hypot(n.x(), n.y()) + size[1] * std::abs(n.z());
    case mjGEOM_BOX:
      return size.dot(n.cwiseAbs());
    case mjGEOM_MESH:
      return FarthestVertex(m, m.geom_dataid[geom], n);
    default:
      return kInfinity;
  }
}

class Pair {
 public:
  Pair(const mjModel& m, const mjData& d, int geom1, int geom2)
      : m_(m),
        geom1_(geom1),
        geom2_(geom2),
        R1_(AsMatrix(d.geom_xmat + 9 * geom1)),
        R2_(AsMatrix(d.geom_xmat + 9 * geom2)),
        between_W_(AsVector(d.geom_xpos + 3 * geom2) - AsVector(d.geom_xpos + 3 * geom1)) {}

  double DistanceAlong(const Vector3d& n_W) const {
    return n_W.dot(between_W_) - Reach(m_, geom1_, R1_.transpose() * n_W) -
           Reach(m_, geom2_, R2_.transpose() * -n_W);
  }

 private:
  const mjModel& m_;
  const int geom1_, geom2_;
  const Matrix3d R1_, R2_;
  const Vector3d between_W_;
};

}  // namespace

double DistanceAlong(const mjModel& m, const mjData& d, int geom1, int geom2, const Vector3d& n_W,
                     double enough) {
  constexpr int kRounds = 100, kTurns = 8;
  const Pair pair(m, d, geom1, geom2);
  Vector3d best_W = n_W;
  double most = pair.DistanceAlong(n_W), step = 0.02;
  for (int round = 0; round < kRounds && most < enough; ++round) {
    const double before = most;
    const Vector3d u = best_W.unitOrthogonal(), v = best_W.cross(u);
    for (int k = 0; k < kTurns; ++k) {
      const double turn = round + 2.0 * M_PI * k / kTurns;
      const Vector3d way = std::cos(turn) * u + std::sin(turn) * v;
      const Vector3d tried_W = (best_W + step * way).normalized();
      const double distance = pair.DistanceAlong(tried_W);
      if (distance <= most) continue;
      most = distance;
      best_W = tried_W;
    }
    step *= most > before ? 1.5 : 0.5;
  }
  return most;
}

}  // namespace mjcf_pdg
