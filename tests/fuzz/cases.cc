#include "tests/fuzz/cases.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "mjcf_pdg/pdg.h"
#include "tests/fuzz/problem.h"

namespace mjcf_pdg::test {
namespace {

constexpr int kQueries = 300;  // budget of a solve

void HandleMessage(const mjLogMessage* message) {
  if (message->level >= mjLOG_ERROR) throw std::runtime_error(message->subject);
}

std::string WrongResult(const Problem& problem, const Result& result) {
  if (!Finite(result.q)) return "q is not finite";
  if (!Finite({result.sigma, result.sigma_lower_bound, result.depth_in, result.min_distance,
               result.limit_excess_in, result.equality_residual_in, result.equality_residual})) {
    return "a number is not finite";
  }
  if (!Finite(result.contacts_in) || !Finite(result.contacts)) return "a contact is not finite";
  if (result.sigma < 0.0) return "σ is negative";
  const bool unsolved = result.status == Status::kUnsolved;
  if (unsolved != (result.cause != Cause::kNone) || unsolved == result.reason.empty()) {
    return "cause or reason do not fit the status";
  }
  if (result.status == Status::kAlreadyFree) {
    const bool same =
        std::equal(problem.q.begin(), problem.q.end(), result.q.begin(), [](double a, double b) {
          return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
        });
    if (!same) return "a free input came back changed";
  }
  if (unsolved) return "";
  // The bound knows no equality constraints, but leaves them out, which lowers it.
  if (result.sigma_lower_bound > result.sigma * (1.0 + 1e-9)) return "σ is below its lower bound";
  return Refute(problem, result.q);
}

// What is free must not be nearer than the bound: answers of other seeds, and configurations near
// and on this side of the answer.
std::string FreeBelowBound(const Problem& problem, const Result& result, Random& rng) {
  const double bound = result.sigma_lower_bound * (1.0 - 1e-9);
  if (!(bound > 0.0)) return "";
  ObjectNorm norm(*problem.scene, problem.options.metric, problem.q);
  const mjModel* m = problem.scene->model();
  const auto below = [&](const std::vector<double>& q) {
    return norm.Sigma(q) < bound && Verify(*problem.scene, q, problem.options).free;
  };
  Options options = problem.options;
  options.report_lower_bound = false;
  for (const std::uint64_t seed : {101, 102}) {
    options.seed = seed;
    Solver solver(*problem.scene, options);
    solver.SetBudget({kQueries, 0.0});
    const Result other = solver.Solve(std::span<const double>(problem.q));
    if (other.status == Status::kSolved && below(other.q))
      return "another seed's answer is below the bound";
  }
  std::vector<double> dq(m->nv), q;
  for (int k = 0; k < 60; ++k) {
    q = problem.q;
    mj_differentiatePos(m, dq.data(), 1.0, problem.q.data(), result.q.data());
    double length = 0.0;
    for (const double d : dq) length = std::max(length, std::abs(d));
    for (double& d : dq) d = rng.Uniform(0.5, 1.0) * d + 0.2 * length * rng.Normal();
    mj_integratePos(m, q.data(), dq.data(), 1.0);
    if (below(q)) return "something free is below the bound";
  }
  return "";
}

}  // namespace

QuietMujoco::QuietMujoco() { mju_setLogHandler(HandleMessage); }
QuietMujoco::~QuietMujoco() { mju_setLogHandler(nullptr); }

CaseOutcome VerdictCase(std::uint64_t seed) {
  Random rng(seed);
  const Problem problem(rng);
  if (!problem.scene) return {"refused", ""};
  const Verdict verdict = Verify(*problem.scene, problem.q, problem.options);
  CaseOutcome outcome{verdict.free ? "free" : "not free", ""};
  if (!Finite({verdict.min_distance, verdict.limit_excess, verdict.equality_residual}) ||
      !Finite(verdict.contacts)) {
    outcome.wrong = "a number of the verdict is not finite";
  }
  Options fast = problem.options;
  fast.effort = Effort::kFast;
  if (Solver(*problem.scene, fast).IsFree(problem.q) != verdict.free) {
    outcome.wrong = "IsFree and Verify differ";
  }
  const std::vector<double> other =
      DrawConfiguration(*problem.scene->model(), problem.drawn.scale, rng);
  ObjectNorm norm(*problem.scene, Metric::kSequential, problem.q);
  const double sigma = norm.Sigma(other);
  if (!std::isfinite(sigma) || sigma < 0.0) outcome.wrong = "σ is no number";
  if (verdict.free && outcome.wrong.empty()) outcome.wrong = Refute(problem, problem.q);
  if (!outcome.wrong.empty()) outcome.wrong += problem.Words();
  return outcome;
}

CaseOutcome SolvingCase(std::uint64_t seed) {
  Random rng(seed);
  Problem problem(rng);
  if (!problem.scene) return {"refused", ""};
  problem.options.report_contacts = true;
  problem.options.report_distances_to = rng.Chance(0.5) ? 1.0 : 0.0;
  if (rng.Chance(0.2)) problem.options.metric = Metric::kDisplacement;
  if (rng.Chance(0.3)) problem.options.effort = Effort::kFast;
  if (rng.Chance(0.1) && problem.scene->HeldEqualities().empty()) {
    problem.options.method = Method::kPaper;
  }
  Solver solver(*problem.scene, problem.options);
  solver.SetBudget({kQueries, 0.0});
  const Result result = solver.Solve(std::span<const double>(problem.q));
  const char* kinds[] = {"already free", "solved", "unsolved"};
  CaseOutcome outcome{kinds[static_cast<int>(result.status)], WrongResult(problem, result)};
  if (result.status == Status::kSolved && outcome.wrong.empty()) {
    outcome.wrong = FreeBelowBound(problem, result, rng);
  }
  if (!outcome.wrong.empty()) {
    outcome.wrong += " (" + outcome.kind + ")" + problem.Words() + ", q " +
                     Join(result.q.data(), static_cast<int>(result.q.size()));
  }
  return outcome;
}

}  // namespace mjcf_pdg::test
