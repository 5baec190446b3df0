// The independent check of a configuration, reusable: all scratch is made once.
//
// Shares nothing with the solver: pairs, poses, shapes, normals, constants and algorithms are its
// own. Whether a pair of convex geoms is apart, or overlaps by no more than is permitted, is
// decided by certificates (certificate.h): a plane, or common points. Where a mesh collides as its
// triangles, FCL is asked (exact_pair.h).
//
// mj_collision is the first witness: alone where an SDF or a height field is involved, and for
// contacts of pairs that the table of pairs lacks. Elsewhere a certificate is worth more than its
// word, either way. It runs on a private copy of the model's struct without margins and gaps, so
// that a negative margin hides nothing and a positive one misplaces nothing.
#ifndef MJCF_PDG_SRC_VERIFY_VERIFIER_H_
#define MJCF_PDG_SRC_VERIFY_VERIFIER_H_

#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "verify/certificate.h"
#include "verify/exact_pair.h"
#include "verify/findings.h"
#include "verify/posed_pair.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg {

// One per thread. Neither copyable nor movable: MuJoCo's data points into it.
class Verifier {
 public:
  // Reads tolerance, clearance and rest of `options`; mocap poses come by SetMocap. Pairs that are
  // apart are measured up to `range` beyond the clearance [m].
  Verifier(std::shared_ptr<const VerifierModel> model, const Options& options, double range = 1.0);
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  // Empty: as in the model. Else 3 and 4 values per mocap body.
  void SetMocap(std::span<const double> pos, std::span<const double> quat);

  // Is q free? What Check says, and nothing else: no distances, no words. Allocates nothing once it
  // has run, but where meshes collide as their triangles.
  bool IsFree(std::span<const double> q, std::span<const double> q_in = {});

  // The whole verdict, ours until the next call. `q_in` is what `rest` refers to; empty: nothing
  // rests. Both have nq entries. With skipped depths, min_distance and contacts say of exact pairs
  // whether they overlap, no more. Allocates nothing for a q that is free and touches no more than
  // it did before.
  const Verdict& Check(std::span<const double> q, std::span<const double> q_in = {},
                       verify::Depths depths = verify::Depths::kMeasured,
                       verify::Words words = verify::Words::kWritten);

  // Why the last Check's q is not free, for code.
  struct Violations {
    bool not_a_number = false;
    bool separable = false;    // a pair that a movable joint lies between
    bool frozen = false;       // a pair that no movable joint can part
    bool limits = false;       // a joint is outside its range
    bool uncertified = false;  // a pair with neither a plane nor a common point
    bool arena_full = false;   // MuJoCo dropped contacts
  };
  const Violations& violations() const { return violations_; }
  const Verdict& verdict() const { return verdict_; }  // of the last Check
  // MuJoCo's contacts make more of a pair's overlap than the plane that decided the last Check, or
  // IsFree where that was true.
  bool disputed() const { return disputed_; }
  bool certified() const {
    return verdict_.certified;
  }  // what Verdict::certified says of every configuration

  std::int64_t queries() const { return queries_; }  // configurations asked about so far

  // What the last verdict on two geoms that have signed distances and are no exact pair rests on,
  // asked again: world axes, from the lower to the higher geom of the pair (by type, then by id).
  verify::Certificate CertificateOf(int geom1, int geom2) const;

  // Of two geoms that the last Check let keep their overlap, that overlap, negative [m]; 0 of
  // others.
  double DepthAtRest(int geom1, int geom2) const;

 private:
  void NeutraliseMargins();
  int PairIndex(int geom1, int geom2) const;  // -1 when there is none
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

  double ContactDistance(int pair) const;  // the deepest of MuJoCo's; infinite where there is none
  void CheckPairs(verify::Depths depths);
  void CheckContacts();
  void CheckLimits(std::span<const double> q);
  void Report(int pair, const verify::Reading& reading, verify::Proof proof);
  void FillViolations();
  void FindDisputes();

  const std::shared_ptr<const VerifierModel> shared_;
  const double tolerance_, clearance_, rest_, range_;
  std::vector<mjtNum> geom_margin_, body_margin_, pair_margin_, no_gap_;
  mjModel model_;  // the shared unblinded one with these margins
  struct DataDeleter {
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  std::unique_ptr<mjData, DataDeleter> data_;
  const verify::ExactPairs exact_;

  // Per pair of shared_->pairs:
  std::vector<double> required_;               // with rest [m]
  std::vector<Eigen::Vector3d> plane_;         // the last plane's normal, in the frame of geom 1
  std::vector<int> contact_;                   // the deepest of MuJoCo's contacts; -1: none
  std::vector<double> rest_q_in_;              // the q_in that required_ stands for
  std::vector<std::pair<double, int>> order_;  // (bound, pair)
  std::vector<int> contacts_of_other_pairs_;
  verify::Findings findings_;
  Violations violations_;
  bool disputed_ = false;
  std::int64_t queries_ = 0;
  Verdict verdict_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_VERIFY_VERIFIER_H_
