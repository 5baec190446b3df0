// The part of Viewer that follows a script.
#include <algorithm>
#include <utility>

#include "apps/view/viewer.h"

namespace mjcf_pdg::app {

using Kind = ScriptEvent::Kind;

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
