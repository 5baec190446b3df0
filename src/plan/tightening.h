// Retracts a path of smaller bodies (plan/shrunk_scenes.h) when they have grown: what planning by
// penetration depth can do that retraction along a contact cannot.
//
// Source: Saha, Latombe, Chang & Prinz, Finding narrow passages with probabilistic roadmaps: the
// small-step retraction method (Autonomous Robots, 2005).
// Differs from it:
//   1. The path is followed along the contacts (plan/retraction.h) as far as that stays near it.
//      Configurations that are retracted one by one come to lie on this side of a wall or that.
//   2. Elsewhere they are retracted by PDg, not by random samples nearby, and neighbours are joined
//      by searches between them. Those that come to lie far from where they were are left out.
//   3. From a configuration that is not reached the path is followed backwards as well: a hole is
//      easier to leave than to enter.
#ifndef MJCF_PDG_SRC_PLAN_TIGHTENING_H_
#define MJCF_PDG_SRC_PLAN_TIGHTENING_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "plan/body_travel.h"
#include "plan/retraction.h"
#include "plan/tree_search.h"

namespace mjcf_pdg {

class Tightening {
 public:
  // Of the scene into which paths are retracted. The planner must be one that retracts.
  explicit Tightening(const TreeSearchInput& input);

  // A path with the same ends, which must be free in the scene; empty if `samples` samples (of
  // the space) make none. Each of its motions is proven free.
  std::vector<VectorXd> Tighten(const std::vector<VectorXd>& wide, std::int64_t samples);

  SearchCost cost() const;

 private:
  std::vector<VectorXd> Densified(const std::vector<VectorXd>& path) const;
  bool Follow(const VectorXd& q, std::vector<VectorXd>& path);
  bool Free(VectorXd& q);
  bool Join(std::size_t k, const VectorXd& q, std::int64_t samples);

  const TreeSearchInput input_;
  TreeSearch search_;
  const std::unique_ptr<Retraction> along_contact_;
  BodyTravel travel_;
  Solver solver_;
  Result result_;
  std::vector<VectorXd> dense_;     // the wide path
  std::vector<VectorXd> path_;      // what has been found for its first configurations
  std::vector<std::size_t> nodes_;  // of path_, where it had come to when these were followed
  std::int64_t queries_ = 0;        // of solver_
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_TIGHTENING_H_
