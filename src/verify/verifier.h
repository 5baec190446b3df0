// The verifier: decides, independently of the solver, whether a configuration is free.
//
// It shares no code with the solver's queries: pairs, poses, shapes, normals, constants and
// algorithms are its own. For a pair of convex geoms a certificate (certificate.h) proves the
// answer: a plane that separates them, or points that show that they overlap by more than is
// permitted. For a pair in which a mesh collides as its triangles, FCL is asked (exact_pair.h).
//
// terrain_pair.h does the same for height fields, prism by prism.
//
// Of a pair with an SDF nothing is proven: it counts as free if neither mj_collision finds a
// contact nor the geoms' own functions, sampled (sdf_pair.h), show an overlap. mj_collision alone
// decides about contacts between geoms that the verifier's own table of pairs lacks. Elsewhere its
// contacts are only compared with the certificates (see disputed_by_contacts). It runs on a private
// copy of the mjModel struct without margins and gaps, because a negative margin hides contacts and
// a positive one falsifies their distances.
#ifndef MJCF_PDG_SRC_VERIFY_VERIFIER_H_
#define MJCF_PDG_SRC_VERIFY_VERIFIER_H_

#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "verify/convex/certificate.h"
#include "verify/exact_pair.h"
#include "verify/findings.h"
#include "verify/posed_pair.h"
#include "verify/sweep.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg {

// One per thread. Neither copyable nor movable: MuJoCo's data points into it.
class Verifier {
 public:
  // Takes tolerance, clearance and rest from `options`, but not its mocap poses: see SetMocap.
  // Check measures distances up to the clearance plus `range` [m]. Throws Error if MuJoCo cannot
  // allocate its data.
  Verifier(std::shared_ptr<const VerifierModel> model, const Options& options, double range = 1.0);
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  // Sets the poses of all mocap bodies: `pos` has 3 values [m] and `quat` 4 values (w, x, y, z) per
  // mocap body, in order of mocap id. An empty span leaves that part as in the model.
  void SetMocap(std::span<const double> pos, std::span<const double> quat);

  // Sets which equality constraints are active, an entry for each of the model (mjData::eq_active);
  // empty: as in the model.
  void SetActive(std::span<const mjtBool> active);

  // What IsFree asks about: pairs of which one geom at least belongs to a body with an entry in
  // `bodies` (nbody), the limits of these bodies' joints, and the equality constraints and tendon
  // limits with an entry in `equalities` and `tendons` (an entry for each of the model). Empty:
  // everything.
  struct Scope {
    std::span<const char> bodies, equalities, tendons;
  };
  // The arrays must live until the next SetScope.
  void SetScope(const Scope& scope);

  // True if q is free: the same answer as Check gives, without distances and words. `q` and `q_in`
  // are those of Check. After the first call it allocates nothing, unless meshes collide as their
  // triangles.
  bool IsFree(std::span<const double> q, std::span<const double> q_in = {});

  // Returns the whole verdict on q, valid until the next call. `q_in` is the configuration whose
  // contacts may keep their depths (Options::rest); if it is empty, none may. Both have nq entries.
  // With Depths::kSkipped, contacts and min_distance say of an exact pair only whether it overlaps;
  // with that or Depths::kRough, the depth of a convex pair may come out too large. A q that is free, with no more contacts
  // than in earlier calls, costs no allocation unless meshes collide as their triangles.
  const Verdict& Check(std::span<const double> q, std::span<const double> q_in = {},
                       verify::Depths depths = verify::Depths::kMeasured,
                       verify::Words words = verify::Words::kWritten);

  // Why q of the last Check is not free, by code. All are false if it is free.
  struct Violations {
    bool not_a_number = false;  // q or q_in has an entry that is infinite or not a number
    bool separable = false;     // a pair that a movable joint can separate is too near
    bool frozen = false;        // a pair that no movable joint can separate is too near
    bool limits = false;        // a joint is outside its range
    bool equalities = false;    // an equality constraint or a tendon limit does not hold
    bool uncertified = false;   // no certificate was found for some pair, either way
    bool arena_full = false;    // MuJoCo dropped contacts for want of memory
  };
  const Violations& violations() const { return violations_; }
  const Verdict& verdict() const { return verdict_; }  // of the last Check
  // True if MuJoCo reports a contact of two convex geoms that is deeper than permitted. At a q that
  // is free it contradicts a certificate. Refers to the last Check, or to the last IsFree if that
  // returned true.
  bool disputed_by_contacts() const { return disputed_; }
  // What Verdict::certified says of every configuration: no pair has an SDF.
  bool certified() const { return verdict_.certified; }

