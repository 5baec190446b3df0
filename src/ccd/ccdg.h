// Certified continuous collision detection along a configuration line: the CCD of the paper's
// Alg. 2.
//
// Source: Tang & Kim, Sec. 5.2, Eq. 21: the largest τ with q0 ⊕ τ·dq free, all joints at once.
// Differs from it:
//   1. Certified: a step is taken only where a motion bound proves that no kept pair comes nearer
//      than its floor (motion_bound.h, separation.h). Early, never late.
//   2. Conservative advancement instead of bisection: one pose serves every pair, each pair is
//      looked at again only when its own proof has run out.
//   3. Stops a little before touching, so that contact normals exist where it ends.
//   4. An exact mesh is further away than its convex hull: proofs of separation, which are of
//      hulls, hold for it, and where the hulls overlap the distance of the triangles alone counts.
//   5. A pair that starts inside the contact band (gliding) does not stop everything: it may go on
//      as long as it is proven to keep half of its margin, or -tolerance where it has none.
#ifndef MJCF_PDG_SRC_CCD_CCDG_H_
#define MJCF_PDG_SRC_CCD_CCDG_H_

#include <vector>

#include "ccd/motion_bound.h"
#include "ccd/separation.h"
#include "collide/contacts.h"

namespace mjcf_pdg {

struct CcdOptions {
  double tolerance = 1e-6;    // overlap beyond the required distance that is still free [m], > 0
  double gap = 4e-6;          // contact band: pairs stop between gap/2 and gap of it [m], > 0
  double sample_step = 1e-3;  // SDF and height field pairs are only looked at this often [m]
  int max_poses = 1000;       // budget of one motion
};

enum class CcdOutcome {
  kFree,              // nothing in the way up to t = 1
  kContact,           // `pairs` are in the way at t
  kStartInCollision,  // `pairs` overlap already; t = 0
  kLimit,             // `joint` reaches its limit at t
  kBudget,            // max_poses used up at t
};

struct CcdResult {
  CcdOutcome outcome = CcdOutcome::kFree;
  double t = 0.0;            // [0, t] is free
  bool certified = true;     // ... proven; false where contact-only pairs were sampled
  std::vector<int> pairs;    // indices into SceneTables::pairs
  int joint = -1;            // index into SceneTables::joints
  VectorXd q;                // q0 ⊕ t·dq
  int poses = 0;             // kinematics of the whole model
  int distance_queries = 0;  // signed distances of single pairs
  int contact_queries = 0;   // mj_collision, for contact-only pairs
};

// The largest s in [0, 1] so that q0 ⊕ s·dq keeps all joint limits (within 1e-9); `joint` is then
// the index of the one that ends it, -1 if none. Only balls can leave a limit between two
// configurations that keep it.
double LimitReach(const SceneTables& tables, const VectorXd& q0, const VectorXd& dq, int& joint);

// One per thread. Pairs that the motion does not move are not looked at.
class Ccdg {
 public:
  // Poses and queries go through `finder`, with its mocap poses.
  Ccdg(const SceneTables& tables, ContactFinder& finder);

  // Moves from q0 along dq. Each kept pair's signed distance must stay above required[pair] -
  // tolerance; `required` (one entry per kept pair, [m]) null: -KeptPair::allowed for each.
  // The result is valid until the next call.
  const CcdResult& Move(const VectorXd& q0, const VectorXd& dq, const CcdOptions& options = {},
                        const VectorXd* required = nullptr);

  ContactFinder& finder() { return finder_; }

 private:
  // What is known of a pair along the present motion.
  struct PairState {
    double safe = 0.0;     // proven (or, contact-only: believed) above its floor up to this t
    double floor = 0.0;    // above the required distance [m]
    double advance = 0.0;  // a proven step shorter than advance/λ counts as contact [m]
    double bad = 2.0;      // contact-only: a t where it was found below its floor; > 1 if none
  };
  // Margin: signed distance less what is required.
  struct Margin {
    double value = 0.0;  // [m]; at least this if !exact
    bool exact = false;
    Vector3d n_W;
  };

  void Start(const VectorXd& q0, const VectorXd& dq, const CcdOptions& options,
             const VectorXd* required);
  void PoseAt(double t);
  double Sweep();
  void RefreshBodies(int body_pair, double& next);
  void RefreshPair(int body_pair, int pair, double next);
  void RefreshContactOnly(int pair, double closing);
  Margin MarginOf(int pair, double enough);
  double ContactOnlyMargin(int pair);
  bool Admit(int pair, double margin);
  double ProvenStep(int body_pair, int pair, const Margin& margin, double& closing);
  const CcdResult& Finish(CcdOutcome outcome, double t);

  double Required(int pair) const {
    return required_ ? (*required_)[pair] : -tables_.pairs[pair].allowed;
  }

  const SceneTables& tables_;
  ContactFinder& finder_;
  MotionBound motion_;
  Separation separation_;

  CcdOptions options_;
  const VectorXd* required_ = nullptr;
  VectorXd q0_, dq_, step_;
  double end_ = 1.0;        // where the limits end the line
  double t_ = 0.0;          // of the pose
  double free_t_ = 0.0;     // [0, free_t_] is free
  bool first_ = true;       // the pose is the start: every moving pair is looked at
  bool colliding_ = false;  // some pair overlaps at the start
  bool rejected_ = false;   // a pair is below its floor at t_: [0, t_] is not free
  bool retry_ = false;      // ... and an earlier t is worth a look
  const std::vector<NearPair>* contacts_ = nullptr;  // of contact-only pairs at this pose, if known
  std::vector<PairState> states_;
  std::vector<double> bodies_safe_;
  std::vector<double> bodies_required_;  // the largest of the body pair's [m]
  std::vector<int> moving_;              // body pairs
  int critical_ = -1;                    // the body pair that ended the last step; -1: none
  CcdResult result_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_CCD_CCDG_H_
