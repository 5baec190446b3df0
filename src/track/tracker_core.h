// All that a Tracker is made of, and the path of a tick: is the command free, follow, look
// elsewhere, approach, answer. Tracker (mjcf_pdg/tracker.h) checks its arguments and calls this;
// FrameSolver (frame_solver.h) does so for the frames of a motion.
#ifndef MJCF_PDG_SRC_TRACK_TRACKER_CORE_H_
#define MJCF_PDG_SRC_TRACK_TRACKER_CORE_H_

#include <mujoco/mujoco.h>

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "base/tuning.h"
#include "mjcf_pdg/tracker.h"
#include "solve/solver_core.h"
#include "track/approach.h"
#include "track/detour.h"
#include "track/elsewhere.h"
#include "track/follower.h"

namespace mjcf_pdg {

// How much a tick may do.
struct Pace {
  FollowPace follow = {};
  bool searches = true;  // for another optimum, beside
  bool bounds = false;   // computes Result::sigma_lower_bound
  // Of what is unsolved. To measure depths takes several times as long as the rest of a tick.
  verify::Depths depths = verify::Depths::kRough;
};

// `optimum` is the local optimum that is followed; `at` is where the follower stands. They differ
// only on the way from one optimum to another, or to a command, that max_step or certify_motion
// makes longer than a tick.
struct TrackerCore {
  TrackerCore(const Scene& scene, const TrackOptions& o, const Pace& p = {});

  Status Step(std::span<const double> q_command, Result& result);
  void SetObstacles(const mjData& data);
  void SetMocap(const MocapPoses& poses);
  void Reset(std::span<const double> q);
  // The command, with frozen joints as in `data`.
  std::span<const double> WithFrozenOf(const mjData& data, std::span<const double> q_command);

  bool Limited() const {
    return options.certify_motion || options.max_step < std::numeric_limits<double>::infinity();
  }
  // What a tick may move an answer that stands [√σ, m].
  double Noise() const { return tuning::track::kNoise * work.problem().size; }
  // Queries that this tick may still make.
  std::int64_t Left() const {
    return work.budget.Left(work.finder.queries()) + tuning::track::kReserve;
  }
  // How often obstacles have moved until now.
  int Obstacles() const { return moves + obstacles_moved; }
  std::int64_t LcpSteps() const {
    return core.LcpSteps() + follower.lcp_steps() + elsewhere.lcp_steps();
  }
  bool Free(const VectorXd& q);
  bool Ask(const VectorXd& q);
  void Solve(Result& result);
  void First(Result& result);
  void Tick(BudgetMeter::Clock::time_point begin, Result& result);
  void Answer(Result& result);
  void Bound(Result& result);
  void Begin();
  bool Follow();
  int SearchQueries(double sigma);
  void TrySwitch();
  bool Evaded();
  bool Approached(bool command_free);
  void GoOn();
  void SeekWay();
  bool GoAlong();
  void GoBeside();
  bool GoTowards(const VectorXd& target);
  bool SlideTowards(const VectorXd& target);
  const VectorXd* Rest() const { return options.options.rest > 0.0 ? &at_rest : nullptr; }
  void FallBack(Result& result);
  void Flee(Result& result);
  void Stand(const VectorXd& q, Result& result);

  const TrackOptions options;
  const Pace pace;
  SolverCore core;  // solves in the first tick, and where nothing that is followed is free
  Workspace& work;
  Follower follower;
  Elsewhere elsewhere;
  Approach approach;
  // Where steps are limited: what stands on its own side while a way to `optimum` is sought.
  std::unique_ptr<Follower> own_side;
  std::unique_ptr<Detour> detour;

  bool started = false, obstacles_moved = false, switched = false;
  bool on_command = false;  // the follower stands on the command
  bool fleeing = false;     // `optimum` is free, `at` is not, and max_step lies between
  bool advanced = false;    // this tick led towards `optimum`, not beside
  bool away = false;        // the last answer was not there
  bool lags = false;        // this tick led to an optimum on its own side, but not all the way
  bool lost = false;        // nothing free is known, and this tick begins with a solve
  int moves = 0;            // how often obstacles had moved before this tick
  int iterations = 0;       // of this tick
  double search_due = 0.0;  // queries for another optimum that ticks have left over
  double last_sigma = 0.0;  // of the optimum when that was last sought [m²]
  int blocked = 0;  // ticks for which no other optimum is sought, since the way to one was blocked
  Component start = Component::kNone;
  double moved = 0.0;  // how far the command has moved since the last tick [√σ, m]
  std::vector<double> q_in, asked, merged;
  VectorXd command, last_command, optimum, at, last_at, candidate, at_rest;
  VectorXd stood, evaded;   // where it stood before this tick, and before it went on
  bool going = false;       // it is on its way there by the detour
  int unslid = 0;           // ticks in which it does not try again to slide there
  double side_reach = 0.0;  // of the descent beside [√σ, m]
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_TRACKER_CORE_H_
