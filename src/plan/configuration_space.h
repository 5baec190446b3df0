// The configurations of a scene as a state space of OMPL.
//
// Source: Tang & Kim, Sec. 6.3: planning with the object norm, √σ, as the distance. Frozen joints
// keep their values.
// Differs from the paper where a hinge turns by more than half a turn: the distance is then that of
// the first half turn, and more in proportion (Distance). √σ itself says how far bodies are from
// where they were, not how far they have to go: a hinge that is a whole turn off is at no distance,
// and the way there, against a limit, leads off first. Trees grew along such ways without end: on a
// KUKA iiwa, whose hinges turn by up to 340°, one of three plans between random configurations was
// not found within 20 s, and takes some milliseconds now.
//
// Distances are measured from the second of OMPL's states: OMPL asks for the tree's nodes first and
// the sample second, so that one pose of the model serves a whole search for the nearest node.
//
// Motions are straight, q(t) = q ⊕ t·(to ⊖ q), where all equality constraints that are held hold
// along straight motions (equality/held.h). Elsewhere (loops, welds, curved couplings) they follow
// the constraints: q(t) is that configuration, brought onto them.
#ifndef MJCF_PDG_SRC_PLAN_CONFIGURATION_SPACE_H_
#define MJCF_PDG_SRC_PLAN_CONFIGURATION_SPACE_H_

#include <ompl/base/StateSpace.h>
#include <ompl/geometric/PathGeometric.h>

#include <cstdint>
#include <functional>
#include <vector>

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
  // The same space for another thread; its samplers draw from a sequence that `seed` begins, and
  // slides and free bodies from a box to which the model's extent adds `margin_share`, in (0, 1],
  // of the half above. extent() is of these samples.
  ConfigurationSpace(const ConfigurationSpace& space, std::uint64_t seed, double margin_share);

  const SceneTables& tables() const { return tables_; }
  // All motions are straight, so that a part of one is the motion between its ends.
  bool straight() const { return straight_; }
  static const VectorXd& Q(const ompl::base::State* state) {
    return static_cast<const StateType*>(state)->q;
  }
  static VectorXd& Q(ompl::base::State* state) { return static_cast<StateType*>(state)->q; }

  // √σ from q_in to q [m].
  double Displacement(const VectorXd& q_in, const VectorXd& q) const;
  // √σ from `from` to `to` [m] where no hinge turns by more than half a turn on the straight motion
  // between them. Elsewhere √σ of its part until the hinge that turns farthest has made half a
  // turn, over the share of the motion that this part is. It falls all along the motion as `to`
  // comes near, but perhaps for a free body whose centre of mass is far from its frame.
  double Distance(const VectorXd& from, const VectorXd& to) const;
  // out := q(t) of the motion from `from` to `to`; it may be one of the two.
  void Interpolate(const VectorXd& from, const VectorXd& to, double t, VectorXd& out) const;

  // Goes along the motion from `from` to `to` in straight pieces, so short that what is held holds
  // along each to kEqualityTolerance; `next` sees where each ends, and says whether to go on.
  // Returns whether that leads to `to`. CCDg proves straight pieces free.
  struct Piece {
    VectorXd q;
    double t;  // 1 at `to`
  };
  bool Follow(const VectorXd& from, const VectorXd& to,
              const std::function<bool(const Piece&)>& next) const;
  bool HoldsEqualities(const VectorXd& q) const;
  // Brings q onto the equality constraints. Returns whether they hold then.
  bool Project(VectorXd& q) const;
  // Draws uniformly from the bounds, a ball's or a free body's rotation among all that its limit
  // admits; where there are equality constraints, brought onto them.
  void Sample(ompl::RNG& rng, VectorXd& q) const;
  std::int64_t samples() const { return samples_; }  // drawn so far
  std::uint64_t NextSeed() const;                    // of a sampler, each time another
  // Whether slides, hinges and free bodies' places are in the bounds of the whole space.
  bool Covers(const VectorXd& q) const;

  // The largest √σ between random configurations [m], by 200 pairs.
  double extent() const { return extent_; }

  // OMPL's questions. Its distances are ours over extent(): OMPL compares them with numbers that
  // are neither large nor small.
  unsigned int getDimension() const override;
  double getMaximumExtent() const override { return 1.0; }
  double getMeasure() const override { return 1.0; }  // unknown: planners take k nearest nodes
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
  void MeasureFrom(const VectorXd& q_in) const;
  void Draw(ompl::RNG& rng, VectorXd& q) const;
  void GoStraight(const VectorXd& from, const VectorXd& to, double t, VectorXd& out) const;
  bool HoldsBetween(const VectorXd& from, const VectorXd& to, double tolerance) const;
  void FindBounds(const VectorXd& start, const VectorXd& goal);
  void MeasureExtent();

  const Scene scene_;
  const SceneTables& tables_;
  const MocapPoses mocap_;
  const VectorXd base_;  // values of frozen joints
  VectorXd low_, high_;  // nq; of the entries that are no quaternions
  VectorXd margin_;      // nq; what the model's extent has added to these on each side
  double margin_share_ = 1.0;
  double extent_ = 1.0;
  mutable NormEvaluator norm_;
  mutable EqualityConstraints equalities_;
  const bool straight_;
  mutable std::uint64_t seed_ = 0;  // of NextSeed
  mutable VectorXd reference_;      // that norm_ measures from
  mutable VectorXd dq_, part_;      // scratch
  mutable std::int64_t samples_ = 0;
};

// Of a path in a ConfigurationSpace.
std::vector<VectorXd> Configurations(const ompl::geometric::PathGeometric& path);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_CONFIGURATION_SPACE_H_
