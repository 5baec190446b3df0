// How fast two geoms can approach each other along a configuration line q(s) = q0 ⊕ s·dq.
//
// Hinges and slides change linearly in s, balls and free joints turn at a constant rate about a
// fixed axis; only the joints between the two geoms count. With a signed distance d(s) and witness
// points p1, p2 of normal n, d' = Σ_j ± n·(ω_j × (p - o_j)) over those joints. Since p2 - p1 = d n,
// p may be taken on either geom, joint by joint: each moment arm is the shorter of the two.
//
// Spheres and capsules count as their cores, a point and a segment: the distance of the round
// shapes is that of the cores less their radii, however they turn.
//
// Every moment arm holds on a whole interval [s, s + horizon] and starts from the pose at s: a
// point's distance from a joint's axis grows at most by the travel that the joints in between give
// it, and never beyond the stretched chain of anchors. The same holds on [s - horizon, s]: run
// backwards, the motion has the same speeds. Units: s has none, lengths in m, angles in rad.
#ifndef MJCF_PDG_SRC_CCD_MOTION_BOUND_H_
#define MJCF_PDG_SRC_CCD_MOTION_BOUND_H_

#include <cstdint>
#include <vector>

#include "collide/convex/support_points.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// The point x_W of a rigid body moves with x' = v_W + omega_W × x_W. Since these change as the
// other two say, x'' = v_rate_W + omega_rate_W × x_W + omega_W × x'. Per unit of s and of s².
struct Twist {
  Vector3d omega_W = Vector3d::Zero(), v_W = Vector3d::Zero();
  Vector3d omega_rate_W = Vector3d::Zero(), v_rate_W = Vector3d::Zero();

  // Of the second body as seen from the first, if this is of the first as seen from the second.
  Twist operator-() const { return {-omega_W, -v_W, -omega_rate_W, -v_rate_W}; }
  // Of the motion run backwards.
  Twist Backwards() const { return {-omega_W, -v_W, omega_rate_W, v_rate_W}; }
};

// Two geoms of a pair, on [s, s + horizon].
struct RelativeMotion {
  double closing = 0.0;  // |d'| <= closing: the λ of conservative advancement [m]
  Twist twist;           // of geom 1 at s, geom 2 at rest
  // |x'''| of any point of geom 1 (geom 2 at rest) and of geom 2 (geom 1 at rest) [m], of their
  // cores if round; infinite for planes.
  double jerk1 = 0.0, jerk2 = 0.0;
};

// One per thread.
class MotionBound {
 public:
  explicit MotionBound(const SceneTables& tables);

  // The line's tangent, n entries per unit of s.
  void SetPath(const VectorXd& dq);
  // Bounds for all lines at once whose entries of dq are at most those of `reach`, which are not
  // negative: what is said of s in [0, 1] then holds for every configuration that they end at.
  void SetReach(const VectorXd& reach);
  // Joint axes of the pose at s; call after each new pose.
  void SetPose(const PosedModel& posed);

  // Some joint between the two bodies of tables.body_pairs[k] moves along the line.
  bool Moves(int body_pair) const { return active_[body_pair].begin < active_[body_pair].end; }

  // An upper bound of λ for all geoms of the two bodies, from the bodies' spheres, and the distance
  // of the spheres (-inf with a plane).
  double BodiesClosing(const PosedModel& posed, int body_pair, double horizon, double& distance);
  // The same for the geoms of one of their pairs: `closing` of Geoms, for a part of its price.
  double Closing(const PosedModel& posed, int body_pair, int pair, double horizon);
  // Of the pair's geom 1 at s, geom 2 at rest.
  Twist TwistOf(int body_pair, int pair);
  RelativeMotion Geoms(const PosedModel& posed, int body_pair, int pair, double horizon);
  // After Closing of that body pair: the part that each entry of dq has in it [m] (n).
  void SharesOfLast(int body_pair, VectorXd& shares) const;

 private:
  // A hinge, slide or ball; the translation or the rotation of a free joint.
  struct Motion {
    int joint = 0;  // index into SceneTables::joints
    bool rotates = false;
    double speed = 0.0;         // rad or m per unit s
    int turning = 0;            // its number among those that turn, if it does
    Vector3d anchor_W, rate_W;  // at the pose; rate_W of length `speed`
  };
  struct TwistAtPose {
    std::int64_t pose = 0;  // that it is of
    Twist twist;
  };
  // What Closing was asked last.
  struct Question {
    std::int64_t pose = 0;
    int pair = -1;
    double horizon = 0.0;

    bool operator==(const Question&) const = default;
  };
  // A motion between two bodies; sign -1 when it carries body 2.
  struct Link {
    int motion = 0;
    double sign = 1.0;
  };
  struct Range {
    int begin = 0, end = 0;
  };
  // Where a shape can be, at the pose.
  struct Extent {
    Vector3d center_W;
    double radius;
    bool has_box = false;
    Vector3d box_center_W, half;
    Matrix3d R;

    double FarFrom(const Vector3d& p_W) const;
    double FarFromAxis(const Vector3d& p_W, const Vector3d& unit_W) const;
  };
  // The same shape is in many pairs, so what is asked of it is kept for the pose.
  struct Far {
    std::int64_t pose = 0;            // that it is of
    double anchor = 0.0, axis = 0.0;  // farthest point from the two of a motion that turns [m]
  };
  struct Shape {
    std::int64_t pose = 0;
    Extent extent;
    Far* far = nullptr;  // by Motion::turning
  };
  class Shapes {
   public:
    explicit Shapes(int count) : shapes_(static_cast<std::size_t>(count)) {}
    void SetTurning(int motions);
    Shape& operator[](int shape) { return shapes_[static_cast<std::size_t>(shape)]; }

   private:
    std::vector<Shape> shapes_;
    std::vector<Far> far_;
  };

  void AppendMotions(int body, double sign, bool upwards);
  Shape& Body(const PosedModel& posed, int body);
  Shape& Geom(const PosedModel& posed, int geom);
  // Travels of the links in `range`, walked away from the shape.
  void FillMomentArms(Range range, bool from_first, Shape& shape, double horizon,
                      std::vector<double>& travels) const;
  double LeastTravels(Range range) const;
  bool Swapped(int body_pair, int pair) const;
  double TurningSpeed(int active) const;
  double Jerk(Range range, bool of_first, const std::vector<double>& travels) const;
  const Twist& TwistOfBodies(int body_pair);

  const SceneTables& tables_;
  VectorXd path_;          // n
  bool any_axis_ = false;  // balls and free joints may turn about any axis (SetReach)
  std::vector<Motion> motions_;
  std::vector<Range> motions_of_body_;        // nbody
  std::vector<Link> chains_, active_chains_;  // body 1 up to the common ancestor, down to body 2
  std::vector<Range> chain_, active_;         // per body pair, into the two above
  std::vector<TwistAtPose> twists_;           // per body pair
  Shapes bodies_, geoms_;
  std::int64_t pose_ = 0;                    // counts SetPath and SetPose
  std::vector<double> travels1_, travels2_;  // fastest point by this motion alone [m per unit s]
  Question last_;                            // that the two above are of; pair -1: of bodies
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_CCD_MOTION_BOUND_H_
