// Tracker: the nearest free configuration of one command after another, for control loops.
//
//   mjcf_pdg::Tracker tracker(scene);
//   while (running) tracker.Step(data, q_command, result);   // result.q goes to the servo
//
// Source: Tang & Kim, Sec. 5.1 (motion coherence).
// Differs from it: the last answer is not one start among others. Its optimum is followed, one step
// of local optimization a tick, as in real-time iteration schemes of model predictive control; and
// the search for a better one goes on beside it, from tick to tick.
#ifndef MJCF_PDG_TRACKER_H_
#define MJCF_PDG_TRACKER_H_

#include <limits>
#include <memory>
#include <span>

#include "mjcf_pdg/export.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

struct mjData_;
typedef struct mjData_ mjData;

namespace mjcf_pdg {

struct TrackOptions {
  // Of these, tolerance, clearance, rest, metric, seed, mocap poses and what is reported count in
  // every tick, all of them in the first.
  Options options = {};
  int queries = 12;  // most collision queries of a tick, as Stats::collision_queries counts; >= 6
  // Another optimum is taken if its √σ is smaller by this share, in [0, 1).
  double switch_gain = 0.05;
  // No joint moves farther in a tick [rad or m], > 0. A free joint's translation and rotation, and
  // a ball's rotation, count by their length. An optimum that lies farther away is gone to
  // straight, along what is in the way, or by a way round it that is sought in what ticks have left
  // of their queries; until there is one that pays, the answer follows the optimum on its own side.
  double max_step = std::numeric_limits<double>::infinity();
  // The straight motion from each answer to the next is proven free (mjcf_pdg/motion.h) and cut
  // short where it is not.
  bool certify_motion = false;
  // Result::sigma_lower_bound is computed in every tick whose command is not free, which takes a
  // query more. If this is false, only the first tick has it.
  bool lower_bound = false;
};

// One per thread. It never writes to the user's model or data.
class MJCF_PDG_API Tracker {
 public:
  // Throws Error as Solver does, for options of method paper, and for a TrackOptions value that is
  // out of range.
  explicit Tracker(const Scene& scene, const TrackOptions& options = {});
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  // Writes to `result` a free configuration near q_command (nq entries) and returns its status:
  // kAlreadyFree if it is q_command itself, kSolved if it is another one, which includes a free
  // command that max_step or certify_motion does not let it reach yet. If the last answer is still
  // free, so is this one. If it is not (obstacles move) and nothing free is found within the
  // budget, the status is kUnsolved, and overlaps of convex geoms may be told as deeper than they
  // are: to measure them takes longer than the rest of a tick. Result::sigma is from q_command. The
  // first step, unless Reset came before, solves as Solver does, without the tick's budget. Throws
  // Error for a bad q_command.
  Status Step(std::span<const double> q_command, Result& result);
  // The same with mocap poses, active equality constraints and frozen joints as in `data`, which is
  // only read. Also throws Error if `data` is null.
  Status Step(const mjData* data, std::span<const double> q_command, Result& result);

  // Says where the follower stands now (nq entries): the next answer is sought from there. Throws
  // Error for a bad q.
  void Reset(std::span<const double> q);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_TRACKER_H_
