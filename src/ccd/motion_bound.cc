#include "ccd/motion_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The part of v perpendicular to a unit vector.
Vector3d Across(const Vector3d& v, const Vector3d& unit) { return v - unit.dot(v) * unit; }

}  // namespace

MotionBound::MotionBound(const SceneTables& tables)
    : tables_(tables), bodies_(tables.model->nbody), geoms_(tables.model->ngeom) {
  const mjModel& m = *tables.model;
  motions_of_body_.resize(m.nbody);
  for (int body = 0; body < m.nbody; ++body) {
    motions_of_body_[body].begin = static_cast<int>(motions_.size());
    for (int j = 0; j < static_cast<int>(tables.joints.size()); ++j) {
      if (tables.joints[j].body != body) continue;
      Motion motion;
      motion.joint = j;
      // A free joint first translates, then turns about the body's origin.
      if (tables.joints[j].type == mjJNT_FREE) motions_.push_back(motion);
      motion.rotates = tables.joints[j].type != mjJNT_SLIDE;
      motions_.push_back(motion);
    }
    motions_of_body_[body].end = static_cast<int>(motions_.size());
  }
  chain_.reserve(tables.body_pairs.size());
  std::vector<int> descent;
  for (const BodyPair& bodies : tables.body_pairs) {
    Range range{static_cast<int>(chains_.size()), 0};
    int up = bodies.body1, down = bodies.body2;
    descent.clear();
    while (up != down) {  // parents have smaller ids
      if (up > down) {
        AppendMotions(up, 1.0, true);
        up = m.body_parentid[up];
      } else {
        descent.push_back(down);
        down = m.body_parentid[down];
      }
    }
    for (auto body = descent.rbegin(); body != descent.rend(); ++body) {
      AppendMotions(*body, -1.0, false);
    }
    range.end = static_cast<int>(chains_.size());
    chain_.push_back(range);
  }
  active_.resize(chain_.size());
  twists_.resize(chain_.size());
  path_.resize(tables.n);
  std::size_t longest = 0;
  for (const Range& range : chain_) {
    longest = std::max(longest, static_cast<std::size_t>(range.end - range.begin));
  }
  active_chains_.reserve(chains_.size());
  for (auto* scratch : {&travels1_, &travels2_}) scratch->resize(longest);
}

void MotionBound::AppendMotions(int body, double sign, bool upwards) {
  const Range range = motions_of_body_[body];
  for (int k = range.begin; k < range.end; ++k) {
    chains_.push_back({upwards ? range.end - 1 - (k - range.begin) : k, sign});
  }
}

void MotionBound::SetPath(const VectorXd& dq) {
  for (Motion& motion : motions_) {
    const JointEntry& joint = tables_.joints[motion.joint];
    if (joint.ndof == 1) {
      motion.speed = std::abs(dq[joint.col]);
      motion.rate_W = Vector3d(dq[joint.col], 0.0, 0.0);
    } else {
      const int offset = joint.type == mjJNT_FREE && motion.rotates ? 3 : 0;
      motion.rate_W = dq.segment<3>(joint.col + offset);
      motion.speed = motion.rate_W.norm();
    }
  }
  active_chains_.clear();
  for (std::size_t p = 0; p < chain_.size(); ++p) {
    active_[p].begin = static_cast<int>(active_chains_.size());
    for (int k = chain_[p].begin; k < chain_[p].end; ++k) {
      if (motions_[chains_[k].motion].speed > 0.0) active_chains_.push_back(chains_[k]);
    }
    active_[p].end = static_cast<int>(active_chains_.size());
  }
  int turning = 0;
  for (Motion& motion : motions_) {
    if (motion.rotates && motion.speed > 0.0) motion.turning = turning++;
  }
  bodies_.SetTurning(turning);
  geoms_.SetTurning(turning);
  path_ = dq;
  any_axis_ = false;
  ++pose_;
}

void MotionBound::SetReach(const VectorXd& reach) {
  SetPath(reach);
  any_axis_ = true;
}

void MotionBound::Shapes::SetTurning(int motions) {
  const std::size_t row = static_cast<std::size_t>(motions);
  if (far_.size() < shapes_.size() * row) far_.resize(shapes_.size() * row);
  for (std::size_t k = 0; k < shapes_.size(); ++k) shapes_[k].far = far_.data() + k * row;
}

void MotionBound::SetPose(const PosedModel& posed) {
  const mjData& d = *posed.data();
  ++pose_;
  for (Motion& motion : motions_) {
    if (motion.speed <= 0.0) continue;
    const JointEntry& joint = tables_.joints[motion.joint];
    motion.anchor_W =
        AsVector(joint.type == mjJNT_FREE ? d.xpos + 3 * joint.body : d.xanchor + 3 * joint.id);
    if (joint.ndof == 1) {
      motion.rate_W = path_[joint.col] * AsVector(d.xaxis + 3 * joint.id);
    } else if (motion.rotates) {  // given in the body's frame; no rotation follows a ball
      motion.rate_W = AsMatrix(d.xmat + 9 * joint.body) * path_.segment<3>(RotationColumn(joint));
    }
  }
}

