#include "track/elsewhere.h"

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::track;

Elsewhere::Elsewhere(Workspace& work)
    : problem_(work.problem()), work_(work), local_(work), starts_(work), random_(0) {
  q_.resize(problem_.tables.model->nq);
  Reset();
}

void Elsewhere::Reset() {
  random_ = Random(problem_.options.seed);
  next_ = slices_ = 0;
}

// The command itself and the own optimum without limits first, because a way that has opened is
// found from there; then the other side, noise and hops, as a solve takes them.
void Elsewhere::Begin(const VectorXd& own, double own_sigma) {
  constexpr Hop kHops[] = {Hop::kFromBest, Hop::kFromInput, Hop::kMirrored};
  const int turn = next_++;
  start_ = Component::kDirect;
  switch (turn % 6) {
    case 0:
      q_ = problem_.q_in;
      TurnInsideLimits(problem_.tables, q_);
      break;
    case 1:
      q_ = own;
      start_ = Component::kMotionCoherence;
      break;
    case 2:
      starts_.Mirrored(own, q_);
      start_ = Component::kMirror;
      break;
    case 3:
    case 5:
      starts_.Gaussian(problem_.q_in, own_sigma, tuning::starts::kNoise[turn / 2 % 4], random_, q_);
      start_ = Component::kNoise;
      break;
    case 4:
      starts_.ContactHop(own, own_sigma, kHops[turn / 6 % 3], random_, q_);
      start_ = Component::kHop;
      break;
  }
}

bool Elsewhere::Search(const VectorXd& own, double own_sigma, double wanted_sigma) {
  while (!work_.Spent()) {
    if (slices_ == 0) Begin(own, own_sigma);
    LocalOptions options;
    options.max_iterations = tuning::descent::kCoarseSteps;
    options.convergence = tuning::descent::kCoarseConvergence;
    options.give_up_sigma = wanted_sigma;
    options.known = &own;
    options.known_sigma = own_sigma;
    const LocalResult& result = local_.Run(q_, options);
    ++slices_;
    q_ = result.q;
    const bool cut = work_.Spent() && !result.hopeless && !result.reached_known;
    const bool better = result.free && result.sigma < wanted_sigma;
    if (better || !cut || slices_ == tune::kSlices) slices_ = 0;
    if (better) return true;
  }
  return false;
}

}  // namespace mjcf_pdg
