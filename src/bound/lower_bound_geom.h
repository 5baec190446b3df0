// Convex geoms as the lower bound sees them: a farthest point along a direction, extreme points.
//
// Part of lower_bound.h.
#ifndef MJCF_PDG_SRC_BOUND_LOWER_BOUND_GEOM_H_
#define MJCF_PDG_SRC_BOUND_LOWER_BOUND_GEOM_H_

#include <mujoco/mujoco.h>

#include <array>
#include <span>

#include "collide/convex/support_points.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// At q_in, in world axes.
struct ConvexGeom {
  const SupportPoints* support = nullptr;  // null: the hull of its points
  int geom = 0;
  double core_radius = 0.0;  // by which it exceeds its support points [m]
  Vector3d center;
  Matrix3d R;
  // The geom is the hull of its points, grown by the radius; a round geom is inside that.
  double radius = 0.0;
  bool round = false;  // a cylinder or ellipsoid, whose points are not its own

  // The hull of up to eight points.
  void Fill(std::span<const Vector3d> corners_W);
  // Any geom with a signed distance; of a plane, nothing but center and R is of use.
  void Fill(const PosedModel& posed, const SupportPoints& support_points, int geom_id);

  int num_points() const { return num_points_; }
  Vector3d Point(int k) const {
    return center + R * (hull_.empty() ? points_G_[k] : hull_[k].cast<double>());
  }
  // The geom's farthest point along n.
  Vector3d Support(const Vector3d& n) const;

 private:
  static constexpr int kSides = 12;  // of a prism about a cylinder

  void AddCorners(const Vector3d& half);
  void AddPrism(double inner, double half);  // about a cylinder of these radius and half length
  void AddPoint(double x, double y, double z) { points_G_[num_points_++] = Vector3d(x, y, z); }

  // In the geom's frame: a mesh's are those of the hull, the others' a few of our own.
  std::span<const Eigen::Vector3f> hull_;
  std::array<Vector3d, 2 * kSides> points_G_;
  int num_points_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LOWER_BOUND_GEOM_H_
