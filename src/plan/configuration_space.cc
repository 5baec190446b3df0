#include "plan/configuration_space.h"

#include <ompl/base/ProjectionEvaluator.h>
#include <ompl/base/StateSampler.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "equality/held.h"

namespace mjcf_pdg {
namespace {

namespace ob = ompl::base;

// How many entries of q a joint has that are no rotation's, from JointEntry::qadr on.
int EntriesWithBounds(const JointEntry& joint) {
  return joint.type == mjJNT_FREE ? 3 : joint.type == mjJNT_BALL ? 0 : 1;
}

class UniformSampler : public ob::StateSampler {
 public:
  UniformSampler(const ConfigurationSpace* space, std::uint64_t seed)
      : ob::StateSampler(space), configurations_(*space) {
    rng_.setLocalSeed(static_cast<std::uint_fast32_t>(seed));
  }

  void sampleUniform(ob::State* state) override {
    configurations_.Sample(rng_, ConfigurationSpace::Q(state));
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    Towards(state, near, distance * rng_.uniform01());
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    Towards(state, mean, std::abs(rng_.gaussian(0.0, deviation)));
  }

 private:
  // A state at `distance` from `from`, or nearer, on the way to a random one.
  void Towards(ob::State* state, const ob::State* from, double distance) {
    const VectorXd& q = ConfigurationSpace::Q(from);
    configurations_.Sample(rng_, target_);
    const double whole = configurations_.Distance(q, target_) / configurations_.extent();
    const double t = whole > distance ? distance / whole : 1.0;
    configurations_.Interpolate(q, target_, t, ConfigurationSpace::Q(state));
  }

  const ConfigurationSpace& configurations_;
  VectorXd target_;
};

// For planners that keep a grid: how far a configuration is from a fixed one along two random
// directions. OMPL would find the cells' sizes with configurations of its own sampler, which are
// dear where they are brought onto constraints, and would be counted.
class TwoDirections : public ob::ProjectionEvaluator {
 public:
  TwoDirections(const ConfigurationSpace* space, VectorXd origin)
      : ob::ProjectionEvaluator(space), tables_(space->tables()), origin_(std::move(origin)) {
    directions_.resize(2, tables_.n);
    Random random(0);
    for (double& entry : directions_.reshaped()) entry = random.Normal();
    directions_.rowwise().normalize();
  }
  unsigned int getDimension() const override { return 2; }
  void project(const ob::State* state, Eigen::Ref<Eigen::VectorXd> projection) const override {
    VectorXd dq(tables_.n);
    Difference(tables_, origin_, ConfigurationSpace::Q(state), dq);
    projection = directions_ * dq;
  }
  // A twentieth of what all `examples` take, as OMPL has it.
  void FindCellSizes(const std::vector<VectorXd>& examples) {
    MatrixXd seen(2, static_cast<Eigen::Index>(examples.size()));
    VectorXd dq(tables_.n);
    for (Eigen::Index k = 0; k < seen.cols(); ++k) {
      Difference(tables_, origin_, examples[static_cast<std::size_t>(k)], dq);
      seen.col(k) = directions_ * dq;
    }
    const VectorXd wide = seen.rowwise().maxCoeff() - seen.rowwise().minCoeff();
    cellSizes_ = {std::max(wide[0] / 20.0, 1e-9), std::max(wide[1] / 20.0, 1e-9)};
  }

