// Local optimization: from any configuration, free or not, to a nearby minimum of σ on the contact
// space.
//
// Source: Tang & Kim, Sec. 5.3: linearize the contacts at q, minimize the object norm subject to
//   C dq + gap >= 0 (Eq. 24-30), move there, repeat until σ stops falling.
// Differs from it:
//   1. The start may penetrate; rows are kept for all pairs within a margin (contact_matrix.h).
//   2. Rows are elastic: a violated contact costs μ per metre, so conflicting contacts have an
//      answer. Steps are judged by ½σ + ν Σ violation, ν a few times the largest contact force,
//      with a trust radius in object-norm units and Levenberg-Marquardt damping.
//   3. The LCP is solved by an active-set method (lcp.h); Gauss-Seidel fails on pinched cases.
#ifndef MJCF_PDG_SRC_OPTIMIZE_LOCAL_OPTIMIZATION_H_
#define MJCF_PDG_SRC_OPTIMIZE_LOCAL_OPTIMIZATION_H_

#include <cstdint>
#include <limits>
#include <vector>

#include "base/block_cholesky.h"
#include "optimize/contact_matrix.h"
#include "optimize/feature_memory.h"
#include "optimize/lcp.h"
#include "optimize/witness_memory.h"
#include "problem/strategy.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

struct LocalOptions {
  int max_iterations = 60;
  double trust_radius = 0.3;  // largest step, √σ units [m]; grows with large scenes
  double convergence = 1e-4;  // relative decrease of σ that still counts
  double largest_step = std::numeric_limits<double>::infinity();  // whatever the scene [m]
  Depths depths = Depths::kMeasured;                              // of exact meshes that overlap
  int last_chances = 4;  // steps without a lower σ of exact meshes that end it
  double give_up_sigma =
      std::numeric_limits<double>::infinity();  // a worse prediction ends it [m²]
  const VectorXd* known = nullptr;  // an optimum already found: coming close to it ends it
  double known_sigma = 0.0;         // [m²]
  bool retreats = false;            // keeps pairs a tolerance farther apart than required

  // A last descent from close to the answer, to full precision.
  static LocalOptions Polishing();
  // The same for a configuration that the verifier calls not free.
  static LocalOptions Retreating();
};

// How one local optimization ended.
struct LocalOutcome {
  double sigma = std::numeric_limits<double>::infinity();  // [m²]
  bool reached_known = false;                              // ended close to LocalOptions::known
  bool hopeless = false;                                   // ended by LocalOptions::give_up_sigma
  bool free = false;                                       // by the solver's own distances
  double violation =
      0.0;  // 0 if free, else Σ over pairs of the overlap beyond what is aimed at [m]
  int iterations = 0;
};

struct LocalResult : LocalOutcome {
  VectorXd q;
};

// Keeps its memory between runs.
class LocalOptimization {
 public:
  explicit LocalOptimization(Workspace& work);

  // From `q` moved inside its limits; overlaps may be deep. Bounded by options.max_iterations. The
  // result is valid until the next run.
  const LocalResult& Run(const VectorXd& q, const LocalOptions& options);

  std::int64_t lcp_steps() const { return lcp_steps_; }

 private:
  struct Cost {
    double sigma = 0.0;
    double violation = 0.0;  // Σ overlap beyond `aim`
  };
  // A configuration with all that its linearization needs.
  struct Iterate : Cost {
    VectorXd q;
    double worst = 0.0;  // largest overlap beyond `accept`
    std::vector<NearPair> near;
    std::size_t found = 0;  // the first of `near`; the others are planes learnt before
  };

  // How far one Run has come.
  struct Progress {
    bool finder_at_current = true;
    double radius = 0.0, largest_radius = 0.0;  // of trust [m]
    double length = 0.0, first_length = 0.0;    // of the last step, of the first since the best [m]
    double sigma_before = 0.0;                  // result.sigma before the last step
    int without_progress = 0;                   // steps since the best
    int retreats = 0;                           // since a step was taken
    int settled = 0, hopeless = 0, idle = 0;    // steps in a row that were so
  };
  // One Run.
  struct Descent : Progress {
    LocalOptions options;
    LocalResult result;
    Iterate best, current, trial;
  };

  void Begin(const VectorXd& q, const LocalOptions& options, Descent& d);
  void Step(Descent& d);
  bool GivesUp(Descent& d);
  void Advance(Descent& d);
  bool HasConverged(Descent& d);
  bool ReturnToBest(Descent& d);
  // Poses q and asks what is near; Evaluate judges it, at that pose.
  void Look(const VectorXd& q, double margin, Iterate& out);
  void Evaluate(double margin, Iterate& out);
  void AdaptStandOff(const Descent& d);
  bool Retreat(Descent& d);
  void MeasureOverlap(std::size_t k, double margin, Iterate& out);
  void Linearize(const Iterate& at, double margin);
  bool NearKnown(const VectorXd& q, const LocalOptions& options);
  void AddDamping();
  void AdaptDamping(const Iterate& current, const Iterate& trial);
  void SetMeritPrice();
  double LargestTurn() const;  // of dq_ [rad]
  // Solves for the step at the current linearization; returns its length ‖J dq‖ [m].
  double SolveStep(double trust_radius);
  void SolveLcp();
  void PredictStep();
  void Keep(const Iterate& it, LocalResult& result) const;
  double Merit(const Cost& cost) const { return 0.5 * cost.sigma + merit_price_ * cost.violation; }
  bool Free(const Iterate& it) const { return it.worst <= 0.0; }

  const Problem& problem_;
  Workspace& work_;
  WitnessMemory memory_;
  FeatureMemory features_;  // of exact pairs
  ContactRows rows_;
  int contact_rows_ = 0;  // the first of them; the others are joint limits
  ActiveSetLcp lcp_;
  std::int64_t lcp_steps_ = 0;
  double scale_ = 1.0;  // of lengths in large scenes
  double mu_ = 0.0;
  double merit_price_ = 0.0;     // [m]
  Cost predicted_;               // after the last step, by its linearization
  double promised_sigma_ = 0.0;  // had it not been cut
  double damping_ = 0.0;
  double stand_off_ = 0.0;           // of exact meshes [m]
  double aim_ = 0.0, accept_ = 0.0;  // overlaps that are aimed at and accepted [m]
  Depths depths_ = Depths::kMeasured;
  bool remembers_ = true, damps_ = true;  // false: left out (Options::without)

  // Scratch; entries per row, or columns of G_, that are beyond the rows in use mean nothing.
  Descent descent_;
  std::vector<const NearPair*> nearest_;
  std::vector<NearPair> measured_;
  VectorXd apart_, to_known_, moved_, next_, r_, z_, dq_, y_;
  VectorXd lambda_, b_, bounds_, slack_;  // per row
  MatrixXd J_, H_, G_;
  BlockCholesky whitening_;
};

// Strategy::Retreat by a local optimization, whose iterations `outcome` counts.
bool Retreat(LocalOptimization& local, const Candidate& candidate, Outcome& outcome, VectorXd& q);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_LOCAL_OPTIMIZATION_H_
