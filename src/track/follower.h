// Follows one optimum of σ from tick to tick: one or two steps of local optimization from where it
// was, towards where the new command has moved it.
#ifndef MJCF_PDG_SRC_TRACK_FOLLOWER_H_
#define MJCF_PDG_SRC_TRACK_FOLLOWER_H_

#include "base/tuning.h"
#include "optimize/local_optimization.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

// How many steps a tick's descent from a free configuration makes, and how often it goes on by as
// many if it has found nothing nearer yet; how well a step keeps its promise that is the last.
struct FollowPace {
  int steps = tuning::track::kFollowSteps;
  int more = 0;
  double enough = tuning::track::kEnough;  // see LocalOptions
};

class Follower {
 public:
  Follower(Workspace& work, const FollowPace& pace)
      : work_(work),
        local_(work),
        pace_(pace),
        apart_(work.problem().tables, work.problem().options.metric) {
    // Takes the memory that it needs now, and not in the tick that first asks it.
    const mjModel& m = *work.problem().tables.model;
    const VectorXd q = Eigen::Map<const VectorXd>(m.qpos0, m.nq);
    apart_.SetReference(q);
    apart_.Sigma(q);
  }

  // Where a descent begins, and what is known there.
  struct Start {
    const VectorXd& q;   // nq
    bool free = false;   // the verifier has called it free
    int obstacles = 0;   // how often obstacles have moved until now
    double reach = 0.0;  // a free one moves no farther [√σ, m]; one that is not, as it must
  };
  // Descends at the workspace's problem. The result is valid until the next call; it is free, by
  // the solver's distances, if LocalResult::free.
  const LocalResult& Follow(const Start& start);
  // A configuration near `q` that keeps every required distance in full, where the verifier refuses
  // q; not free if there is none.
  const LocalResult& Retreat(const VectorXd& q);

  // √σ(from, to) [m].
  double Apart(const VectorXd& from, const VectorXd& to);
  // Whether that is more than `limit` [m].
  bool Farther(const VectorXd& from, const VectorXd& to, double limit);

  std::int64_t lcp_steps() const { return local_.lcp_steps(); }

 private:
  Workspace& work_;
  LocalOptimization local_;
  FollowPace pace_;
  bool resumable_ = false;  // the last descent was one of Follow's, made when
  int obstacles_ = 0;       // they had moved so often
  NormEvaluator apart_;
  VectorXd X_, r_;
  MatrixXd J_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_FOLLOWER_H_
