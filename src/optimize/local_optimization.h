// Local optimization: from any configuration, free or not, to a nearby minimum of σ on the contact
// space.
//
// Source: Tang & Kim, Sec. 5.3: linearize the contacts at q, minimize the object norm subject to
//   C dq + gap >= 0 (Eq. 24-30), move there, repeat until σ stops falling.
// Differs from it:
//   1. The start may penetrate; rows are kept for all pairs within a margin (contact_matrix.h).
//   2. Rows are elastic and steps are damped and cut to a trust radius (linearized_step.h). A step
//      is judged by the merit function ½σ + ν Σ violation, where the penalty weight ν is a few
//      times the largest contact force.
//   3. The LCP is solved by an active-set method (lcp.h); Gauss-Seidel fails on pinched cases.
//   4. Steps hold equality constraints to first order, and are then brought onto them (equality/).
//   5. Exact meshes: a step that ends in an overlap is made again, shorter, bounded by the planes
//      between features that the meshes had where they were apart (feature_memory.h).
#ifndef MJCF_PDG_SRC_OPTIMIZE_LOCAL_OPTIMIZATION_H_
#define MJCF_PDG_SRC_OPTIMIZE_LOCAL_OPTIMIZATION_H_

#include <cstdint>
#include <limits>
#include <vector>

#include "base/tuning.h"
#include "optimize/feature_memory.h"
#include "optimize/linearized_step.h"
#include "problem/strategy.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

struct LocalOptions {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  int max_iterations = tuning::descent::kSteps;
  // The trust radius at first and at most [√σ, m], in scenes up to desk size; it grows with larger
  // ones, up to largest_step.
  double trust_radius = tuning::descent::kTrustRadius;
  double largest_step = kInfinity;
  double margin = tuning::descent::kFirstMargin;  // pairs within it have rows from the start [size]
  double convergence = tuning::descent::kConvergence;  // a smaller relative decrease of σ ends it
  Depths depths = Depths::kMeasured;  // how carefully depths of exact meshes are measured
  int last_chances = tuning::descent::kLastChances;  // exact meshes: steps without a lower σ end it
  double give_up_sigma = kInfinity;  // steps that promise no σ below end it as hopeless [m²]
  // Whether they promise what the next one would lead to if it lowered σ by the same share, too.
  bool looks_ahead = true;
  // An optimum that is known already: a descent ends when a step leads close to it; if it promises
  // no lower σ either, without a query for what is there, and the step does not count.
  const VectorXd* known = nullptr;
  double known_sigma = 0.0;  // [m²]
  bool retreats = false;     // keeps every pair farther apart than required, by a tolerance
  double least_margin = tuning::descent::kLeastMargin;  // pairs within it have rows later [size]
  Component start = Component::kNone;                   // what the start is called, for an observer
  // Resume: trust radius and patience are those of a descent that begins; the damping stays.
  bool renewed = false;
  // A step that is free, neither cut nor damped by more than this share of its length [1], and
  // leads to the σ that it promised up to this share of it [1], ends the descent: to follow what
  // moves, more is not needed.
  double enough = 0.0;
  int corrections = 0;  // steps beyond max_iterations, as long as the last one is not free

  // A last descent to full precision, from a configuration close to its optimum.
  static LocalOptions Polishing();
  // The same from a configuration that the verifier refused, keeping pairs farther apart.
  static LocalOptions Retreating();
};

// How one local optimization ended.
struct LocalOutcome {
  bool free = false;  // q is free by the solver's own distances
  double sigma = std::numeric_limits<double>::infinity();  // of q [m²]
  double violation = 0.0;      // sum over the pairs of their overlap beyond the aim; 0 if free [m]
  bool reached_known = false;  // the last step led close to LocalOptions::known
  bool hopeless = false;       // ended because of LocalOptions::give_up_sigma
  int iterations = 0;
  double length = 0.0;  // of its steps together, each by its linearized norm [√σ, m]
  bool ended = false;   // by itself; false: max_iterations or the budget stopped it
};

struct LocalResult : LocalOutcome {
  VectorXd q;  // nq: the free configuration of least σ that was met, else the one of least merit
};

// Runs do not depend on earlier runs; only memory is kept. Resume goes on with the last one.
class LocalOptimization {
 public:
  explicit LocalOptimization(Workspace& work);

