// The paper's method as one sequence of steps: free-configuration selection, contact-space
// projection, constrained optimization, re-projection, until σ stops falling.
//
// Source: Tang & Kim, Sec. 3.1, 5 and 6.1. The numbered deviations stand with each step, in
// free_configuration.h, successive_perturbation.h, contact_space_projection.h, ccdg.h and
// contact_space_iteration.h.
#ifndef MJCF_PDG_SRC_PAPER_PAPER_METHOD_H_
#define MJCF_PDG_SRC_PAPER_PAPER_METHOD_H_

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "paper/contact_space_iteration.h"
#include "paper/free_configuration.h"
#include "problem/problem.h"

namespace mjcf_pdg {

struct PaperResult {
  bool free = false;  // false: no free configuration was found; q is q_in
  VectorXd q;
  double sigma = std::numeric_limits<double>::infinity();  // [m²]
  std::vector<double> sigmas;  // of the accepted free configurations, never rising [m²]
  std::string start;           // selection
  int selections = 0;          // tried
  int iterations = 0;          // constrained optimizations
  IterationStatus status = IterationStatus::kStartNotFree;  // so too without a selection
  bool certified = false;                                   // every CCD on the way was proven
};

// One per thread. Refers to problem.q_in and what goes with it.
class PaperMethod {
 public:
  explicit PaperMethod(Problem& problem);

  PaperResult Run(const std::optional<VectorXd>& hint = std::nullopt);

  // Motion coherence: an answer, or a frame, for later runs to start from.
  void Remember(const VectorXd& q) { selection_.Remember(q); }
  void RememberFree(const VectorXd& q) { selection_.RememberFree(q); }
  // Of the configurations remembered as free the nearest to q_in.
  std::optional<FreeConfiguration> Recall();

  std::int64_t sweeps() const { return sweeps_; }  // of Gauss-Seidel, all runs together

 private:
  FreeConfigurationSelection selection_;
  ContactSpaceIteration iteration_;
  Problem& problem_;
  std::int64_t sweeps_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PAPER_PAPER_METHOD_H_
