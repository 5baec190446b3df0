// A pair of geoms at the poses that MuJoCo's kinematics gave them: bounds of its distance, its
// convex shapes, and certificates in world axes.
#ifndef MJCF_PDG_SRC_VERIFY_POSED_PAIR_H_
#define MJCF_PDG_SRC_VERIFY_POSED_PAIR_H_

#include <mujoco/mujoco.h>

#include <limits>

#include "verify/convex/certificate.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg::verify {

// A signed distance [m] with its unit normal from geom 1 to geom 2 and its witness points, in world
// axes.
struct Reading {
  double distance = 0.0;
  Vector3d n_W = Vector3d::UnitX(), p1_W = Vector3d::Zero(), p2_W = Vector3d::Zero();
};

// The gap of two oriented bounding boxes along an axis: 0 to 2 of the first one's, 3 to 5 of the
// second one's.
struct AxisGap {
  double gap = -std::numeric_limits<double>::infinity();  // [m]
  int axis = 0;
};

// Refers to its model, data and pair, which must outlive it.
struct PosedPair {
  const VerifierModel& model;
  const mjData& data;
  const CheckedPair& pair;

  bool HasPlane() const { return model.unblinded.geom_type[pair.geom1] == mjGEOM_PLANE; }
  // The length that tolerances of the pair are given relative to: the sum of the two extents [m].
  double size() const { return model.shapes[pair.geom1].extent + model.shapes[pair.geom2].extent; }

  // Lower bounds of the pair's signed distance [m]; -infinity if nothing is known. They come from
  // bounding spheres about the geoms' origins, and from the gaps of the oriented bounding boxes
  // (geom_aabb) along the axes of both: along one, and the widest with its axis.
  double SphereBound() const;
  double BoxGap(int axis) const;
  AxisGap BoxBound() const;

  // The shapes of two convex geoms, and a certificate about them in world axes.
  ConvexPair Shapes() const;
  Reading ToWorld(const Certificate& found) const;

  // The signed distance of a plane, which is a half-space, and a convex geom: that of the geom's
  // lowest point.
  Reading AgainstPlane() const;

  // Decides whether the signed distance of two convex geoms, or of a plane and one, is at least
  // `needed` [m], less the rounding error. The certificate is in world axes.
  Certificate Decide(double needed) const;
};

inline Eigen::Map<const Vector3d> VectorAt(const mjtNum* p) {
  return Eigen::Map<const Vector3d>(p);
}

// The rotation from the geom's axes to the world's.
inline Matrix3d GeomRotation(const mjData& d, int geom) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d.geom_xmat + 9 * geom);
}

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_POSED_PAIR_H_
