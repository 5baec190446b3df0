// Is the straight motion between two configurations free? Certified continuous collision detection:
// what is called free is proven, not sampled.
//
// Source: Tang & Kim, CCDg of Sec. 5.2, Eq. 21. Differs from it: every interval that is called free
// is proven by bounds on the motion.
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
  kContact,           // `pairs` are in the way at t
  kStartInCollision,  // `pairs` are nearer than required at q0; t = 0
  kLimit,             // `joint` reaches its limit at t; t = 0 if q0 is outside it already
  kBudget,            // too many poses: nothing is known beyond t
};

// Early, never late: t may be a little short of the true contact, by a few tolerances.
struct Motion {
  MotionOutcome outcome = MotionOutcome::kFree;
  double t = 0.0;         // q(s) is free for all s in [0, t]
  std::vector<double> q;  // q(t), nq
  bool certified =
      true;  // ... proven. False where SDFs or height fields, which are sampled, are near
  std::vector<std::array<int, 2>> pairs;  // ids of geoms in the user's model, in MuJoCo's order
  int joint = -1;            // id of the joint in the user's model, for kLimit; else -1
  int poses = 0;             // at how many configurations the model was posed
  int distance_queries = 0;  // signed distances of single pairs
};

// One per thread; keeps its scratch from one motion to the next. Never writes to the user's model.
class MJCF_PDG_API MotionChecker {
 public:
  // Of the options, tolerance [m], clearance [m], rest [m, of the depths at q0] and the mocap poses
  // count. Equality constraints are not looked at. Throws Error if an option is out of range.
  explicit MotionChecker(const Scene& scene, const Options& options = {});
  ~MotionChecker();
  MotionChecker(MotionChecker&&) noexcept;
  MotionChecker& operator=(MotionChecker&&) noexcept;

  // The motion q(t) = q0 ⊕ t·(q1 ⊖ q0), t from 0 to 1, of nq entries: hinges and slides change
  // linearly, balls and free joints turn the short way at a constant rate. A configuration on it is
  // free if all joint limits hold (within 1e-6 rad or m) and no kept pair is nearer than allowed:
  // nearer than the clearance (pairs that no joint moves: than touching) less what the model's
  // negative margins or `rest` allow, by more than the tolerance. The result is valid until the
  // next call. Throws Error for a bad q0 or q1 (size, NaN, zero quaternion) and for a q1 that
  // differs from q0 in a frozen joint.
  const Motion& Check(std::span<const double> q0, std::span<const double> q1);

  // Where the mocap bodies are from now on, as in Solver::SetMocap: shapes, units and errors, too.
  void SetMocap(const std::vector<double>& pos, const std::vector<double>& quat);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// One motion, with a checker of its own. Throws Error as that does.
MJCF_PDG_API Motion CheckMotion(const Scene& scene, std::span<const double> q0,
                                std::span<const double> q1, const Options& options = {});

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_MOTION_H_
