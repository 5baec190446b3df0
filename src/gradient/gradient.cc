// The public face of the gradient: which case a result is, and what is said of it.
#include "mjcf_pdg/gradient.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "gradient/converged_optimum.h"
#include "gradient/sensitivity.h"
#include "problem/workspace.h"
#include "solve/options.h"

namespace mjcf_pdg {
namespace {

// A change of q_in this small is soon to come [size].
constexpr double kSoon = 1e-4;
// The optimum to which an answer converges may be this far from it [√σ], beside some tolerances:
// farther, it is another one. Of 98 answers of the figure eight are farther than 0.05, and six of
// these descend by 0.01 to 1.5 % of σ.
constexpr double kFarthest = 0.5, kFarthestTolerances = 20.0;

Eigen::Map<const VectorXd> AsEigen(std::span<const double> q) {
  return {q.data(), static_cast<Eigen::Index>(q.size())};
}

const Options& Checked(const Options& options, const mjModel& m) {
  CheckMujocoVersion();
  CheckOptions(options, m);
  if (options.rest > 0.0) throw Error("no gradient of contacts at rest: rest must be 0");
  return options;
}

}  // namespace

struct MJCF_PDG_LOCAL Differentiator::Impl {
  Impl(const Scene& s, const Options& o)
      : scene(s),
        options(Checked(o, *s.model())),
        all(WithAllJoints(scene.tables())),
        work(scene.tables(), options),
        optimum(work, all),
        sensitivity(work, all, optimum) {}

  void AtFree(const VectorXd& q_in, Gradient& gradient);
  void AtSolved(const VectorXd& q_in, const VectorXd& q, Gradient& gradient);

  Scene scene;
  Options options;
  SceneTables all;
  Workspace work;
  ConvergedOptimum optimum;
  Sensitivity sensitivity;
  MocapPoses mocap;
};

// A free configuration stays as it is, and those near it do, unless something is about to touch.
void Differentiator::Impl::AtFree(const VectorXd& q_in, Gradient& gradient) {
  const std::size_t nv = static_cast<std::size_t>(all.n);
  gradient.sigma.assign(nv, 0.0);
  gradient.q.assign(nv * nv, 0.0);
  for (std::size_t dof = 0; dof < nv; ++dof) gradient.q[dof * (nv + 1)] = 1.0;
  const Problem& problem = work.problem();
  const double soon = kSoon * problem.size;
  work.finder.Pose(q_in);
  for (const NearPair& near : work.finder.Find(problem.clearance + soon, Depths::kSkipped)) {
    const double room = near.distance - problem.required[near.pair];
    gradient.active_set_changes |= problem.tables.pairs[near.pair].moves && room < soon;
  }
  for (const JointEntry& joint : problem.tables.joints) {
    if (!joint.limited) continue;
    const bool ball = joint.type == mjJNT_BALL;
    const double at = ball ? BallAngle(q_in.data() + joint.qadr) : q_in[joint.qadr];
    const double room = std::min(joint.hi - at, ball ? joint.hi : at - joint.lo);
    gradient.active_set_changes |= room < (joint.type == mjJNT_SLIDE ? soon : kSoon);
  }
}

void Differentiator::Impl::AtSolved(const VectorXd& q_in, const VectorXd& q, Gradient& gradient) {
  work.Begin(q_in, mocap);
  optimum.SetMocap(mocap);
  const double before = std::sqrt(work.norm.Sigma(q));
  const ConvergedOptimum::Ending ending = optimum.Run(q);
  const double beside = kFarthestTolerances * options.tolerance;
  const bool converged = ending == ConvergedOptimum::Ending::kConverged &&
                         optimum.moved() <= kFarthest * before + beside &&
                         std::sqrt(work.norm.Sigma(optimum.q())) <= before + beside &&
                         work.Free(optimum.q());
  sensitivity.Sigma(converged ? optimum.q() : q);
  const bool frozen = all.n > work.problem().tables.n;
  if (converged || !frozen) {
    gradient.sigma.assign(sensitivity.sigma().begin(), sensitivity.sigma().end());
  }
  gradient.active_set_changes = true;
  if (!converged || !sensitivity.Answer()) return;
  gradient.active_set_changes = sensitivity.room() < kSoon * work.problem().size;
  const MatrixXd rows = sensitivity.answer().transpose();
  gradient.q.assign(rows.data(), rows.data() + rows.size());
}

Differentiator::Differentiator(const Scene& scene, const Options& options)
    : impl_(std::make_unique<Impl>(scene, options)) {
  SetMocap(options.mocap_pos, options.mocap_quat);
}

Differentiator::~Differentiator() = default;
Differentiator::Differentiator(Differentiator&&) noexcept = default;
Differentiator& Differentiator::operator=(Differentiator&&) noexcept = default;

Gradient Differentiator::At(std::span<const double> q_in, const Result& result) {
  impl_->scene.CheckUnchanged();
  impl_->scene.CheckConfiguration(q_in);
  impl_->scene.CheckConfiguration(result.q);
  Gradient gradient;
  if (result.status == Status::kAlreadyFree) {
    impl_->work.Begin(AsEigen(q_in), impl_->mocap);
    impl_->AtFree(impl_->work.problem().q_in, gradient);
  } else if (result.status == Status::kSolved) {
    const SceneTables& tables = impl_->work.problem().tables;
    impl_->AtSolved(AsEigen(q_in), Normalized(tables, AsEigen(result.q)), gradient);
  }
  return gradient;
}

void Differentiator::SetMocap(const std::vector<double>& pos, const std::vector<double>& quat) {
  CheckMocap(pos, quat, *impl_->scene.model());
  impl_->mocap = {pos, quat};
}

}  // namespace mjcf_pdg