double MotionBound::Extent::FarFrom(const Vector3d& p_W) const {
  const double by_sphere = (center_W - p_W).norm() + radius;
  if (!has_box) return by_sphere;
  const Vector3d corner = (R.transpose() * (box_center_W - p_W)).cwiseAbs() + half;
  return std::min(by_sphere, corner.norm());
}

double MotionBound::Extent::FarFromAxis(const Vector3d& p_W, const Vector3d& unit_W) const {
  const double by_sphere = Across(center_W - p_W, unit_W).norm() + radius;
  if (!has_box) return by_sphere;
  double across = 0.0;
  for (int i = 0; i < 3; ++i) across += half[i] * Across(R.col(i), unit_W).norm();
  return std::min(by_sphere,
                  Across(box_center_W - p_W, unit_W).norm() + std::min(across, half.norm()));
}

MotionBound::Shape& MotionBound::Body(const PosedModel& posed, int body) {
  Shape& shape = bodies_[body];
  if (shape.pose == pose_) return shape;
  shape.pose = pose_;
  const mjData& d = *posed.data();
  const BoundingSphere& sphere = tables_.body_spheres[body];
  shape.extent.center_W =
      AsVector(d.xpos + 3 * body) + AsMatrix(d.xmat + 9 * body) * sphere.center_B;
  shape.extent.radius = sphere.radius;
  return shape;
}

MotionBound::Shape& MotionBound::Geom(const PosedModel& posed, int geom) {
  Shape& shape = geoms_[geom];
  if (shape.pose == pose_) return shape;
  shape.pose = pose_;
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  Extent& extent = shape.extent;
  extent.center_W = AsVector(d.geom_xpos + 3 * geom);
  extent.radius = kInfinity;
  if (m.geom_type[geom] == mjGEOM_PLANE) return shape;
  const double core = CoreRadius(m, geom);
  if (m.geom_rbound[geom] > 0.0) extent.radius = m.geom_rbound[geom] - core;
  extent.half = AsVector(m.geom_aabb + 6 * geom + 3);
  extent.has_box = extent.half.maxCoeff() > 0.0;
  extent.half = (extent.half.array() - core).cwiseMax(0.0);
  if (extent.has_box) {
    extent.R = AsMatrix(d.geom_xmat + 9 * geom);
    extent.box_center_W = extent.center_W + extent.R * AsVector(m.geom_aabb + 6 * geom);
  }
  return shape;
}

void MotionBound::FillMomentArms(Range range, bool from_first, Shape& shape, double horizon,
                                 std::vector<double>& travels) const {
  const int count = range.end - range.begin;
  double travel = 0.0;   // of the shape by the motions already walked past
  double stretch = 0.0;  // of the chain since the last anchor, by slides
  const Motion* previous = nullptr;
  double previous_arm = 0.0;
  for (int step = 0; step < count; ++step) {
    const int k = from_first ? step : count - 1 - step;
    const Motion& motion = motions_[active_chains_[range.begin + k].motion];
    if (!motion.rotates) {
      travels[k] = motion.speed;
      stretch += motion.speed * horizon;
    } else {
      Far& far = shape.far[motion.turning];
      if (far.pose != pose_) {
        const double anchor = shape.extent.FarFrom(motion.anchor_W);
        const bool any_axis = any_axis_ && tables_.joints[motion.joint].ndof > 1;
        far = {pose_, anchor,
               any_axis ? anchor
                        : shape.extent.FarFromAxis(motion.anchor_W, motion.rate_W / motion.speed)};
      }
      double arm = far.anchor + horizon * travel;
      if (previous) {
        const double chain = (motion.anchor_W - previous->anchor_W).norm() + stretch;
        arm = std::min(arm, chain + previous_arm);
      }
      travels[k] = motion.speed * std::min(arm, far.axis + horizon * travel);
      previous = &motion;
      previous_arm = arm;
      stretch = 0.0;
    }
    travel += travels[k];
  }
}

double MotionBound::LeastTravels(Range range) const {
  double closing = 0.0;
  for (int k = 0; k < range.end - range.begin; ++k) {
    closing += std::min(travels1_[k], travels2_[k]);
  }
  return closing;
}

// The velocity of a point is a sum over the chain, x' = Σ_k c_k with c_k = ω_k × (x - o_k), or the
// rate of a slide. With Ω_k the turning rate of the frame that carries motion k, as seen from the
// resting shape, the sum of all ω_j before it,
//   c_k' = Ω_k × c_k + ω_k × Σ_{j >= k} c_j,
//   x'' = Σ_k ω_k × e_k, where e_k = c_k + 2 Σ_{j > k} c_j,
//   x''' = Σ_k (Ω_k × ω_k) × e_k + ω_k × e_k'.
// Of these the norms are summed, beginning at the shape that moves.
double MotionBound::Jerk(Range range, bool of_first, const std::vector<double>& travels) const {
  const int count = range.end - range.begin;
  double before = 0.0;  // |Ω_k|
  for (int k = 0; k < count; ++k) {
    if (std::isinf(travels[k])) return kInfinity;
    before += TurningSpeed(range.begin + k);
  }
  double jerk = 0.0, beyond = 0.0, change_beyond = 0.0;  // Σ |c_j| and Σ |c_j'| of all j > k
  for (int step = 0; step < count; ++step) {
    const int k = of_first ? step : count - 1 - step;
    const double speed = TurningSpeed(range.begin + k);
    before = std::max(0.0, before - speed);
    const double e = travels[k] + 2.0 * beyond;
    beyond += travels[k];
    const double change = before * travels[k] + speed * beyond;
    jerk += speed * (before * e + change + 2.0 * change_beyond);
    change_beyond += change;
  }
  return jerk;
}

