// The signed distance of points from a geom at a pose: of an SDF geom its own function, through
// MuJoCo, of all others the exact one; meshes count as their convex hulls.
#ifndef MJCF_PDG_SRC_COLLIDE_SDF_POSED_FIELD_H_
#define MJCF_PDG_SRC_COLLIDE_SDF_POSED_FIELD_H_

#include <mujoco/mujoco.h>

#include "model/kinematics.h"

namespace mjcf_pdg {

// Refers to the posed model, which must outlive it and keep its pose. Not for height fields.
class PosedField {
 public:
  PosedField(const PosedModel& posed, int geom);

  // Negative inside [m]. The function of an SDF geom (a plugin's, or the interpolated one of a
  // mesh) may be inexact: its slope may differ from 1.
  double At(const Vector3d& x_W) const;
  // The unit vector along which it grows fastest at x; the world's z axis where it does not grow.
  Vector3d Normal(const Vector3d& x_W) const;

 private:
  double AtLocal(const Vector3d& x) const;
  Vector3d NormalAtLocal(const Vector3d& x) const;
  Vector3d SdfGradient(const Vector3d& x) const;
  int FarthestFace(const Vector3d& x, double& distance) const;

  const mjModel& m_;
  const mjData& d_;
  const int geom_, type_;
  // The frame of the function: that of the geom, or, of a plugin, that which its mesh was made in.
  Vector3d origin_W_;
  Matrix3d R_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_SDF_POSED_FIELD_H_
