// Certified continuous collision detection along a configuration line: the CCD of the paper's
// Alg. 2, built on bisection.
//
// Source: Tang & Kim, Sec. 5.2, Eq. 21: the largest t with q(t) = q0 ⊕ t·dq free, all joints at
// once, sought by bisecting [0, 1]. Intervals wait on a stack, the earliest on top. The top one is
// free when each pair is: proven forward from its start and backward from its end, as far as the
// motion's bounds reach (pair_proof.h), until the two proofs meet. If not, it is split.
// Differs from it:
//   1. Certified: what lies between poses is proven, except in 6. The t found may be smaller than
//      the time of contact, never larger.
//   2. The split is where two proofs are expected to meet, a quarter of the interval or more from
//      its ends; CcdOptions::halve splits in the middle, as the paper does.
//   3. An end is asked when the proofs are expected to meet before it. From the start an interval
//      is first shortened to what is not proven yet: a proof made for one interval holds for its
//      parts and for those after it.
//   4. It stops a little before touching, so that contact normals exist where it ends.
//   5. A pair that starts inside the contact band (gliding) does not stop everything: it may go on
//      as long as it is proven to keep half of its margin, or -tolerance where it has none.
//   6. SDF pairs have contacts but no distances: they are sampled, and the result says that it is
//      not certified.
//   7. An exact mesh is further away than its convex hull: proofs of separation, which are of
//      hulls, hold for it, and where the hulls overlap the distance of the triangles alone counts.
// Invariants: [0, front] is free, front = the least `until` of all pairs, and it only grows (but
// for 6); the intervals on the stack are adjacent, from the front to the end of the motion.
#ifndef MJCF_PDG_SRC_CCD_CCDG_H_
#define MJCF_PDG_SRC_CCD_CCDG_H_

#include <vector>

#include "ccd/pair_proof.h"
#include "problem/budget.h"

namespace mjcf_pdg {

struct CcdOptions {
  double tolerance = 1e-6;  // overlap beyond the required distance that is still free [m], > 0
  int max_poses = 1000;     // budget of one motion
  bool halve = false;       // plain bisection: both ends of an interval are asked, then its middle
  // Pairs that the motion does not move count, too: where they overlap, the start is in collision.
  bool still_pairs = false;
  const BudgetMeter* budget = nullptr;  // of a solve that the motion is part of, if it has one

  // Contact band: pairs stop between half of it and all of it apart [m]. Four tolerances: two are
  // left where the motion ends, so that contact normals, noise below a tenth of one, are sure.
  double Gap() const { return 4.0 * tolerance; }
};

enum class CcdOutcome {
  kFree,              // nothing in the way up to t = 1
  kContact,           // `pairs` are in the way at t
  kStartInCollision,  // `pairs` overlap already; t = 0
  kLimit,             // `joint` reaches its limit at t
  kBudget,            // max_poses or the budget used up at t
};

struct CcdResult {
  CcdOutcome outcome = CcdOutcome::kFree;
  double t = 0.0;            // the motion is free on [0, t]
  bool certified = true;     // proven to be so; false where pairs with an SDF were sampled
  std::vector<int> pairs;    // indices into SceneTables::pairs
  int joint = -1;            // index into SceneTables::joints
  VectorXd q;                // q0 ⊕ t·dq
  int poses = 0;             // kinematics of the whole model
  int distance_queries = 0;  // signed distances of single pairs
  int contact_queries = 0;   // mj_collision, for pairs with an SDF
};

// One per thread.
class Ccdg {
 public:
  // Poses and queries go through `finder`, with its mocap poses.
  Ccdg(const SceneTables& tables, ContactFinder& finder);

  // Each kept pair's signed distance must stay above the required one less the tolerance. The
  // result is valid until the next call.
  const CcdResult& Move(const CcdMotion& motion, const CcdOptions& options = {});

  ContactFinder& finder() { return finder_; }

 private:
  struct Interval {
    double t0 = 0.0, t1 = 1.0;
    bool end_asked = false;
  };
  // What is known of a pair along the present motion.
  struct PairState {
    double until = 0.0;  // its margin is proven (sampled: taken) to be above `floor` on [0, until]
    double meet = 0.0;   // a pose up to here is expected to prove the pair back to `until`
    double seen = 0.0;   // the last pose at which it was looked at and above its floor
    double bad = -1.0;   // sampled: the first pose at which it was below, if later than `seen`
    double floor = 0.0;  // the least margin that it must keep [m]
    double advance = 0.0;  // a proven step shorter than advance/λ counts as contact [m]
  };
  // Of two bodies: the least `until` and `meet` of their pairs, or what their bounding spheres
  // prove.
  struct BodiesState {
    double until = 0.0, meet = 0.0;
    double required = 0.0;  // the largest required distance of their pairs [m]
  };
  // A proof around the end of an interval that has not met the one from the start yet.
  struct ProvenAhead {
    int pair = 0;
    double at = 0.0, from = 0.0, until = 0.0;
  };

  void Start(const CcdMotion& motion, const CcdOptions& options);
  bool Spent() const;
  double NextPose(const Interval& interval) const;
  void Split(double at);
  void Pop();
  void Ask(double t);
  void AskBodies(int body_pair, double& next);
  void AskPair(int body_pair, int pair, double next);
  void Sample(int pair, double lambda);
  double SampledMargin(int pair);
  bool Admit(int pair, double margin);
  void Extend(int pair, double length, double meeting);
  void Stop(int pair, double t);
  bool Stopped();
  void Contradict(int pair);
  const CcdResult& Finish(CcdOutcome outcome, double t);

  const SceneTables& tables_;
  ContactFinder& finder_;
  PairProof proof_;

  CcdOptions options_;
  double end_ = 1.0;                 // where joint limits end the motion
  double t_ = 0.0;                   // where the finder is posed
  double front_ = 0.0, meet_ = 0.0;  // the least `until` and `meet` of all pairs
  int critical_ = -1;                // the body pair with the least `until`; -1: not known yet
  std::vector<Interval> intervals_;  // a stack, the earliest on top
  std::vector<ProvenAhead> ahead_;   // a stack, ordered by `at`, the earliest on top
  std::vector<PairState> pairs_;
  std::vector<BodiesState> bodies_;
  std::vector<int> asked_;                           // body pairs asked at this pose
  const std::vector<NearPair>* contacts_ = nullptr;  // of pairs with an SDF at this pose, if known
  CcdResult result_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_CCD_CCDG_H_
