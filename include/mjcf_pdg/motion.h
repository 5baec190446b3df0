// Is the straight motion between two configurations free? Answered by certified continuous
// collision detection (CCDg): an interval that is called free is proven free, not sampled.
//
// Source: Tang & Kim, CCDg of Sec. 5.2, Eq. 21. Differs from it: every interval that is called free
// is proven so by bounds on the motion.
#ifndef MJCF_PDG_MOTION_H_
#define MJCF_PDG_MOTION_H_

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "mjcf_pdg/export.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

// How far a motion is free, and what ended it.
enum class MotionOutcome {
  kFree,              // nothing in the way
  kContact,           // `pairs` touch or are about to touch at t
  kStartInCollision,  // `pairs` are nearer than required at q0; t = 0
  kLimit,             // `joint` reaches its limit at t; t = 0 if q0 is outside it already
  kBudget,            // the proof takes too many poses: nothing is known beyond t
};

// What was found about a motion. t is never beyond the first contact; it may be short of it,
// because the motion ends while the geoms are still a few tolerances apart.
struct Motion {
  MotionOutcome outcome = MotionOutcome::kFree;
  double t = 0.0;         // q(s) is free for all s in [0, t]
  std::vector<double> q;  // q(t), nq entries
  // q(s) is proven free up to t. False if an SDF is near: those are only sampled.
  bool certified = true;
  std::vector<std::array<int, 2>> pairs;  // ids of geoms in the user's model, in MuJoCo's order
  int joint = -1;            // id of the joint in the user's model, for kLimit; else -1
  int poses = 0;             // configurations at which the model was posed
  int distance_queries = 0;  // signed distances that were measured, of one pair each
};

// Checks one motion after the other and keeps its scratch in between. Use one per thread. It never
// writes to the user's model.
class MJCF_PDG_API MotionChecker {
 public:
  // Of the options, tolerance, clearance, rest (of contacts at q0) and the mocap poses count.
  // Equality constraints and tendon limits are ignored. Throws Error if an option is out of range.
  explicit MotionChecker(const Scene& scene, const Options& options = {});
  ~MotionChecker();
  MotionChecker(MotionChecker&&) noexcept;
  MotionChecker& operator=(MotionChecker&&) noexcept;

  // Checks the motion q(t) = q0 ⊕ t·(q1 ⊖ q0) for t from 0 to 1; q0 and q1 have nq entries. Hinges
  // and slides change linearly; balls and free joints turn the short way at a constant rate. A
  // configuration is free if all joint limits hold within kLimitTolerance, and if every kept pair
  // keeps its required distance within the tolerance. That is the clearance (0 for pairs that no
  // joint can separate), less the overlap that the model's negative margins or `rest` allow. The
  // result is valid until the next call. Throws Error for a bad q0 or q1 (size, NaN, zero
  // quaternion) and for a q1 that differs from q0 in a frozen joint.
  const Motion& Check(std::span<const double> q0, std::span<const double> q1);

  // Sets the poses of the mocap bodies, with the shapes, units and errors of Solver::SetMocap.
  void SetMocap(const std::vector<double>& pos, const std::vector<double>& quat);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Checks one motion with a MotionChecker of its own, and throws the same Errors.
MJCF_PDG_API Motion CheckMotion(const Scene& scene, std::span<const double> q0,
                                std::span<const double> q1, const Options& options = {});

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_MOTION_H_
