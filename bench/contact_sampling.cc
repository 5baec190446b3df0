#include "contact_sampling.h"

#include <cmath>
#include <optional>

#include "base/random.h"
#include "ccd/ccdg.h"
#include "measure.h"
#include "paper/free_configuration.h"

namespace mjcf_pdg::bench {
namespace {

// Uniform in the ball {σ <= sigma} about q_in, to first order.
VectorXd DrawInBall(Problem& problem, double sigma, const MatrixXd& to_tangent, Random& random) {
  const int n = problem.tables.n;
  VectorXd z(n), q;
  for (int i = 0; i < n; ++i) z[i] = random.Normal();
  const double radius = std::sqrt(sigma) * std::pow(random.Uniform(), 1.0 / n);
  Integrate(problem.tables, problem.q_in, to_tangent * (radius * z.normalized()), q);
  ClampToLimits(problem.tables, q);
  return q;
}

}  // namespace

SamplingResult SampleContactSpace(Problem& problem, double seconds, std::uint64_t seed) {
  const double begin = CpuSeconds();
  SamplingResult result;
  FreeConfigurationSelection selection(problem);
  selection.Begin(std::nullopt, seed);
  const std::optional<FreeConfiguration> q_f = selection.SelectInPaperOrder();
  if (!q_f) return result;

  Ccdg ccd(problem.tables, problem.finder);
  Random random(seed);
  VectorXd r, dq;
  MatrixXd J;
  problem.norm.Linearize(problem.q_in, r, J);
  const MatrixXd to_tangent = J.completeOrthogonalDecomposition().pseudoInverse();
  auto move = [&](const VectorXd& from, const VectorXd& to) {
    Difference(problem.tables, from, to, dq);
    const CcdResult& motion = ccd.Move({from, dq, &problem.required});
    ++result.samples;
    if (motion.outcome == CcdOutcome::kStartInCollision) return false;
    const double sigma = problem.norm.Sigma(motion.q);
    if (sigma < result.sigma) {
      result.free = true;
      result.sigma = sigma;
      result.q = motion.q;
    }
    return true;
  };
  if (!move(q_f->q, problem.q_in)) return result;
  while (CpuSeconds() - begin < seconds) {
    const VectorXd sample = DrawInBall(problem, result.sigma, to_tangent, random);
    if (!move(sample, problem.q_in)) move(VectorXd(result.q), sample);
  }
  return result;
}

}  // namespace mjcf_pdg::bench
