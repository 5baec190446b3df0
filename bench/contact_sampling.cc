#include "contact_sampling.h"

#include <cmath>
#include <optional>

#include "base/random.h"
#include "ccd/ccdg.h"
#include "measure.h"
#include "paper/free_configuration.h"

namespace mjcf_pdg::bench {
namespace {

// A configuration from the ball {σ <= sigma} about q_in, uniform to first order, moved inside the
// joint limits. `to_tangent` is the pseudo-inverse of ∂r/∂dq at q_in.
VectorXd DrawInBall(Workspace& work, double sigma, const MatrixXd& to_tangent, Random& random) {
  const int n = work.problem().tables.n;
  VectorXd z(n), q;
  for (int i = 0; i < n; ++i) z[i] = random.Normal();
  const double radius = std::sqrt(sigma) * std::pow(random.Uniform(), 1.0 / n);
  Integrate(work.problem().tables, work.problem().q_in, to_tangent * (radius * z.normalized()), q);
  ClampToLimits(work.problem().tables, q);
  return q;
}

}  // namespace

SamplingResult SampleContactSpace(Workspace& work, double seconds, std::uint64_t seed) {
  const double begin = CpuSeconds();
  SamplingResult result;
  const MotionCoherence nothing;
  FreeConfigurationSelection selection(work, nothing);
  selection.Begin(nullptr, seed);
  const std::optional<FreeConfiguration> q_f = selection.SelectInPaperOrder();
  if (!q_f) return result;

  Ccdg ccd(work.problem().tables, work.finder);
  Random random(seed);
  VectorXd r, dq;
  MatrixXd J;
  work.norm.Linearize(work.problem().q_in, r, J);
  const MatrixXd to_tangent = J.completeOrthogonalDecomposition().pseudoInverse();
  auto move = [&](const VectorXd& from, const VectorXd& to) {
    Difference(work.problem().tables, from, to, dq);
    const CcdResult& motion = ccd.Move({from, dq, &work.problem().required});
    ++result.samples;
    if (motion.outcome == CcdOutcome::kStartInCollision) return false;
    const double sigma = work.norm.Sigma(motion.q);
    if (sigma < result.sigma) {
      result.free = true;
      result.sigma = sigma;
      result.q = motion.q;
    }
    return true;
  };
  if (!move(q_f->q, work.problem().q_in)) return result;
  while (CpuSeconds() - begin < seconds) {
    const VectorXd sample = DrawInBall(work, result.sigma, to_tangent, random);
    if (!move(sample, work.problem().q_in)) move(VectorXd(result.q), sample);
  }
  return result;
}

}  // namespace mjcf_pdg::bench
