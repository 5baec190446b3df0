// The public Solver: arguments are checked here; the work is SolverCore's.
#include <mujoco/mujoco.h>

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "solve/options.h"
#include "solve/solver_core.h"

namespace mjcf_pdg {
namespace {

Eigen::Map<const VectorXd> AsEigen(std::span<const double> q) {
  return {q.data(), static_cast<Eigen::Index>(q.size())};
}

// Puts the hint of SetHint back, however a solve with one of its own ends.
struct RestoreHint {
  ~RestoreHint() { hint.swap(kept); }
  VectorXd& hint;
  VectorXd& kept;
};

}  // namespace

struct MJCF_PDG_LOCAL Solver::Impl : SolverCore {
  using SolverCore::SolverCore;
};

Solver::Solver(const Scene& scene, const Options& options) {
  CheckMujocoVersion();
  impl_ = std::make_unique<Impl>(scene, options);
}

Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

Status Solver::Solve(std::span<const double> q_in, Result& result) {
  impl_->CheckInput(q_in);
  return impl_->Solve(q_in, result);
}

Result Solver::Solve(std::span<const double> q_in) {
  Result result;
  Solve(q_in, result);
  return result;
}

Result Solver::Solve(const std::vector<double>& q_in,
                     const std::optional<std::vector<double>>& free_hint) {
  if (!free_hint) return Solve(std::span<const double>(q_in));
  impl_->scene.CheckConfiguration(*free_hint);
  VectorXd kept = AsEigen(*free_hint);
  kept.swap(impl_->hint);
  const RestoreHint restore{impl_->hint, kept};
  return Solve(std::span<const double>(q_in));
}

Status Solver::Solve(const mjData* data, Result& result) {
  if (!data) throw Error("the data is null");
  impl_->scene.CheckUnchanged();
  impl_->SetObstacles(*data);
  const std::size_t nq = static_cast<std::size_t>(impl_->scene.nq());
  return Solve(std::span<const double>(data->qpos, nq), result);
}

bool Solver::IsFree(std::span<const double> q) {
  impl_->CheckInput(q);
  return impl_->verifier.IsFree(q);
}

void Solver::SetHint(std::span<const double> q_free) {
  if (!q_free.empty()) impl_->scene.CheckConfiguration(q_free);
  impl_->hint = AsEigen(q_free);
}

void Solver::SetBudget(const Budget& budget) {
  CheckBudget(budget);
  impl_->budget = budget;
}

void Solver::SetMocap(const std::vector<double>& pos, const std::vector<double>& quat) {
  CheckMocap(pos, quat, *impl_->scene.model());
  impl_->SetMocap(pos, quat);
}

void Solver::SetObserver(Observer observer) { impl_->recorder.Set(std::move(observer)); }

void Solver::Reset() { impl_->Forget(); }

}  // namespace mjcf_pdg