  // How many configurations were posed so far, a q_in whose contacts rest included.
  std::int64_t queries() const { return queries_; }

  // The certificate that decides the pair of two convex geoms at the configuration of the last
  // call, computed anew. It is in world axes, and its geom 1 is the geom of lower type (of equal
  // types: of lower id). The pair must have signed distances and must not be exact. Throws Error if
  // the two geoms are no kept pair.
  verify::Certificate CertificateOf(int geom1, int geom2) const;

  // Whether two geoms are nearer than `distance` [m] at the configuration of the last call; false
  // if they are no kept pair. Of geoms without signed distances a contact tells.
  bool Within(int geom1, int geom2, double distance) const;

  // The signed distance [m], negative, that two geoms may keep because they rest on each other in
  // q_in of the last call; 0 if they do not rest or are no kept pair.
  double DepthAtRest(int geom1, int geom2) const;

 private:
  void NeutraliseMargins();
  bool InScope(int geom1, int geom2) const {
    return scope_.bodies.empty() || scope_.bodies[model_.geom_bodyid[geom1]] ||
           scope_.bodies[model_.geom_bodyid[geom2]];
  }
  // Index in shared_->pairs; -1: no kept pair. `guess` and what follows it are looked at first.
  int PairIndex(int geom1, int geom2, int guess = -1) const;
  double Usual(const verify::CheckedPair& pair) const;
  void UpdateRest(std::span<const double> q_in);
  bool SetRest(std::span<const double> q, std::span<const double> q_in);
  void Pose(std::span<const double> q);
  void AskCollision();

  verify::PosedPair Posed(int pair) const { return {*shared_, *data_, shared_->pairs[pair]}; }
  verify::Reading AskExact(int pair, double cutoff, verify::Depths depths) const;
  verify::Reading Read(int pair, double cutoff, verify::Depths depths) const;
  verify::Proof Judge(int pair) const;
  bool KeepsApart(int pair);

  void CheckPairs(verify::Depths depths);
  void CheckContacts();
  void CheckFields();
  void Report(int pair, const verify::Reading& reading, verify::Proof proof);
  void FillViolations();
  void FindDisputes();

  const std::shared_ptr<const VerifierModel> shared_;
  const double tolerance_, clearance_, reach_, rest_, range_;  // [m]; reach_: the largest required
  std::vector<mjtNum> geom_margin_, body_margin_, pair_margin_, no_gap_;
  mjModel model_;  // copy of shared_->unblinded whose margins and gaps are the arrays above
  struct DataDeleter {
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  std::unique_ptr<mjData, DataDeleter> data_;
  const verify::ExactPairs exact_;
  verify::Sweep sweep_;

  // One entry per pair of shared_->pairs:
  std::vector<double> required_;        // least signed distance, rest considered [m]
  std::vector<Eigen::Vector3d> plane_;  // normal of the last plane, frame of geom 1; 0: none
  std::vector<int> box_axis_;           // along which its boxes were last widest apart
  std::vector<int> contact_;            // index of MuJoCo's deepest contact; -1: none
  std::vector<int> touching_;           // the pairs that have one, ascending

  // The pair by which the last IsFree that was false was so; the next one asks it first. -1: none.
  int too_near_ = -1;
  std::vector<double> rest_q_in_;              // the q_in that required_ refers to; empty: none
  std::vector<std::pair<double, int>> order_;  // scratch: (bound of the distance [m], pair)
  std::vector<char> active_;                   // by equality constraint: held, and active
  std::vector<char> active_in_scope_, tendons_in_scope_;
  Scope scope_;
  std::vector<int> contacts_of_other_pairs_;  // indices of MuJoCo's contacts between other geoms
  verify::Findings findings_;
  Violations violations_;
  bool disputed_ = false;
  std::int64_t queries_ = 0;
  Verdict verdict_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_VERIFY_VERIFIER_H_
