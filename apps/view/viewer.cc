#include "apps/view/viewer.h"

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <utility>

namespace mjcf_pdg::app {
namespace {

// As in simulate: a click of the wheel is a motion by this share of the window's height.
constexpr double kZoom = 0.02;
std::string FormatQpos(const std::vector<double>& q, bool all_digits) {
  std::string text = "\"";
  for (std::size_t k = 0; k < q.size(); ++k) {
    char number[40];
    std::snprintf(number, sizeof number, all_digits ? "%.17g" : "%g", q[k]);
    text += (k > 0 ? " " : "") + std::string(number);
  }
  return text + "\"";
}

}  // namespace

Viewer::Viewer(const Scene& scene, const Options& options, std::vector<Configuration> rows,
               ViewServices services)
    : scene_(scene),
      services_(std::move(services)),
      session_(scene, options, rows.at(0)),
      search_(scene, options),
      ghost_(*scene.model()),
      rows_(std::move(rows)) {}

// ---- Input ----

void Viewer::Press(const KeyPress& press) { Do(ActionOf(press)); }

void Viewer::Do(const KeyAction& act) {
  const auto toggle = [](mjtByte& flag) { flag = !flag; };
  const std::size_t index = static_cast<std::size_t>(act.index);
  switch (act.action) {
    case Action::kNone:
      return;
    case Action::kPlayPause:
      running_ = !running_;
      if (running_ && timeline_ == Timeline::kSearch && step_ + 1 == record_->steps.size()) {
        step_ = 0;
      }
      return;
    case Action::kStepBack:
      return Step(-1);
    case Action::kStepForward:
      return Step(1);
    case Action::kPreviousRow:
      return ShowRow(row_ > 0 ? row_ - 1 : 0);
    case Action::kNextRow:
      return ShowRow(std::min(row_ + 1, rows_.size() - 1));
    case Action::kReset:
      return ShowRow(row_);
    case Action::kSolve:
      return Solve();
    case Action::kFreeCamera:
      ghost_.camera.type = mjCAMERA_FREE;
      return;
    case Action::kNextCamera:
      return CycleCamera(1);
    case Action::kPreviousCamera:
      return CycleCamera(-1);
    case Action::kAlign:
      return mjv_defaultFreeCamera(&model(), &ghost_.camera);
    case Action::kSelectParent:
      if (ghost_.perturb.select > 0) {
        ghost_.perturb.select = model().body_parentid[ghost_.perturb.select];
        drag_.reset();
      }
      return;
    case Action::kToggleLeft:
      panels.left = !panels.left;
      return;
    case Action::kToggleRight:
      panels.right = !panels.right;
      return;
    case Action::kHelp:
      panels.help = !panels.help;
      return;
    case Action::kFullScreen:
      full_screen_ = true;
      return;
    case Action::kNextFrame:
      ghost_.option.frame = (ghost_.option.frame + 1) % mjNFRAME;
      return;
    case Action::kNextLabel:
      ghost_.option.label = (ghost_.option.label + 1) % mjNLABEL;
      return;
    case Action::kCopyQpos:
      return Copy(session_.command(), act.index == 1);
    case Action::kCopyRepaired:
      if (const std::vector<double>* q = ghost_q()) Copy(*q, act.index == 1);
      return;
    case Action::kPaste:
      paste_ = true;
      return;
    case Action::kSave:
      return Save();
    case Action::kScreenshot:
      screenshot_ = "screenshot.png";
      return;
    case Action::kQuit:
      done_ = true;
      return;
    case Action::kGeomGroup:
      return toggle(ghost_.option.geomgroup[index]);
    case Action::kSiteGroup:
      return toggle(ghost_.option.sitegroup[index]);
    case Action::kVisualFlag:
      return toggle(ghost_.option.flags[index]);
    case Action::kRenderFlag:
      return toggle(ghost_.scene.flags[index]);
  }
}

void Viewer::CycleCamera(int by) {
  const int count = static_cast<int>(model().ncam);
  if (count == 0) return;
  mjvCamera& camera = ghost_.camera;
  const int now = camera.type == mjCAMERA_FIXED ? camera.fixedcamid : (by > 0 ? -1 : count);
  camera.type = mjCAMERA_FIXED;
  camera.fixedcamid = (now + by + count) % count;
}

void Viewer::PressButton(const Held& held, double x, double y, double aspect, bool doubled) {
  mjvPerturb& perturb = ghost_.perturb;
  if (doubled) {
    drag_.reset();
    const DoubleClick click = DoubleClickOf(held);
    const std::optional<GhostScene::Hit> hit = ghost_.Pick(aspect, x / aspect, y);
    if (click == DoubleClick::kSelect) {
      perturb.select = hit ? hit->body : 0;
      if (!hit) return;
      double from_body[3];
      mju_sub3(from_body, hit->point_W.data(), ghost_.command().xpos + 3 * hit->body);
      mju_mulMatTVec3(perturb.localpos, ghost_.command().xmat + 9 * hit->body, from_body);
    } else if (hit && click != DoubleClick::kNone) {
      std::copy(hit->point_W.begin(), hit->point_W.end(), ghost_.camera.lookat);
      if (click == DoubleClick::kTrack && hit->body > 0) {
        ghost_.camera.type = mjCAMERA_TRACKING;
        ghost_.camera.trackbodyid = hit->body;
        ghost_.camera.fixedcamid = -1;
      }
    }
    return;
  }
  const int kind = DragOf(held);
  if (kind == 0 || perturb.select <= 0) return;
  mjv_initPerturb(&model(), &ghost_.command(), &ghost_.scene, &perturb);
  perturb.active = kind;
  grabbed_ = perturb;
  std::array<double, 3> point;
  mju_mulMatVec3(point.data(), ghost_.command().xmat + 9 * perturb.select, perturb.localpos);
  mju_addTo3(point.data(), ghost_.command().xpos + 3 * perturb.select);
  drag_.emplace(model(), ghost_.command(), perturb.select, point);
  if (!drag_->stuck()) return;
  const char* const name = mj_id2name(&model(), mjOBJ_BODY, perturb.select);
  Say("no joint moves the body " + std::string(name ? name : "that is selected"));
}

void Viewer::ReleaseButton() {
  drag_.reset();
  ghost_.perturb.active = 0;
}

void Viewer::MoveMouse(const Held& held, double dx, double dy) {
  const mjtMouse motion = MotionOf(held);
  if (motion == mjMOUSE_NONE) return;
  if (!drag_) return mjv_moveCamera(&model(), motion, dx, -dy, &ghost_.camera);
  mjvPerturb& perturb = ghost_.perturb;
  mjv_movePerturb(&model(), &ghost_.command(), motion, dx, -dy, &ghost_.scene, &perturb);
  if (perturb.active == mjPERT_TRANSLATE) {
    std::array<double, 3> translation;
    mju_sub3(translation.data(), perturb.refpos, grabbed_.refpos);
    return MoveBy(translation);
  }
  std::array<double, 4> back, rotation;
  mju_negQuat(back.data(), grabbed_.refquat);
  mju_mulQuat(rotation.data(), perturb.refquat, back.data());
  drag_->TurnTo(ghost_.command(), rotation);
  session_.SetCommand(ghost_.command());
  GoLive();
}

// The hand has moved something, which the ghost follows. What was paused stays so.
void Viewer::GoLive() {
  if (timeline_ != Timeline::kLive) running_ = true;
  timeline_ = Timeline::kLive;
}

void Viewer::MoveBy(const std::array<double, 3>& translation_W) {
  drag_->MoveTo(ghost_.command(), translation_W);
  session_.SetCommand(ghost_.command());
  GoLive();
}

void Viewer::Scroll(double clicks) {
  mjv_moveCamera(&model(), mjMOUSE_ZOOM, 0, -kZoom * clicks, &ghost_.camera);
}

void Viewer::SetJoint(int joint, double value) {
  std::vector<double> q = session_.command();
  q[static_cast<std::size_t>(model().jnt_qposadr[joint])] = value;
  session_.SetCommand(q);
  GoLive();
}

void Viewer::ShowRow(std::size_t row) {
  row_ = row;
  drag_.reset();
  session_.Jump(rows_[row]);
  if (timeline_ == Timeline::kSearch) GoLive();
}

void Viewer::ShowStep(std::size_t step) {
  if (!record_) return;
  if (session_.command() != record_->row.q) session_.Jump(record_->row);
  timeline_ = Timeline::kSearch;
  step_ = std::min(step, record_->steps.size() - 1);
}

void Viewer::PlayRows() {
  ShowRow(row_ + 1 < rows_.size() ? row_ : 0);
  timeline_ = Timeline::kRows;
  running_ = true;
}

// Stops what plays, as in simulate.
void Viewer::Step(int by) {
  running_ = false;
  if (timeline_ == Timeline::kSearch) {
    ShowStep(by < 0 && step_ == 0 ? 0 : step_ + static_cast<std::size_t>(by));
  } else if (timeline_ == Timeline::kRows) {
    Do({by < 0 ? Action::kPreviousRow : Action::kNextRow});
  } else if (by > 0) {
    single_tick_ = true;
  }
}

void Viewer::Open(const std::string& path) {
  Try([&] {
    rows_ = services_.load(path);
    ShowRow(0);
    Say(path + ": " + std::to_string(rows_.size()) + " rows");
  });
}

void Viewer::Save() {
  Try([&] {
    const Result* const found = result();
    if (!found) throw Error("nothing is repaired yet");
    if (found->status == Status::kUnsolved) throw Error("not saved: not free, " + found->reason);
    const std::string name = services_.save(save_path, session_.Origin(), *found);
    Say("keyframe " + name + " saved in " + save_path);
  });
}

void Viewer::LookAt(const double point_W[3]) {
  if (ghost_.camera.type == mjCAMERA_FIXED) mjv_defaultFreeCamera(&model(), &ghost_.camera);
  ghost_.camera.type = mjCAMERA_FREE;
  std::copy_n(point_W, 3, ghost_.camera.lookat);
}

void Viewer::Copy(const std::vector<double>& q, bool all_digits) {
  clipboard_ = "<key qpos=" + FormatQpos(q, all_digits) + "/>";
  Say("qpos is in the clipboard");
}

void Viewer::CopySolveCommand() {
  clipboard_ = solve_command + " --qpos " + FormatQpos(session_.command(), true);
  Say("the command line is in the clipboard");
}

void Viewer::Paste(const std::string& text) {
  Try([&] {
    std::string numbers = text;
    if (const std::size_t begin = text.find("qpos="); begin != std::string::npos) {
      const std::size_t first = begin + 6, last = text.find_first_of("\"'", first);
      if (last == std::string::npos) throw Error("the clipboard has no whole qpos=\"...\"");
      numbers = text.substr(first, last - first);
    }
    Configuration row;
    row.label = "pasted";
    row.q = ParseNumbers(OneLine(numbers), "the clipboard");
    scene_.CheckConfiguration(row.q);
    drag_.reset();
    session_.Jump(row);
    GoLive();
  });
}

const Result* Viewer::result() const {
  return timeline_ == Timeline::kSearch ? &record_->result : session_.result();
}

const std::vector<double>* Viewer::ghost_q() const {
  if (timeline_ == Timeline::kSearch) return &record_->steps[step_].q;
  return session_.result() ? &session_.result()->q : nullptr;
}

const mjModel& Viewer::model() const { return *scene_.model(); }
std::string Viewer::GeomName(int geom) const { return scene_.GeomName(geom); }
std::string Viewer::JointName(int joint) const { return scene_.JointName(joint); }

std::array<double, 2> Viewer::SliderRange(int joint) const {
  const mjModel& m = model();
  if (m.jnt_limited[joint]) return {m.jnt_range[2 * joint], m.jnt_range[2 * joint + 1]};
  const double half = m.jnt_type[joint] == mjJNT_HINGE ? std::numbers::pi : m.stat.extent;
  return {-half, half};
}

}  // namespace mjcf_pdg::app
