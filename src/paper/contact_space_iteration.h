// The paper's iteration on the contact space, from a free configuration.
//
// Source: Tang & Kim, Sec. 3.1 steps 2-5 and Sec. 5.2-5.4: project the free configuration onto the
// contact space, linearize the contacts there, minimize the object norm on the linearization (LCP
// by projected Gauss-Seidel), re-project, repeat until σ stops falling. Differs from it:
//   1. Joint limits are rows of the LCP, not truncated afterwards.
//   2. A re-projection that would raise σ (possible: on straight lines with large hinge angles σ is
//      not monotone) is not accepted and ends the iteration.
//   3. Contacts within a band count as touching, since projections stop a little before contact.
//   4. Correction (optional): where the minimizer collides, the contacts found there, linearized
//      there, join those at q_c and the minimum is sought again: curvature and contacts that the
//      linearization at q_c does not see. The better of both re-projections is taken.
#ifndef MJCF_PDG_SRC_PAPER_CONTACT_SPACE_ITERATION_H_
#define MJCF_PDG_SRC_PAPER_CONTACT_SPACE_ITERATION_H_

#include <limits>
#include <vector>

#include "base/block_cholesky.h"
#include "optimize/contact_matrix.h"
#include "optimize/lcp.h"
#include "paper/contact_space_projection.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

struct IterationOptions {
  int max_iterations = 30;
  int max_sweeps = 1000;               // projected Gauss-Seidel
  double convergence = 1e-5;           // relative decrease of σ that still counts
  int corrections = 0;                 // per iteration at most, deviation 4
  Component start = Component::kNone;  // what q_f is called, for an observer
  int reverse_samples = 0;  // of the reverse projection (contact_space_projection.h); 0: none
};

// How an iteration ended.
enum class IterationStatus {
  kStartNotFree,    // q_f overlaps
  kConverged,       // σ falls no further, by IterationOptions::convergence
  kWouldRise,       // the next re-projection would raise σ and was refused (deviation 2)
  kRefusedByCcd,    // CCD finds the accepted configuration itself, or the minimizer, in collision
  kIterationLimit,  // IterationOptions::max_iterations
  kBudget,
};

struct IterationResult {
  VectorXd q;               // free if q_f was
  bool start_free = false;  // false: q_f overlaps; q is q_f
  bool certified = true;    // every motion on the way was proven free
  double sigma = std::numeric_limits<double>::infinity();  // [m²]
  std::vector<double> sigmas;  // of the accepted free configurations, never rising [m²]
  int iterations = 0;          // constrained optimizations
  int sweeps = 0;
  IterationStatus status = IterationStatus::kStartNotFree;
};

// Keeps its memory between runs: no run but one with very many contacts takes more.
class ContactSpaceIteration {
 public:
  explicit ContactSpaceIteration(Workspace& work);

  // The result is valid until the next run.
  const IterationResult& Run(const VectorXd& q_f, const IterationOptions& options = {});

 private:
  // q: the minimizer on the linearized contact space around q_c (Eq. 24-30), limits kept.
  void Optimize(const VectorXd& q_c, const IterationOptions& options, VectorXd& q);
  void AppendContactRows(const VectorXd& q);
  void Minimize(const VectorXd& q_c, const IterationOptions& options, VectorXd& q);
  bool Correct(const VectorXd& q_c, const IterationOptions& options, VectorXd& q);
  // From a free q towards q_in, from a colliding q from q_c towards q (Sec. 5.4).
  const ProjectionResult& Reproject(const VectorXd& q_c, const VectorXd& q);
  // Optimizes from result_.q and re-projects; if that lowers σ it becomes the new result_.q.
  // kIterationLimit: it did, and may again.
  IterationStatus Step(const IterationOptions& options);
  void Observe(bool stepped);

  const Problem& problem_;
  Workspace& work_;
  Ccdg ccd_;
  ContactSpaceProjection projection_;
  ProjectionOptions projection_options_;
  ContactRows rows_;
  BlockCholesky whitening_;
  GaussSeidelLcp lcp_;
  IterationResult result_;
  ProjectionResult next_;

  // Scratch; entries per row, or columns of G_, that are beyond the rows in use mean nothing.
  VectorXd q_, r_, y_, dq_, z_;
  VectorXd b_, mu_, lambda_;  // per row
  MatrixXd J_, H_, G_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PAPER_CONTACT_SPACE_ITERATION_H_
