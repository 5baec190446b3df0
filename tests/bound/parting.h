// Two geoms on chains of made-up movers, and motions that part them: what a bound of S is held
// against. Shares with the bound only its input.
#ifndef MJCF_PDG_TESTS_BOUND_PARTING_H_
#define MJCF_PDG_TESTS_BOUND_PARTING_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "bound/lower_bound_pair.h"
#include "tests/bound/posed_geoms.h"

namespace mjcf_pdg::test {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kSlack = 1.0 + 1e-6;  // for the rounding of distances

inline const std::vector<int> kSolids = {mjGEOM_SPHERE,   mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                                         mjGEOM_CYLINDER, mjGEOM_BOX,     mjGEOM_MESH};

inline double Median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

enum class Moves { kSlide, kHinge, kBall, kFree };

// A mover with slide = `slides` z and w = `turns` z for a part z of a motion whose share of S is
// |z|². w is the axis times twice the sine of half the angle.
struct Limb {
  Mover mover;
  Eigen::Matrix3Xd slides, turns;
  int first = 0;  // of its entries of z

  int size() const { return static_cast<int>(slides.cols()); }
};

inline Limb RandomLimb(Moves moves, double scale, Random& rng) {
  Limb limb;
  Mover& mover = limb.mover;
  const double mass = std::pow(10.0, rng.Uniform(-1.0, 1.0));
  const int slides = moves == Moves::kSlide ? 1 : moves == Moves::kFree ? 3 : 0;
  const int turns = moves == Moves::kSlide ? 0 : moves == Moves::kHinge ? 1 : 3;
  limb.slides = limb.turns = Eigen::Matrix3Xd::Zero(3, slides + turns);
  mover.anchor = scale * rng.InBox(0.5);
  const Vector3d axis = rng.UnitVector();
  if (slides == 1) mover.axis = axis;
  if (slides == 1) limb.slides.col(0) = axis / std::sqrt(mass);
  if (slides == 3) limb.slides.leftCols(3) = Matrix3d::Identity() / std::sqrt(mass);
  if (turns == 1) {
    mover.hinge = true;
    mover.axis = axis;
    limb.turns.col(0) = axis / (std::sqrt(mass) * scale * rng.Uniform(0.1, 0.5));
  }
  if (turns == 3) {
    const Vector3d radii = scale * (Vector3d::Constant(0.3) + rng.InBox(0.2));
    limb.turns.rightCols(3) = rng.UnitQuat().toRotationMatrix() *
                              (std::sqrt(mass) * radii).cwiseInverse().asDiagonal() *
                              rng.UnitQuat().toRotationMatrix();
  }
  mover.T = limb.slides * limb.slides.transpose();
  mover.C = limb.turns * limb.turns.transpose();
  mover.slide = limb.slides.jacobiSvd().singularValues()[0];
  mover.turn = limb.turns.jacobiSvd().singularValues()[0];
  return limb;
}

class Parting {
 public:
  // Chains of up to three movers each, of the first chain none if `only_second`.
  Parting(int type1, int type2, const std::vector<Moves>& kinds, bool only_second, double log_scale,
          Random& rng)
      : scale(std::pow(10.0, log_scale)), geoms(type1, type2, 0.15, scale, rng) {
    for (const int chain : {0, 1}) {
      pair.first[chain] = static_cast<int>(pool.size());
      int count = only_second && chain == 0 ? 0 : rng.Index(4);
      if (chain == 1 && pool.empty()) count = std::max(count, 1);
      for (int k = 0; k < count; ++k) {
        limbs_.push_back(RandomLimb(kinds[rng.Index(static_cast<int>(kinds.size()))], scale, rng));
        limbs_.back().first = size_;
        size_ += limbs_.back().size();
        pool.push_back(limbs_.back().mover);
      }
      pair.geom[chain] = geoms.Filled(chain);
    }
    pair.first[2] = static_cast<int>(pool.size());
    pair.pool = &pool;
    const BruteGap gap = BruteDistance(geoms.model.get(), geoms.posed->data(), 0, 1);
    n_W = gap.n_W;
    pair.required = scale * rng.Uniform(-0.02, 0.05);
    pair.needed = pair.required - gap.distance;
    pair.plane = type1 == mjGEOM_PLANE;
    pair.n_W = pair.plane ? Vector3d(pair.geom[0].R.col(2)) : n_W;
  }
  Parting(const Parting&) = delete;

