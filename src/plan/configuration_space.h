// The configurations of a scene as a state space of OMPL.
//
// Source: Tang & Kim, Sec. 6.3: planning with the object norm as the distance. The distance is √σ
// [m], measured from the second state (Eq. 19); OMPL asks for the tree's nodes first and the sample
// second, so that one pose of the model serves a whole search for the nearest node. Interpolation
// follows the motions that CCDg proves free, q ⊕ t·(to ⊖ q). Frozen joints keep their values. The
// equality constraints that are held must hold along straight motions (equality/held.h).
#ifndef MJCF_PDG_SRC_PLAN_CONFIGURATION_SPACE_H_
#define MJCF_PDG_SRC_PLAN_CONFIGURATION_SPACE_H_

#include <ompl/base/StateSpace.h>

#include <cstdint>

#include "equality/equality_constraints.h"
#include "mjcf_pdg/scene.h"
#include "norm/norm_evaluator.h"

namespace mjcf_pdg {

// Poses a model of its own: use one object per thread.
class ConfigurationSpace : public ompl::base::StateSpace {
 public:
  class StateType : public ompl::base::State {
   public:
    VectorXd q;  // nq
  };

  // Joints are sampled within their limits. Where there are none: hinges within half a turn of
  // start and goal; slides and free bodies in the box of start and goal, which is made larger on
  // each side by half of the model's extent. `start` and `goal` have nq entries, the same values
  // for frozen joints, and hold the equality constraints.
  ConfigurationSpace(const Scene& scene, const MocapPoses& mocap, const VectorXd& start,
                     const VectorXd& goal);

  const SceneTables& tables() const { return tables_; }
  static const VectorXd& Q(const ompl::base::State* state) {
    return static_cast<const StateType*>(state)->q;
  }
  static VectorXd& Q(ompl::base::State* state) { return static_cast<StateType*>(state)->q; }

  // √σ from q_in to q [m].
  double Distance(const VectorXd& q_in, const VectorXd& q) const;
  // out := from ⊕ t·(to ⊖ from), which may be one of the two.
  void Interpolate(const VectorXd& from, const VectorXd& to, double t, VectorXd& out) const;
  bool HoldsEqualities(const VectorXd& q) const;
  // Brings q onto the equality constraints. Returns whether they hold then.
  bool Project(VectorXd& q) const;
  // Draws uniformly from the bounds, a ball's or a free body's rotation among all that its limit
  // admits; where there are equality constraints, brought onto them.
  void Sample(ompl::RNG& rng, VectorXd& q) const;
  std::int64_t samples() const { return samples_; }  // drawn so far

  // OMPL's questions.
  unsigned int getDimension() const override;
  double getMaximumExtent() const override { return extent_; }
  double getMeasure() const override { return 1.0; }  // unknown, and no planner of ours asks
  bool isMetricSpace() const override { return false; }
  bool hasSymmetricDistance() const override { return false; }
  void enforceBounds(ompl::base::State* state) const override;
  bool satisfiesBounds(const ompl::base::State* state) const override;
  void copyState(ompl::base::State* to, const ompl::base::State* from) const override;
  double distance(const ompl::base::State* a, const ompl::base::State* b) const override;
  bool equalStates(const ompl::base::State* a, const ompl::base::State* b) const override;
  void interpolate(const ompl::base::State* from, const ompl::base::State* to, double t,
                   ompl::base::State* state) const override;
  ompl::base::StateSamplerPtr allocDefaultStateSampler() const override;
  ompl::base::State* allocState() const override;
  void freeState(ompl::base::State* state) const override;
  void registerProjections() override;

 private:
  void Draw(ompl::RNG& rng, VectorXd& q) const;
  void FindBounds(const VectorXd& start, const VectorXd& goal);
  void MeasureExtent();

  const Scene scene_;
  const SceneTables& tables_;
  const MocapPoses mocap_;
  const VectorXd base_;  // values of frozen joints
  VectorXd low_, high_;  // nq; of the entries that are no quaternions
  double extent_ = 1.0;  // the largest distance of random configurations [m]
  mutable NormEvaluator norm_;
  mutable EqualityConstraints equalities_;
  mutable VectorXd reference_;  // that norm_ measures from
  mutable VectorXd dq_;         // scratch
  mutable std::int64_t samples_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_CONFIGURATION_SPACE_H_
