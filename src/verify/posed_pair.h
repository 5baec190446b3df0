// A pair of geoms where MuJoCo's kinematics has put them: bounds, and its convex shapes.
#ifndef MJCF_PDG_SRC_VERIFY_POSED_PAIR_H_
#define MJCF_PDG_SRC_VERIFY_POSED_PAIR_H_

#include <mujoco/mujoco.h>

#include "verify/certificate.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg::verify {

// A signed distance [m] with its normal from geom 1 to geom 2 and its witness points, world axes.
struct Reading {
  double distance = 0.0;
  Vector3d n_W = Vector3d::UnitX(), p1_W = Vector3d::Zero(), p2_W = Vector3d::Zero();
};

struct PosedPair {
  const VerifierModel& model;
  const mjData& data;
  const CheckedPair& pair;

  bool HasPlane() const { return model.unblinded.geom_type[pair.geom1] == mjGEOM_PLANE; }
  // What lengths are relative to: how far the two reach from their origins [m].
  double size() const { return model.shapes[pair.geom1].extent + model.shapes[pair.geom2].extent; }

  // Never above the pair's distance; -inf when nothing is known: from bounding spheres, and from
  // the oriented boxes, along their own axes.
  double SphereBound() const;
  double BoxBound() const;

  // Of two convex geoms.
  ConvexPair Shapes() const;
  Reading ToWorld(const Certificate& found) const;

  // Of a half-space and a convex geom: one support point tells all.
  Reading AgainstPlane() const;

  // Is the signed distance at least `needed`, but for rounding? World axes.
  Certificate Decide(double needed) const;
};

inline Eigen::Map<const Vector3d> VectorAt(const mjtNum* p) {
  return Eigen::Map<const Vector3d>(p);
}

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_POSED_PAIR_H_
