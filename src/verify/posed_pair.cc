#include "verify/posed_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg::verify {
namespace {

Eigen::Map<const Vector3d> Origin(const mjData& d, int geom) {
  return VectorAt(d.geom_xpos + 3 * geom);
}

}  // namespace

double PosedPair::SphereBound() const {
  const Vector3d between = Origin(data, pair.geom2) - Origin(data, pair.geom1);
  double bound = 0.0;
  if (HasPlane()) {
    const double* up = data.geom_xmat + 9 * pair.geom1 + 2;  // third column
    bound = up[0] * between[0] + up[3] * between[1] + up[6] * between[2] -
            model.shapes[pair.geom2].extent;
  } else {
    bound = between.norm() - size();
  }
  return std::isnan(bound) ? -std::numeric_limits<double>::infinity() : bound;
}

double PosedPair::BoxGap(int axis) const {
  if (HasPlane()) return -std::numeric_limits<double>::infinity();
  const int own = axis < 3 ? pair.geom1 : pair.geom2, other = axis < 3 ? pair.geom2 : pair.geom1;
  const int i = axis < 3 ? axis : axis - 3;
  const mjtNum* R = data.geom_xmat + 9 * own + i;
  const Vector3d n_W(R[0], R[3], R[6]);
  const Vector3d n = GeomRotation(data, other).transpose() * n_W;  // in the other geom's axes
  const mjtNum* box = model.unblinded.geom_aabb + 6 * own;
  const mjtNum* other_box = model.unblinded.geom_aabb + 6 * other;
  const double between =
      n_W.dot(Origin(data, other) - Origin(data, own)) + n.dot(VectorAt(other_box)) - box[i];
  return std::abs(between) - box[3 + i] - n.cwiseAbs().dot(VectorAt(other_box + 3));
}

AxisGap PosedPair::BoxBound() const {
  if (HasPlane()) return {};
  const int geom[] = {pair.geom1, pair.geom2};
  Matrix3d R[2];
  Vector3d center[2], half[2];
  for (int k = 0; k < 2; ++k) {
    const mjtNum* box = model.unblinded.geom_aabb + 6 * geom[k];
    R[k] = GeomRotation(data, geom[k]);
    center[k] = Origin(data, geom[k]) + R[k] * VectorAt(box);
    half[k] = VectorAt(box + 3);
  }
  const Vector3d between = center[1] - center[0];
  const Matrix3d turn = R[0].transpose() * R[1];
  const Vector3d first =
      (R[0].transpose() * between).cwiseAbs() - half[0] - turn.cwiseAbs() * half[1];
  const Vector3d second =
      (R[1].transpose() * between).cwiseAbs() - half[1] - turn.transpose().cwiseAbs() * half[0];
  AxisGap widest;
  for (int axis = 0; axis < 6; ++axis) {
    const double gap = axis < 3 ? first[axis] : second[axis - 3];
    if (gap > widest.gap) widest = {gap, axis};
  }
  return widest;
}

ConvexPair PosedPair::Shapes() const {
  const Matrix3d R1 = GeomRotation(data, pair.geom1);
  return {model.shapes[pair.geom1], model.shapes[pair.geom2],
          R1.transpose() * GeomRotation(data, pair.geom2),
          R1.transpose() * (Origin(data, pair.geom2) - Origin(data, pair.geom1))};
}

Reading PosedPair::ToWorld(const Certificate& found) const {
  const Matrix3d R1 = GeomRotation(data, pair.geom1);
  const Vector3d origin = Origin(data, pair.geom1);
  return {found.gap, R1 * found.n, origin + R1 * found.p1, origin + R1 * found.p2};
}

Reading PosedPair::AgainstPlane() const {
  const ConvexShape& shape = model.shapes[pair.geom2];
  const Vector3d n_W = GeomRotation(data, pair.geom1).col(2);
  const Matrix3d R = GeomRotation(data, pair.geom2);
  const Vector3d lowest_W =
      Origin(data, pair.geom2) + R * shape.Support(-(R.transpose() * n_W)) - shape.radius * n_W;
  const double distance = n_W.dot(lowest_W - Origin(data, pair.geom1));
  return {distance, n_W, lowest_W - distance * n_W, lowest_W};
}

Certificate PosedPair::Decide(double needed) const {
  const ConvexPair shapes = Shapes();
  const double least = needed - Rounding(shapes, Origin(data, pair.geom2).norm());
  if (HasPlane()) {
    const Reading reading = AgainstPlane();
    const bool holds = reading.distance >= least;
    return {holds ? Proof::kPlane : Proof::kPoints, reading.n_W, reading.distance,
            reading.distance >= 0.0 || holds ? reading.p1_W : reading.p2_W, reading.p2_W};
  }
  const bool centred = !(shapes.between.squaredNorm() > 0.0);
  const Certificate found =
      verify::Decide(shapes, least, centred ? Vector3d::UnitX() : shapes.between);
  const Reading reading = ToWorld(found);
  return {found.proof, reading.n_W, reading.distance, reading.p1_W, reading.p2_W};
}

}  // namespace mjcf_pdg::verify