// Of body 1 at the pose, body 2 at rest: motions nearer to that carry the axes and anchors of the
// others.
const Twist& MotionBound::TwistOfBodies(int body_pair) {
  TwistAtPose& known = twists_[body_pair];
  if (known.pose == pose_) return known.twist;
  known = {pose_, {}};
  Twist& twist = known.twist;
  const Range range = active_[body_pair];
  for (int k = range.end - 1; k >= range.begin; --k) {
    const Motion& motion = motions_[active_chains_[k].motion];
    const Vector3d rate_W = active_chains_[k].sign * motion.rate_W;
    const Vector3d change_W = twist.omega_W.cross(rate_W);
    if (motion.rotates) {
      const Vector3d anchor_rate_W = twist.v_W + twist.omega_W.cross(motion.anchor_W);
      twist.omega_rate_W += change_W;
      twist.v_rate_W -= change_W.cross(motion.anchor_W) + rate_W.cross(anchor_rate_W);
      twist.omega_W += rate_W;
      twist.v_W -= rate_W.cross(motion.anchor_W);
    } else {
      twist.v_rate_W += change_W;
      twist.v_W += rate_W;
    }
  }
  return twist;
}

double MotionBound::TurningSpeed(int active) const {
  const Motion& motion = motions_[active_chains_[active].motion];
  return motion.rotates ? motion.speed : 0.0;
}

double MotionBound::BodiesClosing(const PosedModel& posed, int body_pair, double horizon,
                                  double& distance) {
  const BodyPair& bodies = tables_.body_pairs[body_pair];
  const Range range = active_[body_pair];
  last_ = {};
  Shape &first = Body(posed, bodies.body1), &second = Body(posed, bodies.body2);
  distance = (first.extent.center_W - second.extent.center_W).norm() - first.extent.radius -
             second.extent.radius;
  FillMomentArms(range, true, first, horizon, travels1_);
  FillMomentArms(range, false, second, horizon, travels2_);
  return LeastTravels(range);
}

void MotionBound::SharesOfLast(int body_pair, VectorXd& shares) const {
  const Range range = active_[body_pair];
  shares.setZero();
  for (int k = 0; k < range.end - range.begin; ++k) {
    const Motion& motion = motions_[active_chains_[range.begin + k].motion];
    const JointEntry& joint = tables_.joints[motion.joint];
    const double share = std::min(travels1_[k], travels2_[k]);
    if (joint.ndof == 1) {
      shares[joint.col] += share;
    } else {
      const int first = motion.rotates ? RotationColumn(joint) : joint.col;
      shares.segment<3>(first) += share / motion.speed * path_.segment<3>(first).cwiseAbs();
    }
  }
}

bool MotionBound::Swapped(int body_pair, int pair) const {
  const int body1 = tables_.model->geom_bodyid[tables_.pairs[pair].geom1];
  return body1 != tables_.body_pairs[body_pair].body1;
}

double MotionBound::Closing(const PosedModel& posed, int body_pair, int pair, double horizon) {
  const Range range = active_[body_pair];
  const Question question{pose_, pair, horizon};
  if (question != last_) {
    last_ = question;
    int geom1 = tables_.pairs[pair].geom1, geom2 = tables_.pairs[pair].geom2;
    if (Swapped(body_pair, pair)) std::swap(geom1, geom2);
    FillMomentArms(range, true, Geom(posed, geom1), horizon, travels1_);
    FillMomentArms(range, false, Geom(posed, geom2), horizon, travels2_);
  }
  return LeastTravels(range);
}

Twist MotionBound::TwistOf(int body_pair, int pair) {
  const Twist& twist = TwistOfBodies(body_pair);
  return Swapped(body_pair, pair) ? -twist : twist;
}

RelativeMotion MotionBound::Geoms(const PosedModel& posed, int body_pair, int pair,
                                  double horizon) {
  const Range range = active_[body_pair];
  RelativeMotion motion;
  motion.closing = Closing(posed, body_pair, pair, horizon);
  motion.twist = TwistOf(body_pair, pair);
  motion.jerk1 = Jerk(range, true, travels1_);
  motion.jerk2 = Jerk(range, false, travels2_);
  if (Swapped(body_pair, pair)) std::swap(motion.jerk1, motion.jerk2);
  return motion;
}

}  // namespace mjcf_pdg