  bool overlaps() const { return pair.needed > 1e-3 * scale; }

  // By how much more than required a slab across n parts the geoms after the motion z [m].
  double Excess(const Vector3d& n, const VectorXd& z) const {
    double gap = -pair.required;
    for (const int chain : {0, 1}) {
      const Eigen::Isometry3d moved = Carried(chain, z);
      const Vector3d way = chain == 0 ? n : Vector3d(-n);
      gap -= way.dot(moved.translation()) + geoms.Reach(chain, moved.linear().transpose() * way);
    }
    return gap;
  }

  // How the motion z carries geom 1 (chain 0) or geom 2.
  Eigen::Isometry3d Carried(int chain, const VectorXd& z) const {
    Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
    for (int k = pair.first[chain]; k < pair.first[chain + 1]; ++k) moved = moved * Of(k, z);
    return moved;
  }
  const std::vector<Limb>& limbs() const { return limbs_; }
  int size() const { return size_; }  // of a motion z

  // √S of a cheap motion after which such a slab parts the geoms; infinite if none is found.
  double CheapRoot(const Vector3d& n, Random& rng, int tries = 40) const {
    VectorXd best = Gradient(n);
    if (!(best.norm() > 0.0)) best = rng.Normals(size_);
    double root = FirstParted(n, best);
    double step = 0.5;
    for (int k = 0; k < tries; ++k) {
      const VectorXd tried = best.normalized() + step * rng.Normals(size_) / std::sqrt(size_);
      const double at = FirstParted(n, tried);
      step *= at < root ? 1.3 : 0.85;
      if (!(at < root)) continue;
      root = at;
      best = tried;
    }
    return root;
  }

  const double scale;
  PosedGeoms geoms;
  MoverPool pool;
  PairProblem pair;
  Vector3d n_W;  // the normal of the overlap at q_in

 private:
  Vector3d Turn(const Limb& limb, const VectorXd& z) const {
    return limb.turns * z.segment(limb.first, limb.size());
  }
  // How the mover carries what lies outboard of it.
  Eigen::Isometry3d Of(int k, const VectorXd& z) const {
    const Limb& limb = limbs_[k];
    const Vector3d w = Turn(limb, z);
    const double angle = 2.0 * std::asin(std::min(1.0, 0.5 * w.norm()));
    Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
    if (angle > 0.0) moved.linear() = Eigen::AngleAxisd(angle, w.normalized()).toRotationMatrix();
    moved.translation() = limb.mover.anchor - moved.linear() * limb.mover.anchor +
                          limb.slides * z.segment(limb.first, limb.size());
    return moved;
  }
  VectorXd Gradient(const Vector3d& n) const {
    VectorXd gradient(size_);
    for (int i = 0; i < size_; ++i) {
      const VectorXd z = 1e-4 * Longest(VectorXd::Unit(size_, i)) * VectorXd::Unit(size_, i);
      gradient[i] = (Excess(n, z) - Excess(n, -z)) / (2.0 * z.norm());
    }
    return gradient;
  }
  // How long a motion along the unit vector d may be: no turn beyond a half, no slide beyond ten
  // times the geoms.
  double Longest(const VectorXd& d) const {
    double longest = std::numeric_limits<double>::infinity();
    for (const Limb& limb : limbs_) {
      longest = std::min(longest, 2.0 / Turn(limb, d).norm());
      longest = std::min(longest,
                         10.0 * scale / (limb.slides * d.segment(limb.first, limb.size())).norm());
    }
    return longest;
  }
  double FirstParted(const Vector3d& n, const VectorXd& along) const {
    const VectorXd d = along.normalized();
    const double longest = Longest(d);
    double low = 0.0, high = 1e-4 * longest;
    while (!(Excess(n, high * d) >= 0.0)) {
      low = high;
      high *= 1.15;
      if (!(high < longest)) return std::numeric_limits<double>::infinity();
    }
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (Excess(n, middle * d) >= 0.0 ? high : low) = middle;
    }
    return high;
  }

  std::vector<Limb> limbs_;
  int size_ = 0;  // of a motion z
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_BOUND_PARTING_H_
