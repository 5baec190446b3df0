// What one pose of a motion proves about one pair: how long before and after that pose the pair is
// certain to keep its required distance.
//
// A pair's margin is its signed distance less the required one. It is bounded in two ways, and the
// farther reach counts: it changes by at most λ per unit of t (motion_bound.h), and a separating
// plane that moves along with the geoms keeps them apart (separation.h). Both hold towards earlier
// t as well as towards later: a motion run backwards is a motion.
#ifndef MJCF_PDG_SRC_CCD_PAIR_PROOF_H_
#define MJCF_PDG_SRC_CCD_PAIR_PROOF_H_

#include "ccd/motion_bound.h"
#include "ccd/separation.h"
#include "collide/contacts.h"

namespace mjcf_pdg {

// The motion q(t) = q0 ⊕ t·dq, t in [0, 1]. It refers to what it was made from, which must live
// until the motion has been checked.
struct CcdMotion {
  const VectorXd& q0;  // nq
  const VectorXd& dq;  // n
  // Smallest signed distance of each kept pair [m]; null: -KeptPair::allowed.
  const VectorXd* required = nullptr;
};

enum class Direction { kEarlier, kLater };

struct Margin {
  double value = 0.0;     // signed distance less the required one, or a lower bound of it [m]
  bool measured = false;  // true: it is the distance, not a bound, and the witness is known:
  Vector3d n_W, p1_W;     // its normal, and its point on geom 1
};

struct Reach {
  double length = 0.0;  // the pair is proven to stay above its floor for so long [units of t]
  double rate = 0.0;    // how fast its witness points part at the pose [m per unit of t]
  double lambda = 0.0;  // λ on the horizon that gave `length` [m per unit of t]
};

// One per thread.
class PairProof {
 public:
  // Poses and queries go through `finder`.
  PairProof(const SceneTables& tables, ContactFinder& finder);

  // Begins a motion. q0 and dq are copied, `motion.required` is referred to. `tolerance` [m].
  void SetMotion(const CcdMotion& motion, double tolerance);
  bool Moves(int body_pair) const { return motion_.Moves(body_pair); }
  double Required(int pair) const {
    return required_ ? (*required_)[pair] : -tables_.pairs[pair].allowed;
  }

  // q = q0 ⊕ t·dq; q0 bit for bit at t = 0.
  void At(double t, VectorXd& q);
  // Poses the finder at t. The questions below are about this pose.
  void PoseAt(double t);

  // How long before and after the pose all pairs of two bodies are proven to keep `distance` [m],
  // by the bodies' bounding spheres alone; <= 0 if that proves nothing. More than
  // `horizon` proves the horizon and no more.
  double BodiesReach(int body_pair, double distance, double horizon);
  // The same for one pair and the margin `floor` [m], by the geoms' bounding volumes.
  Reach BoundsReach(int body_pair, int pair, double floor, double horizon);

  // The pair's margin; where it is more than `enough` [m] possibly a lower bound. One distance
  // query.
  Margin Measure(int pair, double enough);
  // How long in one direction, at most `horizon`, the pair is proven to keep a margin of `floor`
  // [m].
  Reach Prove(int body_pair, int pair, const Margin& margin, double floor, Direction direction,
              double horizon);

 private:
  const SceneTables& tables_;
  ContactFinder& finder_;
  MotionBound motion_;
  Separation separation_;
  VectorXd q0_, dq_, step_, q_;
  const VectorXd* required_ = nullptr;
  double tolerance_ = 0.0;  // [m]
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_CCD_PAIR_PROOF_H_
