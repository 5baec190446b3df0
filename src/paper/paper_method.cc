#include "paper/paper_method.h"

#include <utility>

namespace mjcf_pdg {
namespace {

constexpr char kCoherence[] = "motion_coherence";
constexpr IterationOptions kIteration = {
    .max_iterations = 100, .corrections = 6, .reverse_samples = 16};

}  // namespace

PaperMethod::PaperMethod(Problem& problem)
    : selection_(problem), iteration_(problem), problem_(problem) {}

PaperResult PaperMethod::Run(const std::optional<VectorXd>& hint) {
  PaperResult result;
  result.q = problem_.q_in;
  selection_.Begin(hint, problem_.options.seed);
  const std::optional<FreeConfiguration> q_f = selection_.SelectInPaperOrder();
  result.selections = selection_.tried();
  if (!q_f) return result;
  result.start = q_f->start;
  IterationOptions how = kIteration;
  if (!problem_.Uses("corrections")) how.corrections = 0;
  if (!problem_.Uses("reverse_projection")) how.reverse_samples = 0;
  IterationResult iterated = iteration_.Run(q_f->q, how);
  sweeps_ += iterated.sweeps;
  result.free = iterated.start_free;
  result.q = std::move(iterated.q);
  result.sigma = iterated.sigma;
  result.sigmas = std::move(iterated.sigmas);
  result.iterations = iterated.iterations;
  result.status = iterated.status;
  result.certified = iterated.certified;
  return result;
}

std::optional<FreeConfiguration> PaperMethod::Recall() {
  std::optional<VectorXd> q = selection_.NearestRemembered();
  return q ? std::optional(FreeConfiguration{*std::move(q), kCoherence}) : std::nullopt;
}

}  // namespace mjcf_pdg
