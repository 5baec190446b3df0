// The paper's method as one sequence of steps: free-configuration selection, contact-space
// projection, constrained optimization, re-projection, until σ stops falling.
//
// Source: Tang & Kim, Sec. 3.1, 5 and 6.1. The numbered deviations stand with each step, in
// free_configuration.h, successive_perturbation.h, contact_space_projection.h, ccdg.h and
// contact_space_iteration.h.
#ifndef MJCF_PDG_SRC_PAPER_PAPER_METHOD_H_
#define MJCF_PDG_SRC_PAPER_PAPER_METHOD_H_

#include <cstdint>
#include <limits>
#include <vector>

#include "optimize/local_optimization.h"
#include "paper/contact_space_iteration.h"
#include "paper/free_configuration.h"
#include "problem/strategy.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

struct PaperResult {
  bool free = false;  // false: no free configuration was found; q is q_in
  VectorXd q;
  double sigma = std::numeric_limits<double>::infinity();  // [m²]
  std::vector<double> sigmas;          // of the accepted free configurations, never rising [m²]
  Component start = Component::kNone;  // selection
  int selections = 0;                  // tried
  int iterations = 0;                  // constrained optimizations
  IterationStatus status = IterationStatus::kStartNotFree;  // so too without a selection
  bool certified = false;                                   // every CCD on the way was proven
};

// One per thread.
class PaperMethod : public Strategy {
 public:
  explicit PaperMethod(Workspace& work);

  PaperResult Run(const VectorXd* hint = nullptr);

  Outcome& Run(const StrategyInput& input) override;
  bool UsesLowerBound() const override { return false; }
  // The paper's answers are final.
  bool Polish(Candidate&) override { return false; }
  bool Retreat(const Candidate& candidate, VectorXd& q) override {
    return mjcf_pdg::Retreat(local_, candidate, outcome_, q);
  }
  std::int64_t lcp_steps() const override { return sweeps_ + local_.lcp_steps(); }
  std::int64_t other_queries() const override { return 0; }
  // Frames that overlap count too, if they are free of self-collision at least.
  void Remember(const VectorXd& q, bool free) override;
  void Forget() override { coherence_.Clear(); }

 private:
  const Problem& problem_;
  Workspace& work_;
  MotionCoherence coherence_;
  FreeConfigurationSelection selection_;
  ContactSpaceIteration iteration_;
  LocalOptimization local_;  // for Retreat
  Outcome outcome_;
  std::int64_t sweeps_ = 0;  // of Gauss-Seidel
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PAPER_PAPER_METHOD_H_
