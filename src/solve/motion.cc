// The public face of certified continuous collision detection (ccd/ccdg.h).
#include "mjcf_pdg/motion.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ccd/ccdg.h"
#include "ccd/limit_reach.h"
#include "solve/options.h"
#include "solve/rest.h"
#include "verify/verifier.h"

namespace mjcf_pdg {
namespace {

MotionOutcome ToPublic(CcdOutcome outcome) {
  switch (outcome) {
    case CcdOutcome::kFree:
      return MotionOutcome::kFree;
    case CcdOutcome::kContact:
      return MotionOutcome::kContact;
    case CcdOutcome::kStartInCollision:
      return MotionOutcome::kStartInCollision;
    case CcdOutcome::kLimit:
      return MotionOutcome::kLimit;
    case CcdOutcome::kBudget:
      break;
  }
  return MotionOutcome::kBudget;
}

}  // namespace

struct MJCF_PDG_LOCAL MotionChecker::Impl {
  Impl(const Scene& s, const Options& o)
      : scene(s),
        options(o),
        finder(scene.tables(), std::max(options.clearance, scene.tables().largest_kept)),
        ccd(scene.tables(), finder),
        q0(scene.nq()),
        q1(scene.nq()) {
    ccd_options.tolerance = options.tolerance;
    ccd_options.still_pairs = true;
    const std::vector<KeptPair>& pairs = scene.tables().pairs;
    required.resize(static_cast<Eigen::Index>(pairs.size()));
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      required[static_cast<Eigen::Index>(k)] = pairs[k].Required(options.clearance);
    }
    motion.pairs.reserve(pairs.size());
    if (options.rest > 0.0) {
      verifier = std::make_unique<Verifier>(scene.verifier_model(), options);
    }
    SetMocap(options.mocap_pos, options.mocap_quat);
  }

  void SetMocap(const std::vector<double>& pos, const std::vector<double>& quat);
  void SetEnds(std::span<const double> from, std::span<const double> to);
  void RefuseFrozenMotion() const;
  void LetRest();
  void Fill(const CcdResult& result);
  void FillOutside(int joint);

  Scene scene;
  Options options;
  ContactFinder finder;
  Ccdg ccd;
  CcdOptions ccd_options;
  std::unique_ptr<Verifier> verifier;  // of what rests; null: nothing may
  VectorXd required, required_now;     // per kept pair: smallest distance that counts as free [m]
  VectorXd at_rest;                    // per kept pair, see DistancesAtRest
  int rest_poses = 0;                  // that finding them took
  VectorXd q0, q1, normalized, dq;
  Motion motion;
};

void MotionChecker::Impl::SetMocap(const std::vector<double>& pos,
                                   const std::vector<double>& quat) {
  finder.SetMocap({pos, quat});
  if (verifier) verifier->SetMocap(pos, quat);
}

void MotionChecker::Impl::SetEnds(std::span<const double> from, std::span<const double> to) {
  scene.CheckUnchanged();
  scene.CheckConfiguration(from);
  scene.CheckConfiguration(to);
  std::copy(from.begin(), from.end(), q0.data());
  std::copy(to.begin(), to.end(), q1.data());
  RefuseFrozenMotion();
  dq.setZero(scene.tables().n);
  Integrate(scene.tables(), q0, dq, normalized);
  Difference(scene.tables(), normalized, q1, dq);
}

// Entries of q1 that Integrate would not change.
void MotionChecker::Impl::RefuseFrozenMotion() const {
  const mjModel& m = *scene.model();
  for (int j = 0; j < m.njnt; ++j) {
    const auto& movable = scene.tables().joints;
    const bool moves = std::any_of(movable.begin(), movable.end(),
                                   [j](const JointEntry& joint) { return joint.id == j; });
    const int begin = m.jnt_qposadr[j];
    const int end = j + 1 < m.njnt ? m.jnt_qposadr[j + 1] : static_cast<int>(m.nq);
    if (moves || q0.segment(begin, end - begin) == q1.segment(begin, end - begin)) continue;
    throw Error("the motion changes joint '" + scene.JointName(j) + "', which is frozen");
  }
}

// Pairs that overlap at q0 by no more than options.rest may keep their depth, as the verifier
// measures it: its question is asked for that alone.
void MotionChecker::Impl::LetRest() {
  required_now = required;
  if (!verifier) return;
  const std::span<const double> q(normalized.data(), static_cast<std::size_t>(normalized.size()));
  const std::int64_t poses_before = verifier->queries();
  verifier->IsFree(q, q);
  rest_poses = static_cast<int>(verifier->queries() - poses_before);
  DistancesAtRest(*verifier, scene.tables(), at_rest);
  required_now = required_now.cwiseMin(at_rest);
}

void MotionChecker::Impl::Fill(const CcdResult& result) {
  motion.outcome = ToPublic(result.outcome);
  motion.t = result.t;
  motion.q.assign(result.q.data(), result.q.data() + result.q.size());
  motion.certified = result.certified;
  motion.joint = result.joint < 0 ? -1 : scene.tables().joints[result.joint].id;
  motion.poses = result.poses + rest_poses;
  motion.distance_queries = result.distance_queries;
  motion.pairs.clear();
  for (const int pair : result.pairs) {
    const KeptPair& kept = scene.tables().pairs[pair];
    motion.pairs.push_back({kept.geom1, kept.geom2});
  }
}

void MotionChecker::Impl::FillOutside(int joint) {
  motion.outcome = MotionOutcome::kLimit;
  motion.t = 0.0;
  motion.q.assign(normalized.data(), normalized.data() + normalized.size());
  motion.certified = true;
  motion.pairs.clear();
  motion.joint = scene.tables().joints[joint].id;
  motion.poses = motion.distance_queries = 0;
}

MotionChecker::MotionChecker(const Scene& scene, const Options& options) {
  CheckOptions(options, *scene.model());
  impl_ = std::make_unique<Impl>(scene, options);
}

MotionChecker::~MotionChecker() = default;
MotionChecker::MotionChecker(MotionChecker&&) noexcept = default;
MotionChecker& MotionChecker::operator=(MotionChecker&&) noexcept = default;

void MotionChecker::SetMocap(const std::vector<double>& pos, const std::vector<double>& quat) {
  CheckMocap(pos, quat, *impl_->scene.model());
  impl_->SetMocap(pos, quat);
}

const Motion& MotionChecker::Check(std::span<const double> q0, std::span<const double> q1) {
  Impl& impl = *impl_;
  impl.SetEnds(q0, q1);
  impl.finder.Forget();
  const int outside = JointOutsideLimits(impl.scene.tables(), impl.normalized, kLimitTolerance);
  if (outside >= 0) {
    impl.FillOutside(outside);
    return impl.motion;
  }
  impl.LetRest();
  impl.Fill(impl.ccd.Move({impl.normalized, impl.dq, &impl.required_now}, impl.ccd_options));
  return impl.motion;
}

Motion CheckMotion(const Scene& scene, std::span<const double> q0, std::span<const double> q1,
                   const Options& options) {
  return MotionChecker(scene, options).Check(q0, q1);
}

}  // namespace mjcf_pdg
