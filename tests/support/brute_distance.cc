#include "tests/support/brute_distance.h"

#include <algorithm>
#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d At(const mjtNum* p) { return {p[0], p[1], p[2]}; }
Matrix3d Rotation(const mjData* d, int geom) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->geom_xmat + 9 * geom);
}

double MeshSupport(const mjModel* m, int geom, const Vector3d& n) {
  const int mesh = m->geom_dataid[geom];
  double best = -1e300;
  for (int v = 0; v < m->mesh_vertnum[mesh]; ++v) {
    const float* p = m->mesh_vert + 3 * (m->mesh_vertadr[mesh] + v);
    best = std::max(best, n.x() * p[0] + n.y() * p[1] + n.z() * p[2]);
  }
  return best;
}

double Gap(const mjModel* m, const mjData* d, int geom1, int geom2, const Vector3d& n) {
  return -Support(m, d, geom1, n) - Support(m, d, geom2, -n);
}

constexpr double kGolden = 2.399963229728653;  // golden angle [rad]: spreads directions evenly
// Improves `best` by steps along tangents at its n_W that turn by the golden angle. The step [rad]
// grows after a success and is halved after 24 failures.
void Climb(const mjModel* m, const mjData* d, int geom1, int geom2, double step, BruteGap& best) {
  double turn = 0.0;
  int tries = 0;
  while (step > 1e-10) {
    const Vector3d u = best.n_W.unitOrthogonal(), v = best.n_W.cross(u);
    const Vector3d n = (best.n_W + step * (std::cos(turn) * u + std::sin(turn) * v)).normalized();
    const double gap = Gap(m, d, geom1, geom2, n);
    if (gap > best.distance) {
      best = {gap, n};
      tries = 0;
      step *= 1.5;
    } else {
      turn += kGolden;
      if (++tries % 24 == 0) step *= 0.5;
    }
  }
}

}  // namespace

double Support(const mjModel* m, const mjData* d, int geom, const Vector3d& n_W) {
  const Vector3d n = Rotation(d, geom).transpose() * n_W;
  const Vector3d size = At(m->geom_size + 3 * geom);
  const double origin = n_W.dot(At(d->geom_xpos + 3 * geom));
  switch (m->geom_type[geom]) {
    case mjGEOM_SPHERE:
      return origin + size[0] * n.norm();
    case mjGEOM_CAPSULE:
      return origin + size[0] * n.norm() + size[1] * std::abs(n.z());
    case mjGEOM_ELLIPSOID:
      return origin + size.cwiseProduct(n).norm();
    case mjGEOM_CYLINDER:
      return origin + size[0] * n.head<2>().norm() + size[1] * std::abs(n.z());
    case mjGEOM_BOX:
      return origin + size.dot(n.cwiseAbs());
    case mjGEOM_MESH:
      return origin + MeshSupport(m, geom, n);
  }
  ADD_FAILURE() << "no support function for " << TypeName(m->geom_type[geom]);
  return 0.0;
}

BruteGap BruteDistance(const mjModel* m, const mjData* d, int geom1, int geom2) {
  if (m->geom_type[geom2] == mjGEOM_PLANE) {
    const BruteGap flipped = BruteDistance(m, d, geom2, geom1);
    return {flipped.distance, -flipped.n_W};
  }
  if (m->geom_type[geom1] == mjGEOM_PLANE) {
    const Vector3d up = Rotation(d, geom1).col(2);
    return {-Support(m, d, geom2, -up) - up.dot(At(d->geom_xpos + 3 * geom1)), up};
  }
  constexpr int kDirections = 1500;  // on a spiral: about 0.09 rad apart
  std::vector<BruteGap> starts(kDirections);
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - (2 * i + 1.0) / kDirections, r = std::sqrt(1.0 - z * z);
    starts[i].n_W = Vector3d(r * std::cos(kGolden * i), r * std::sin(kGolden * i), z);
    starts[i].distance = Gap(m, d, geom1, geom2, starts[i].n_W);
  }
  constexpr int kClimbs = 8;
  std::partial_sort(starts.begin(), starts.begin() + kClimbs, starts.end(),
                    [](const BruteGap& a, const BruteGap& b) { return a.distance > b.distance; });
  BruteGap best = starts[0];
  for (int i = 0; i < kClimbs; ++i) {
    Climb(m, d, geom1, geom2, 0.05, starts[i]);
    if (starts[i].distance > best.distance) best = starts[i];
  }
  return best;
}

}  // namespace mjcf_pdg::test
