// The independent check of a configuration, reusable: all scratch is made once.
//
// Shares no code with the solver's own queries: neither its prefilter, nor its capsule-box test,
// nor its reading of MuJoCo's contacts. Two witnesses are asked, and either one's "overlaps" is
// enough:
//   1. mj_collision on the scene's verify_model with every margin and gap set to zero, so that a
//      negative margin hides nothing and a positive one misplaces nothing;
//   2. the signed distance of every kept pair: mj_geomDistance, for capsule-box our own.
// Overlaps of ellipsoids and cylinders are checked along their own normal (verify_support.h).
// Where a mesh collides as its triangles, mj_collision sees hulls and is not heard; witness 2 asks
// FCL (verify_exact_mesh.h).
#ifndef MJCF_PDG_SRC_VERIFY_VERIFY_H_
#define MJCF_PDG_SRC_VERIFY_VERIFY_H_

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "model/scene_tables.h"
#include "verify/verify_exact_mesh.h"
#include "verify/verify_findings.h"

namespace mjcf_pdg {

// One per thread. Neither copyable nor movable: MuJoCo's data points into it.
class Verifier {
 public:
  // Reads tolerance, clearance and rest of `options`; mocap poses come by SetMocap.
  Verifier(const SceneTables& tables, const Options& options);
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  // Empty vectors: as in the model.
  void SetMocap(const MocapPoses& poses);

  // Is q free? `q_in` is what `rest` refers to; without it nothing rests. Both have nq entries.
  // With skipped depths, min_distance and contacts say of exact pairs whether they overlap, no
  // more. The verdict is ours until the next call.
  const Verdict& Check(const std::vector<double>& q, const std::vector<double>* q_in = nullptr,
                       Depths depths = Depths::kMeasured);

  const Verdict& verdict() const { return verdict_; }  // of the last Check
  bool IsFree(std::span<const double> q) {
    return Check({q.begin(), q.end()}, nullptr, Depths::kSkipped).free;
  }

  std::int64_t queries() const { return queries_; }  // configurations asked about so far

  // Of a pair that the last Check let keep its overlap, that overlap, negative [m]; 0 of others.
  double DepthAtRest(int pair) const;

 private:
  struct Reading {                 // per kept pair
    double signed_distance = 0.0;  // by witness 2; infinite when beyond the cutoff [m]
    double as_told = 0.0;          // the same before overlaps were checked along their normal [m]
    int contact = -1;              // index of the deepest mjContact; -1: none
    double fromto[6] = {};         // witness points of as_told
  };

  void NeutraliseMargins();
  void IndexPairs();
  int PairIndex(int geom1, int geom2) const;  // -1 when the pair is not kept
  void UpdateRest(const std::vector<double>& q_in);
  void Measure(const std::vector<double>& q, Depths depths);
  void AskCollision();
  void AskDistances(Depths depths);
  double SphereBound(const KeptPair& pair) const;
  double BoxBound(const KeptPair& pair) const;
  double SignedDistance(int pair, double cutoff, Depths depths, double fromto[6]);
  double Usual(const KeptPair& pair) const;  // distance that a pair must keep [m]
  double DistanceFromNudgedPose(const KeptPair& pair, double cutoff, double fromto[6]);
  double AlongNormal(const KeptPair& pair, const Reading& reading) const;
  void JudgePair(int pair);
  void JudgeContactsOfUnkeptPairs();
  void CheckLimits(const std::vector<double>& q);

  const SceneTables& tables_;
  const double tolerance_, clearance_, rest_;
  std::vector<mjtNum> geom_margin_, body_margin_, pair_margin_, no_gap_;
  mjModel model_;           // verify_model with these margins, no gaps
  mjModel distance_model_;  // the same with a finer convex solver, for mj_geomDistance
  PosedModel posed_;
  ExactVerifier exact_;

  std::vector<std::pair<std::uint64_t, int>> pair_index_;  // sorted by geoms
  std::vector<double> required_;                           // per kept pair, with rest [m]
  std::vector<double> rest_q_in_;                          // the q_in that required_ stands for
  std::vector<Reading> readings_;                          // per kept pair
  std::vector<std::pair<double, int>> order_;              // (bound, kept pair)
  std::vector<int> contacts_of_unkept_pairs_;
  std::vector<Finding> findings_;
  std::vector<std::string> limit_reasons_;
  bool arena_full_ = false;
  std::int64_t queries_ = 0;
  Verdict verdict_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_VERIFY_VERIFY_H_
