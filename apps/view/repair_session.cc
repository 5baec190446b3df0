#include "apps/view/repair_session.h"

#include <algorithm>
#include <stdexcept>

namespace mjcf_pdg::app {

RepairSession::RepairSession(const Scene& scene, const Options& options, const Configuration& start)
    : scene_(scene), data_(mj_makeData(scene.model())) {
  if (!data_) throw std::runtime_error("no memory for the data of the model");
  options_.options = options;
  options_.options.report_contacts = true;
  options_.lower_bound = true;
  Jump(start);
}

void RepairSession::Jump(const Configuration& row) {
  mj_resetData(scene_.model(), data_.get());
  Follow(row);
  tracker_.reset();
  known_ = false;
}

void RepairSession::Follow(const Configuration& row) {
  row_ = row;
  q_begin_ = row.q;
  at_rest_ = 0;
  const bool as_before = row.mocap_pos.empty();
  SetObstacles(as_before ? data_->mocap_pos : row.mocap_pos.data(),
               as_before ? data_->mocap_quat : row.mocap_quat.data());
}

void RepairSession::SetObstacles(const double* mocap_pos, const double* mocap_quat) {
  const std::size_t n = static_cast<std::size_t>(scene_.model()->nmocap);
  const bool moved = !std::equal(mocap_pos, mocap_pos + 3 * n, data_->mocap_pos) ||
                     !std::equal(mocap_quat, mocap_quat + 4 * n, data_->mocap_quat);
  if (moved) at_rest_ = 0;
  std::copy_n(mocap_pos, moved ? 3 * n : 0, data_->mocap_pos);
  std::copy_n(mocap_quat, moved ? 4 * n : 0, data_->mocap_quat);
  row_.mocap_pos.assign(data_->mocap_pos, data_->mocap_pos + 3 * n);
  row_.mocap_quat.assign(data_->mocap_quat, data_->mocap_quat + 4 * n);
}

Configuration RepairSession::Origin() const {
  Configuration origin = row_;
  origin.q = q_begin_;
  return origin;
}

void RepairSession::SetCommand(std::span<const double> q) {
  if (std::equal(q.begin(), q.end(), row_.q.begin(), row_.q.end())) return;
  row_.q.assign(q.begin(), q.end());
  at_rest_ = 0;
}

void RepairSession::SetCommand(const mjData& data) {
  SetCommand({data.qpos, static_cast<std::size_t>(scene_.nq())});
  SetObstacles(data.mocap_pos, data.mocap_quat);
}

void RepairSession::Tick() {
  const bool anew = !tracker_;
  // Of the same question all that was proven holds, and ticks do not all prove the same.
  const double proven = at_rest_ > 0 ? result_.sigma_lower_bound : 0.0;
  if (anew) tracker_ = std::make_unique<Tracker>(scene_, options_);
  std::copy(row_.q.begin(), row_.q.end(), data_->qpos);
  tracker_->Step(data_.get(), row_.q, result_);
  result_.sigma_lower_bound = std::max(proven, result_.sigma_lower_bound);
  known_ = true;
  ++at_rest_;
  if (!anew) times_[num_times_++ % kTimes] = result_.stats.seconds;
}

double RepairSession::MedianSeconds() const {
  std::array<double, kTimes> times = times_;
  const std::size_t count = std::min(num_times_, kTimes), middle = count / 2;
  if (count == 0) return 0.0;
  std::nth_element(times.begin(), times.begin() + middle, times.begin() + count);
  return times[middle];
}

double RepairSession::LongestSeconds() const {
  return *std::max_element(times_.begin(), times_.end());
}

}  // namespace mjcf_pdg::app
