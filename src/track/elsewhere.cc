#include "track/elsewhere.h"

#include "base/tuning.h"

namespace mjcf_pdg {

Elsewhere::Elsewhere(Workspace& work)
    : problem_(work.problem()), work_(work), local_(work), starts_(work), random_(0) {
  q_.resize(problem_.tables.model->nq);
  Reset();
}

void Elsewhere::Reset() {
  random_ = Random(problem_.options.seed);
  next_ = 0;
  running_ = false;
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

// The start of a descent, or its next step: one query, unless obstacles have moved. What begins at
// the own optimum is near what is known, but may lead away from it with the wider reach of a
// search.
const LocalResult& Elsewhere::Step(const Wanted& wanted) {
  LocalOptions options;
  options.convergence = tuning::descent::kCoarseConvergence;
  options.give_up_sigma = wanted.sigma;
  options.looks_ahead = false;  // few steps are left to keep promises
  if (start_ != Component::kMotionCoherence) options.known = &wanted.own;
  options.known_sigma = wanted.own_sigma;
  const bool same = obstacles_ == wanted.obstacles;
  obstacles_ = wanted.obstacles;
  if (!running_) {
    Begin(wanted.own, wanted.own_sigma);
    running_ = true;
    steps_ = options.max_iterations = 0;
    return local_.Run(q_, options);
  }
  ++steps_;
  options.max_iterations = 1;
  if (same) return local_.Resume(options);
  q_ = local_.at();
  return local_.Run(q_, options);
}

bool Elsewhere::Search(const Wanted& wanted) {
  const std::int64_t last = work_.finder.queries() + wanted.queries;
  while (work_.finder.queries() < last && !work_.Spent()) {
    const LocalResult& result = Step(wanted);
    const bool better = result.free && result.sigma < wanted.sigma;
    const bool over = result.ended || steps_ == tuning::track::kSearchSteps;
    if (better || over) running_ = false;
    if (!better) continue;
    q_ = result.q;
    return true;
  }
  return false;
}

}  // namespace mjcf_pdg
