// The public Tracker: arguments are checked here; the work is TrackerCore's.
#include "mjcf_pdg/tracker.h"

#include <string>

#include "base/tuning.h"
#include "solve/options.h"
#include "track/tracker_core.h"

namespace mjcf_pdg {
namespace {

namespace tune = tuning::track;

void CheckTrackOptions(const TrackOptions& options) {
  if (options.queries < tune::kFewestQueries) {
    throw Error("a tick needs at least " + std::to_string(tune::kFewestQueries) + " queries");
  }
  if (!(options.switch_gain >= 0.0 && options.switch_gain < 1.0)) {
    throw Error("switch_gain must lie between 0 and 1");
  }
  if (!(options.max_step > 0.0)) throw Error("max_step must be positive");
  if (options.options.method != Method::kAuto) throw Error("a Tracker follows by method auto only");
}

}  // namespace

struct MJCF_PDG_LOCAL Tracker::Impl : TrackerCore {
  using TrackerCore::TrackerCore;
};

Tracker::Tracker(const Scene& scene, const TrackOptions& options) {
  CheckMujocoVersion();
  CheckTrackOptions(options);
  impl_ = std::make_unique<Impl>(scene, options, Pace{.bounds = options.lower_bound});
}

Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

Status Tracker::Step(std::span<const double> q_command, Result& result) {
  impl_->core.CheckInput(q_command);
  return impl_->Step(q_command, result);
}

Status Tracker::Step(const mjData* data, std::span<const double> q_command, Result& result) {
  if (!data) throw Error("the data is null");
  impl_->core.CheckInput(q_command);
  impl_->core.CheckInput({data->qpos, q_command.size()});
  impl_->SetObstacles(*data);
  return impl_->Step(impl_->WithFrozenOf(*data, q_command), result);
}

void Tracker::Reset(std::span<const double> q) {
  impl_->core.CheckInput(q);
  impl_->Reset(q);
}

}  // namespace mjcf_pdg
