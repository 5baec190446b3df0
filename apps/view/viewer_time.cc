// The part of Viewer that goes on from frame to frame: what plays, the search, scripts.
#include <algorithm>
#include <array>
#include <utility>

#include "apps/view/viewer.h"

namespace mjcf_pdg::app {
namespace {

using Kind = ScriptEvent::Kind;

// A command that stays is ticked so often: two seconds, in which the search for a nearer answer
// goes on beside it.
constexpr int kTicksAtRest = 120;

std::vector<int> GuiltyGeoms(const Result* result) {
  std::vector<int> geoms;
  if (!result) return geoms;
  for (const Contact& contact : result->contacts_in) {
    geoms.insert(geoms.end(), contact.geom.begin(), contact.geom.end());
  }
  return geoms;
}

}  // namespace

void Viewer::Solve() {
  if (search_.running()) return;
  search_.Begin(session_.row());
  Say("solving ...");
}

void Viewer::FinishSearch() {
  Try([&] {
    record_ = search_.Take();
    ShowStep(record_->steps.size() - 1);
    running_ = false;
    Say(std::to_string(record_->steps.size() - 1) + " iterations, " +
        std::to_string(record_->result.stats.collision_queries) + " queries");
  });
}

void Viewer::Play() {
  if (!running_) return;
  if (timeline_ == Timeline::kRows) {
    if (row_ + 1 < rows_.size()) {
      session_.Follow(rows_[++row_]);
    } else {
      running_ = false;
    }
  } else if (timeline_ == Timeline::kSearch) {
    if (step_ + 1 < record_->steps.size()) {
      ++step_;
    } else {
      running_ = false;
    }
  }
}

void Viewer::NextFrame() {
  if (scripted_) RunScript();
  if (search_.done()) FinishSearch();
  Play();
  const bool live = timeline_ == Timeline::kLive && (running_ || single_tick_);
  const bool changing = !session_.result() || session_.ticks_at_rest() < kTicksAtRest;
  single_tick_ = false;
  if (timeline_ != Timeline::kSearch && (live || timeline_ == Timeline::kRows || !result()) &&
      changing) {
    Try([&] {
      session_.Tick();
      if (services_.ticked) services_.ticked(session_.row(), *session_.result());
    });
  }
  ghost_.SetCommand(session_.row());
  ghost_.RemoveGhost();
  if (const std::vector<double>* q = ghost_q()) {
    const bool free = timeline_ == Timeline::kSearch ? record_->steps[step_].free
                                                     : result()->status != Status::kUnsolved;
    ghost_.SetGhost(*q, free);
  }
  ghost_.Update(GuiltyGeoms(result()), shown);
}

void Viewer::Run(std::vector<ScriptEvent> script) {
  for (const ScriptEvent& event : script) {
    if (event.kind == Kind::kRow) FindRow(event.text);
  }
  script_ = std::move(script);
  scripted_ = true;
}

std::size_t Viewer::FindRow(const std::string& label) const {
  const auto found = std::find_if(rows_.begin(), rows_.end(), [&label](const Configuration& row) {
    return row.label == label;
  });
  if (found == rows_.end()) throw Error("the script shows a row '" + label + "': there is none");
  return static_cast<std::size_t>(found - rows_.begin());
}

// Goes on until an event needs the frame.
void Viewer::RunScript() {
  for (; event_ < script_.size(); ++event_, frame_ = 0) {
    const ScriptEvent& event = script_[event_];
    if (frame_ == 0) Start(event);
    const int frames = event.kind == Kind::kScreenshot ? 1
                       : event.kind == Kind::kStep     ? 0
                                                       : event.frames;
    if (frame_ == frames) continue;
    ++frame_;
    if (event.kind == Kind::kDrag) {
      const double share = static_cast<double>(frame_) / frames;
      MoveBy({share * event.numbers[0], share * event.numbers[1], share * event.numbers[2]});
    }
    return;
  }
  ReleaseButton();
  done_ = true;
}

void Viewer::Start(const ScriptEvent& event) {
  switch (event.kind) {
    case Kind::kFrames:
      return;
    case Kind::kKey:
      return Press(event.key);
    case Kind::kRow:
      return ShowRow(FindRow(event.text));
    case Kind::kJoint:
      return SetJoint(event.id, event.numbers[0]);
    case Kind::kDrag: {
      ghost_.SetCommand(session_.row());
      ghost_.perturb.select = event.id;
      const double* const centre = ghost_.command().xipos + 3 * event.id;
      drag_.emplace(model(), ghost_.command(), event.id,
                    std::array{centre[0], centre[1], centre[2]});
      return;
    }
    case Kind::kCamera:
      ghost_.camera.type = mjCAMERA_FREE;
      ghost_.camera.azimuth = event.numbers[0];
      ghost_.camera.elevation = event.numbers[1];
      ghost_.camera.distance = event.numbers[2];
      return;
    case Kind::kSolve:
      Solve();
      return FinishSearch();
    case Kind::kStep:
      return ShowStep(event.frames < 0 ? record_ ? record_->steps.size() - 1 : 0
                                       : static_cast<std::size_t>(event.frames));
    case Kind::kScreenshot:
      screenshot_ = event.text;
      return;
  }
}

}  // namespace mjcf_pdg::app
