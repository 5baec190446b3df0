// A command that is moved by hand and its repair, which follows it tick by tick: what the window
// shows, without any window.
#ifndef MJCF_PDG_APPS_VIEW_REPAIR_SESSION_H_
#define MJCF_PDG_APPS_VIEW_REPAIR_SESSION_H_

#include <mujoco/mujoco.h>

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "apps/input/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

class RepairSession {
 public:
  // Keeps a reference to the scene. `options` are those of the solves; contacts and the lower bound
  // are reported in any case. Throws Error as Tracker does.
  RepairSession(const Scene& scene, const Options& options, const Configuration& start);

  // Another configuration, which has nothing to do with the last one: the next tick solves anew.
  void Jump(const Configuration& row);
  // Another configuration (nq values) that the repair follows. Its size is not checked.
  void SetCommand(std::span<const double> q);
  // The same with the mocap poses of `data`, which belongs to the scene's model.
  void SetCommand(const mjData& data);
  // The next row, which the repair follows.
  void Follow(const Configuration& row);

  // Repairs the command of now. Throws Error where the command is bad.
  void Tick();

  const std::vector<double>& command() const { return row_.q; }
  // The command with its mocap poses, under the name of the row that it began as.
  const Configuration& row() const { return row_; }
  // The same, but the configuration that it began as: what a keyframe's controls belong to.
  Configuration Origin() const;
  // Of the last tick. Before the first one, and after Jump until the next: null.
  const Result* result() const { return known_ ? &result_ : nullptr; }
  // How many ticks ago the command changed last.
  int ticks_at_rest() const { return at_rest_; }

  // The time of the last 120 ticks [s], without those that solved anew. 0 if there is none.
  double MedianSeconds() const;
  double LongestSeconds() const;

 private:
  void SetObstacles(const double* mocap_pos, const double* mocap_quat);

  static constexpr std::size_t kTimes = 120;  // two seconds of frames
  struct Deleter {
    void operator()(mjData* data) const { mj_deleteData(data); }
  };

  const Scene& scene_;
  TrackOptions options_;
  std::unique_ptr<mjData, Deleter> data_;  // obstacles, as the Tracker takes them
  std::unique_ptr<Tracker> tracker_;       // null: the next tick solves anew
  Configuration row_;
  std::vector<double> q_begin_;  // of the row, before the hand moved it
  Result result_;
  bool known_ = false;
  int at_rest_ = 0;
  std::array<double, kTimes> times_ = {};
  std::size_t num_times_ = 0;  // all that there were
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEW_REPAIR_SESSION_H_
