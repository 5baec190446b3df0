#include "paper/paper_method.h"

#include <utility>

#include "base/tuning.h"

namespace mjcf_pdg {
namespace {

const IterationOptions kIteration = {.max_iterations = tuning::paper::kIterations,
                                     .corrections = tuning::paper::kCorrections,
                                     .reverse_samples = tuning::paper::kReverseSamples};

}  // namespace

PaperMethod::PaperMethod(Workspace& work)
    : problem_(work.problem()),
      work_(work),
      selection_(work, coherence_),
      iteration_(work),
      local_(work) {}

PaperResult PaperMethod::Run(const VectorXd* hint) {
  PaperResult result;
  result.q = problem_.q_in;
  selection_.Begin(hint, problem_.options.seed);
  const std::optional<FreeConfiguration> q_f = selection_.SelectInPaperOrder();
  result.selections = selection_.tried();
  if (!q_f) return result;
  result.start = q_f->start;
  IterationOptions how = kIteration;
  how.start = q_f->start;
  if (!problem_.Uses(Component::kCorrections)) how.corrections = 0;
  if (!problem_.Uses(Component::kReverseProjection)) how.reverse_samples = 0;
  const IterationResult& iterated = iteration_.Run(q_f->q, how);
  sweeps_ += iterated.sweeps;
  result.free = iterated.start_free;
  result.q = iterated.q;
  result.sigma = iterated.sigma;
  result.sigmas = iterated.sigmas;
  result.iterations = iterated.iterations;
  result.status = iterated.status;
  result.certified = iterated.certified;
  return result;
}

Outcome& PaperMethod::Run(const StrategyInput& input) {
  outcome_.Clear();
  const PaperResult result = Run(input.hint);
  outcome_.starts = result.selections;
  outcome_.iterations = result.iterations;
  if (result.free) outcome_.free.Insert(result.q, result.sigma, result.start);
  return outcome_;
}

void PaperMethod::Remember(const VectorXd& q, bool free) {
  if (free) {
    coherence_.AddFree(q);
  } else if (LimitExcess(problem_.tables, q) > 0.0) {
    return;
  } else if (work_.Free(q)) {
    coherence_.AddFree(q);
  } else if (selection_.SelfCollisionFree(q)) {
    coherence_.AddSelfCollisionFree(q);
  }
}

}  // namespace mjcf_pdg