  // Descends from `q` (nq), moved inside its limits; pairs may overlap deeply there. The result is
  // valid until the next run.
  const LocalResult& Run(const VectorXd& q, const LocalOptions& options);
  // Goes on with the last run from at(), by another options.max_iterations, without a query for
  // what is there. The workspace's q_in may have changed since, obstacles and required distances
  // may not. The result holds what is found from here on, at() included.
  const LocalResult& Resume(const LocalOptions& options);
  // Where the last run stands (nq).
  const VectorXd& at() const { return descent_.current.q; }

  std::int64_t lcp_steps() const { return step_.lcp_steps(); }

 private:
  struct Cost {
    double sigma = 0.0;      // [m²]
    double violation = 0.0;  // sum over the pairs of their overlap beyond aim_ [m]
  };
  // A configuration with what its linearization needs.
  struct Iterate : Cost {
    VectorXd q;                  // nq
    double worst = 0.0;          // the largest overlap beyond accept_ [m]; free where it is <= 0
    std::vector<NearPair> near;  // pairs close to each other; of exact meshes, their features
    std::size_t learnt = 0;      // the last so many of `near` are FeatureMemory's learnt planes
  };

  // How far one Run has come.
  struct Progress {
    bool finder_at_current = true;              // the finder is posed at current.q
    double radius = 0.0, largest_radius = 0.0;  // the trust radius, and its largest value [√σ, m]
    double length = 0.0;                        // of the last step [√σ, m]
    double first_length = 0.0;                  // of the first step away from the best iterate
    double sigma_before = 0.0;                  // result.sigma before the last step [m²]
    int without_progress = 0;                   // steps since the best iterate
    int overlapping = 0;                        // steps since the last free iterate
    int taken_back = 0;                         // steps made again since one was taken
    // Steps in a row that: hardly changed σ; promised nothing better than what is known; found no
    // lower σ.
    int settled = 0, hopeless = 0, idle = 0;
    double promised = 0.0;  // the σ that the last step predicted [m²]
  };
  // All that one Run knows.
  struct Descent : Progress {
    LocalOptions options;
    LocalResult result;
    Iterate best, current, trial;
  };

  void Begin(const VectorXd& q, const LocalOptions& options, Descent& d);
  void BeginSteps(const LocalOptions& options, Descent& d);
  const LocalResult& Go(Descent& d);
  void Step(Descent& d);
  void LookAtStep(Descent& d);
  void Observe(const Iterate& it, bool stepped);
  bool LeadsToKnown(Descent& d);
  bool GivesUp(Descent& d);
  void Advance(Descent& d);
  bool HasConverged(Descent& d);
  bool IsEnough(const Descent& d) const;
  bool ReturnToBest(Descent& d);
  // Poses q and finds the pairs within `margin` [m].
  void Look(const VectorXd& q, double margin, Iterate& out);
  // Completes what Look found, at the same pose: depths, σ, violation, worst.
  void Evaluate(double margin, Iterate& out);
  void AdaptSafetyMargin(const Descent& d);
  bool TakeBackStep(Descent& d);
  void MeasureOverlap(std::size_t k, double margin, Iterate& out);
  bool NearKnown(const VectorXd& q, const LocalOptions& options);
  void AdaptDamping(const Iterate& current, const Iterate& trial);
  void SetMeritPenalty();
  void Keep(const Iterate& it, LocalResult& result) const;
  double Merit(const Cost& cost) const {
    return 0.5 * cost.sigma + merit_penalty_ * cost.violation;
  }
  bool Free(const Iterate& it) const { return it.worst <= 0.0; }

  const Problem& problem_;
  Workspace& work_;
  LinearizedStep step_;
  FeatureMemory features_;
  double scale_ = 1.0;          // the scene's size over a desk's: multiplies penalties and radii
  double mu_ = 0.0;             // μ, the penalty weight of contacts in a step [m]
  double merit_penalty_ = 0.0;  // ν, their penalty weight in the merit function [m]
  double damping_ = 0.0;
  double safety_margin_ = 0.0;       // kept beyond the planes of exact meshes [m]
  double aim_ = 0.0, accept_ = 0.0;  // overlaps that are aimed at and accepted [m], see Tolerances
  Depths depths_ = Depths::kMeasured;

  Descent descent_;
  std::vector<NearPair> measured_;  // scratch
  VectorXd apart_, next_;           // scratch
};

// Implements Strategy::Retreat by a run of `local`; adds its iterations to `outcome`.
bool Retreat(LocalOptimization& local, const Candidate& candidate, Outcome& outcome, VectorXd& q);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_LOCAL_OPTIMIZATION_H_
