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
  row_ = row;
  tracker_.reset();
  known_ = false;
  at_rest_ = 0;
  const mjModel& m = *scene_.model();
  mj_resetData(&m, data_.get());
  std::copy(row_.mocap_pos.begin(), row_.mocap_pos.end(), data_->mocap_pos);
  std::copy(row_.mocap_quat.begin(), row_.mocap_quat.end(), data_->mocap_quat);
  row_.mocap_pos.assign(data_->mocap_pos, data_->mocap_pos + 3 * m.nmocap);
  row_.mocap_quat.assign(data_->mocap_quat, data_->mocap_quat + 4 * m.nmocap);
}

void RepairSession::SetCommand(std::span<const double> q) {
  if (std::equal(q.begin(), q.end(), row_.q.begin(), row_.q.end())) return;
  row_.q.assign(q.begin(), q.end());
  at_rest_ = 0;
}

void RepairSession::SetCommand(const mjData& data) {
  const mjModel& m = *scene_.model();
  SetCommand({data.qpos, static_cast<std::size_t>(m.nq)});
  const std::size_t n = static_cast<std::size_t>(m.nmocap);
  if (!std::equal(data.mocap_pos, data.mocap_pos + 3 * n, data_->mocap_pos) ||
      !std::equal(data.mocap_quat, data.mocap_quat + 4 * n, data_->mocap_quat)) {
    at_rest_ = 0;
  }
  std::copy_n(data.mocap_pos, 3 * n, data_->mocap_pos);
  std::copy_n(data.mocap_quat, 4 * n, data_->mocap_quat);
  row_.mocap_pos.assign(data.mocap_pos, data.mocap_pos + 3 * n);
  row_.mocap_quat.assign(data.mocap_quat, data.mocap_quat + 4 * n);
}

void RepairSession::Tick() {
  const bool anew = !tracker_;
  if (anew) tracker_ = std::make_unique<Tracker>(scene_, options_);
  std::copy(row_.q.begin(), row_.q.end(), data_->qpos);
  tracker_->Step(data_.get(), row_.q, result_);
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
