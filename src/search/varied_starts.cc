#include "search/varied_starts.h"

#include <algorithm>
#include <cmath>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::starts;

namespace {

constexpr Hop kHops[] = {Hop::kFromBest, Hop::kFromInput, Hop::kMirrored};

}  // namespace

void VariedStarts::Begin(const EffortPlan& plan, const VectorXd& center, bool on_rays) {
  plan_ = plan;
  center_ = center;
  on_rays_ = on_rays;
  random_ = Random(problem_.options.seed);
}

void VariedStarts::TryMirror() {
  starts_.Mirrored(trials_.Best(), start_);
  TryOnRay(start_, Component::kMirror);
}

// The first hop comes second: noisy starts may agree on a wrong answer before a later hop could
// find a better one.
void VariedStarts::TryUntilDone() {
  const bool noise = problem_.Uses(Component::kNoise), hops = problem_.Uses(Component::kHop);
  for (int k = 0; !trials_.Done() && !work_.Spent(); ++k) {
    if (hops && trials_.HasFree() && (k % tune::kHopEvery == 1 || !noise)) {
      TryHop(kHops[(noise ? k / tune::kHopEvery : k) % 3]);
    } else {
      if (!noise) return;
      const double widened = trials_.HasFree() ? 1.0 : 1.0 + tune::kWiderWhenBlind * k;
      TryNoise(widened * tune::kNoise[k % 4]);
    }
    if (!trials_.HasFree() && k + 1 == plan_.blind) return;
  }
}

void VariedStarts::TryNoise(double spread) {
  double sigma = trials_.BestSigma();
  if (!trials_.HasFree()) {
    const double least = tune::kLeastNoise * problem_.size;
    sigma = trials_.outcome().has_overlap
                ? std::max(trials_.outcome().least_overlap.sigma, least * least)
                : problem_.size * problem_.size;
  }
  starts_.Gaussian(center_, sigma, spread, random_, start_);
  TryOnRay(start_, Component::kNoise);
}

void VariedStarts::TryHop(Hop hop) {
  starts_.ContactHop(trials_.Best(), trials_.BestSigma(), hop, random_, start_);
  TryOnRay(start_, Component::kHop);
}

void VariedStarts::TryOnRay(const VectorXd& q, Component start) {
  if (!on_rays_) {
    trials_.Try(q, start, Coarse());
    return;
  }
  starts_.Beyond(center_, q, tune::kRayEnd, far_);
  const double largest_sigma = tune::kWorthADescent * trials_.BestSigma();
  for (const FreeOnRay& free : starts_.FirstFree(center_, {&far_, 1}, largest_sigma)) {
    trials_.Try(free.q, start, Coarse());
  }
}

// The paper's way for motions that no local step from q_in can find: q_f, which may be free, goes
// through contact-space projection and iteration, and a descent starts from where that ends.
void VariedStarts::TryFreePose(const VectorXd& q_f, Component start) {
  if (work_.Spent()) return;
  const IterationResult& result = iteration_.Run(q_f, {.start = start});
  trials_.outcome().iterations += result.iterations;
  trials_.Try(result.q, start, LocalOptions{});
}

void VariedStarts::TryTranslations(const std::vector<NearPair>& overlaps) {
  for (const VectorXd& q_f : starts_.ConstrainedTranslation(overlaps, problem_.q_in)) {
    TryFreePose(q_f, Component::kConstrainedTranslation);
    if (trials_.HasFree()) return;
  }
}

void VariedStarts::TryAnywhere() {
  for (int k = 0; k < plan_.blind && !trials_.HasFree() && !work_.Spent(); ++k) {
    starts_.Uniform(center_, random_, start_);
    trials_.Try(start_, Component::kAnywhere, LocalOptions{});
  }
  if (trials_.HasFree()) TryFreePose(trials_.Best(), Component::kAnywhere);
}

}  // namespace mjcf_pdg