 private:
  const SceneTables& tables_;
  const VectorXd origin_;
  MatrixXd directions_;  // 2 × n
};

// A motion that is not straight is halved at most so often to find its pieces: then a piece would
// be a thousandth of it, and what keeps it from holding is a jump rather than a bend.
constexpr int kMostHalvings = 10;

}  // namespace

ConfigurationSpace::ConfigurationSpace(const Scene& scene, const MocapPoses& mocap,
                                       const VectorXd& start, const VectorXd& goal)
    : scene_(scene),
      tables_(scene.tables()),
      mocap_(mocap),
      base_(start),
      norm_(tables_, Metric::kSequential),
      equalities_(tables_),
      straight_(
          HoldsAlongStraightMotions(*tables_.model, tables_.held_equalities, tables_.held_tendons)),
      dq_(tables_.n) {
  setName("MuJoCo configurations");
  equalities_.SetMocap(mocap_);
  FindBounds(start, goal);
  MeasureExtent();
}

ConfigurationSpace::ConfigurationSpace(const ConfigurationSpace& space, std::uint64_t seed,
                                       double margin_share)
    : scene_(space.scene_),
      tables_(scene_.tables()),
      mocap_(space.mocap_),
      base_(space.base_),
      low_(space.low_),
      high_(space.high_),
      margin_(space.margin_),
      margin_share_(margin_share),
      extent_(space.extent_),
      norm_(tables_, Metric::kSequential),
      equalities_(tables_),
      straight_(space.straight_),
      seed_(seed),
      dq_(tables_.n) {
  setName(space.getName());
  equalities_.SetMocap(mocap_);
  if (margin_share_ != space.margin_share_ && !margin_.isZero()) MeasureExtent();
}

void ConfigurationSpace::FindBounds(const VectorXd& start, const VectorXd& goal) {
  low_ = start.cwiseMin(goal);
  high_ = start.cwiseMax(goal);
  margin_.setZero(low_.size());
  const double margin = 0.5 * tables_.model->stat.extent;
  for (const JointEntry& joint : tables_.joints) {
    const bool turns = joint.type == mjJNT_HINGE;
    for (int k = joint.qadr; k < joint.qadr + EntriesWithBounds(joint); ++k) {
      if (joint.limited) {
        low_[k] = joint.lo;
        high_[k] = joint.hi;
      } else {
        if (!turns) margin_[k] = margin;
        low_[k] -= turns ? std::numbers::pi : margin;
        high_[k] += turns ? std::numbers::pi : margin;
      }
    }
  }
}

void ConfigurationSpace::MeasureExtent() {
  constexpr int kPairs = 200;  // for a scale only; not tuned
  ompl::RNG rng(1);
  VectorXd a, b;
  double largest = 0.0;
  for (int k = 0; k < kPairs; ++k) {
    Sample(rng, a);
    Sample(rng, b);
    largest = std::max(largest, Displacement(a, b));
  }
  if (largest > 0.0) extent_ = largest;
  samples_ = 0;
}

void ConfigurationSpace::MeasureFrom(const VectorXd& q_in) const {
  if (reference_.size() == q_in.size() && reference_ == q_in) return;
  reference_ = q_in;
  norm_.SetReference(q_in, mocap_);
}

double ConfigurationSpace::Displacement(const VectorXd& q_in, const VectorXd& q) const {
  MeasureFrom(q_in);
  return std::sqrt(norm_.Sigma(q));
}

double ConfigurationSpace::Distance(const VectorXd& from, const VectorXd& to) const {
  Difference(tables_, from, to, dq_);
  double half_turns = 1.0;
  for (const JointEntry& joint : tables_.joints) {
    if (joint.type != mjJNT_HINGE) continue;
    half_turns = std::max(half_turns, std::abs(dq_[joint.col]) / std::numbers::pi);
  }
  if (half_turns == 1.0) return Displacement(from, to);
  GoStraight(from, to, 1.0 / half_turns, part_);
  return half_turns * Displacement(from, part_);
}

void ConfigurationSpace::Interpolate(const VectorXd& from, const VectorXd& to, double t,
                                     VectorXd& out) const {
  if (t >= 1.0) {
    out = to;
    return;
  }
  GoStraight(from, to, t, out);
  if (!straight_) Project(out);
}

// out := from ⊕ t·(to ⊖ from).
void ConfigurationSpace::GoStraight(const VectorXd& from, const VectorXd& to, double t,
                                    VectorXd& out) const {
  Difference(tables_, from, to, dq_);
  dq_ *= t;
  out = from;
  Integrate(tables_, out, dq_, out);
}

// Along the straight motion: in its middle, and beside it for motions that are odd about it.
bool ConfigurationSpace::HoldsBetween(const VectorXd& from, const VectorXd& to,
                                      double tolerance) const {
  VectorXd q;
  for (const double t : {0.5, 0.25, 0.75}) {
    GoStraight(from, to, t, q);
    if (equalities_.Violation(q) > tolerance) return false;
  }
  return true;
}

bool ConfigurationSpace::Follow(const VectorXd& from, const VectorXd& to,
                                const std::function<bool(const Piece&)>& next) const {
  if (straight_) return next({to, 1.0});
  const double at_ends = std::max(equalities_.Violation(from), equalities_.Violation(to));
  if (at_ends > kEqualityTolerance) return false;
  // Half of it, as three places are asked only; more where the ends are as far off themselves.
  const double tolerance = std::max(0.5 * kEqualityTolerance, at_ends);
  struct Part {
    Piece end;
    int halvings;
  };
  std::vector<Part> ahead = {{{to, 1.0}, 0}};  // the next is the last
  Piece at = {from, 0.0};
  while (!ahead.empty()) {
    const Part& part = ahead.back();
    if (HoldsBetween(at.q, part.end.q, tolerance)) {
      at = part.end;
      ahead.pop_back();
      if (!next(at)) return false;
      continue;
    }
    Part middle = {{{}, 0.5 * (at.t + part.end.t)}, part.halvings + 1};
    GoStraight(from, to, middle.end.t, middle.end.q);
    if (middle.halvings > kMostHalvings || !Project(middle.end.q)) return false;
    ahead.push_back(std::move(middle));
  }
  return true;
}

bool ConfigurationSpace::HoldsEqualities(const VectorXd& q) const {
  return !equalities_.any() || equalities_.Violation(q) <= kEqualityTolerance;
}

bool ConfigurationSpace::Project(VectorXd& q) const {
  return !equalities_.any() || equalities_.Project(q);
}

void ConfigurationSpace::Sample(ompl::RNG& rng, VectorXd& q) const {
  constexpr int kDraws = 10;  // few are needed: limits rarely keep a sample off the constraints
  ++samples_;
  for (int k = 0; k < kDraws; ++k) {
    Draw(rng, q);
    if (Project(q)) return;
  }
  q = base_;
}

std::uint64_t ConfigurationSpace::NextSeed() const { return Random(seed_++).Bits(); }

bool ConfigurationSpace::Covers(const VectorXd& q) const {
  for (const JointEntry& joint : tables_.joints) {
    for (int k = joint.qadr; k < joint.qadr + EntriesWithBounds(joint); ++k) {
      if (q[k] < low_[k] - kLimitTolerance || q[k] > high_[k] + kLimitTolerance) return false;
    }
  }
  return true;
}

void ConfigurationSpace::Draw(ompl::RNG& rng, VectorXd& q) const {
  q = base_;
  for (const JointEntry& joint : tables_.joints) {
    for (int k = joint.qadr; k < joint.qadr + EntriesWithBounds(joint); ++k) {
      const double inwards = (1.0 - margin_share_) * margin_[k];
      const double low = low_[k] + inwards, high = high_[k] - inwards;
      q[k] = low < high ? rng.uniformReal(low, high) : low;
    }
    if (joint.type != mjJNT_FREE && joint.type != mjJNT_BALL) continue;
    double quat[4];
    rng.quaternion(quat);
    if (joint.type == mjJNT_BALL && joint.limited && BallAngle(quat) > joint.hi) {
      // A rotation vector that is uniform in the ball of that radius.
      const Vector3d axis = Vector3d(quat[1], quat[2], quat[3]).normalized();
      const double half = 0.5 * joint.hi * std::cbrt(rng.uniform01());
      quat[0] = std::cos(half);
      Eigen::Map<Vector3d>(quat + 1) = std::sin(half) * axis;
    }
    for (int k = 0; k < 4; ++k) q[QuatAddress(joint) + k] = quat[k];
  }
}

unsigned int ConfigurationSpace::getDimension() const {
  return static_cast<unsigned int>(tables_.n);
}

void ConfigurationSpace::enforceBounds(ob::State* state) const {
  ClampToLimits(tables_, Q(state));
  Project(Q(state));
}

bool ConfigurationSpace::satisfiesBounds(const ob::State* state) const {
  return LimitExcess(tables_, Q(state)) <= kLimitTolerance;
}

void ConfigurationSpace::copyState(ob::State* to, const ob::State* from) const { Q(to) = Q(from); }

double ConfigurationSpace::distance(const ob::State* a, const ob::State* b) const {
  return Distance(Q(b), Q(a)) / extent_;
}

bool ConfigurationSpace::equalStates(const ob::State* a, const ob::State* b) const {
  return Q(a) == Q(b);
}

void ConfigurationSpace::interpolate(const ob::State* from, const ob::State* to, double t,
                                     ob::State* state) const {
  if (t >= 1.0) {
    Q(state) = Q(to);
  } else {
    Interpolate(Q(from), Q(to), t, Q(state));
  }
}

ob::StateSamplerPtr ConfigurationSpace::allocDefaultStateSampler() const {
  return std::make_shared<UniformSampler>(this, NextSeed());
}

ob::State* ConfigurationSpace::allocState() const {
  auto* state = new StateType;
  state->q = base_;
  return state;
}

void ConfigurationSpace::freeState(ob::State* state) const {
  delete static_cast<StateType*>(state);
}

void ConfigurationSpace::registerProjections() {
  const auto projection = std::make_shared<TwoDirections>(this, base_);
  ompl::RNG rng(1);
  std::vector<VectorXd> examples(100);
  for (VectorXd& q : examples) Draw(rng, q);
  projection->FindCellSizes(examples);
  registerDefaultProjection(projection);
}

std::vector<VectorXd> Configurations(const ompl::geometric::PathGeometric& path) {
  std::vector<VectorXd> q;
  for (std::size_t k = 0; k < path.getStateCount(); ++k) {
    q.push_back(ConfigurationSpace::Q(path.getState(static_cast<unsigned int>(k))));
  }
  return q;
}

}  // namespace mjcf_pdg
