// The search over starts: local optimization from each selection until enough of them agree.
//
// The direct start, q_in itself, settles shallow problems alone. Deep ones are decided by which
// side of an obstacle, or which order of contacts, a start falls on, so varied starts follow:
// mirrored, normal noise in object-norm units, and hops that decide one contact of the best answer
// anew. No start is trusted; the best free answer wins. Agreement of several starts that know
// nothing of each other ends the search early, of fewer where the lower bound is not far; a budget
// of collision queries and of estimated time ends it late.
#ifndef MJCF_PDG_SRC_SEARCH_SEARCH_H_
#define MJCF_PDG_SRC_SEARCH_SEARCH_H_

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/random.h"
#include "optimize/local_optimization.h"
#include "paper/contact_space_iteration.h"
#include "paper/free_configuration.h"
#include "problem/problem.h"
#include "search/hull_start.h"
#include "start/pair_by_pair.h"
#include "start/selection.h"

namespace mjcf_pdg {

struct Candidate {
  VectorXd q;
  double sigma = 0.0;  // [m²]
  std::string start;   // selection it came from
};

struct SearchOutcome {
  std::vector<Candidate> free;  // best first
  LocalResult least_overlap;    // best configuration that is not free; q empty if none was needed
  std::string least_overlap_start;
  int starts = 0;
  int iterations = 0;
};

class Search {
 public:
  explicit Search(Problem& problem);

  // `overlaps`: overlapping pairs at q_in. `hint`: a configuration that may be free.
  SearchOutcome Run(const std::vector<NearPair>& overlaps,
                    const std::optional<FreeConfiguration>& hint);

  // Is the gain of Polish worth its time at this effort, after Run?
  bool WorthPolishing() const;
  // A last descent from a candidate to full precision.
  LocalResult Polish(const VectorXd& q);

  std::int64_t lcp_steps() const { return local_.lcp_steps(); }
  // Besides those of the problem's finder.
  std::int64_t hull_queries() const { return hulls_.queries(); }

 private:
  struct Plan;
  static Plan PlanFor(Effort effort);

  // False if it was given up because it led to nothing better.
  bool Try(const VectorXd& q, const std::string& start, const LocalOptions& options);
  void Count(const LocalResult& result, const std::string& start);
  void TryFreePose(const VectorXd& q_f, const std::string& start);
  void TryTranslations(const std::vector<NearPair>& overlaps);
  void TryFromWithin();
  void TryExact(const Plan& plan, const std::vector<NearPair>& overlaps);
  void TryRays(const std::vector<NearPair>& overlaps);
  bool Follows(const Plan& plan);
  void TryVaried(const Plan& plan);
  void TryOnRay(const VectorXd& q, const std::string& start);
  void TryNoise(double spread);
  void TryHop(Hop hop);
  void TryAnywhere(const Plan& plan);
  bool HasFree() const { return !outcome_.free.empty(); }
  double BestSigma() const;
  // Time since the first free answer, estimated from counts so that answers repeat [evaluations].
  double Evaluations() const;
  bool Done(const Plan& plan) const;
  // The best answer is farther than so many times depth_, or none is free.
  bool Exceeds(double depths) const { return BestSigma() > depths * depths * depth_ * depth_; }

  Problem& problem_;
  LocalOptimization local_;
  ContactSpaceIteration iteration_;
  HullStart hulls_;
  PairByPair parting_;
  StartSelection starts_;
  Random random_;
  SearchOutcome outcome_;
  int agreeing_ = 0;  // independent starts that ended at the best candidate, or at its door
  std::int64_t first_query_ = 0, first_box_test_ = 0;  // the finder's counts as the search begins
  // ... and as the first answer is free.
  std::int64_t free_query_ = 0, free_distance_ = 0, free_lcp_step_ = 0;
  VectorXd start_, far_;  // scratch
  VectorXd center_;       // q_in inside its limits
  bool exact_ = false;    // some exact mesh overlaps
  double depth_ = 0.0;    // that q_in must be parted by [m]
  // The last frame that was searched and solved.
  struct Searched {
    VectorXd q_in;
    MocapPoses mocap;
    double rms = 0.0;  // √σ of its answer [m]
  };
  std::optional<Searched> searched_;
  int frames_followed_ = 0;  // since then; of exact meshes only
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_SEARCH_H_
