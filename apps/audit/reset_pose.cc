#include "apps/audit/reset_pose.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <utility>

#include "apps/audit/mjcf_text.h"
#include "apps/audit/same_model.h"

namespace mjcf_pdg::app {
namespace {

std::string Number(double x) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr};
}

std::string Numbers(const mjtNum* x, int n) {
  std::string text;
  for (int k = 0; k < n; ++k) text += (k > 0 ? " " : "") + Number(x[k]);
  return text;
}

void RemoveAttribute(const std::string& name, std::string& tag) {
  const std::optional<TextSpan> value = FindAttribute(tag, name);
  if (!value) return;
  const std::size_t written = tag.rfind(name, value->begin);
  const std::size_t begin = tag.find_last_not_of(" \t\r\n", written - 1) + 1;
  tag.erase(begin, value->end() + 1 - begin);
}

void SetAttribute(const std::string& name, const std::string& value, std::string& tag) {
  if (const std::optional<TextSpan> old = FindAttribute(tag, name)) {
    tag.replace(old->begin, old->length, value);
    return;
  }
  const std::size_t end = tag.find_last_not_of("/> \t\r\n") + 1;
  tag.insert(end, " " + name + "=\"" + value + "\"");
}

std::string BodyName(const mjModel& model, int body) {
  const char* name = mj_id2name(&model, mjOBJ_BODY, body);
  return name ? name : "";
}

bool Moves(const mjModel& model, const std::vector<double>& to, int joint) {
  const double* q = to.data() + model.jnt_qposadr[joint];
  return !std::equal(q, q + Width(model, joint), model.qpos0 + model.jnt_qposadr[joint]);
}

// Tags of a text. They are replaced from the last one on, so that the places of those before stay.
class TagEditor {
 public:
  explicit TagEditor(const std::string& text)
      : text_(text), bodies_(FindTags(text, "body")), joints_(FindTags(text, "joint")) {}

  // The opening tag of a body, by its place among those of the text; -1: nowhere. Bodies are
  // numbered as they stand in the text, unless some come from elsewhere: then names tell.
  int FindBody(const mjModel& model, int body) const {
    if (static_cast<int>(bodies_.size()) == model.nbody - 1) return body - 1;
    const std::string name = Escaped(BodyName(model, body));
    if (name.empty()) return -1;
    int found = -1;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const std::string tag = bodies_[k].Of(text_);
      const std::optional<TextSpan> value = FindAttribute(tag, "name");
      if (!value || value->Of(tag) != name) continue;
      if (found >= 0) return -1;
      found = static_cast<int>(k);
    }
    return found;
  }

  // The `index`-th <joint> between the body's tag and the next body's.
  std::optional<TextSpan> Joint(int body, int index) const {
    const auto k = static_cast<std::size_t>(body);
    const std::size_t end = k + 1 < bodies_.size() ? bodies_[k + 1].begin : text_.size();
    for (const TextSpan& joint : joints_) {
      if (joint.begin < bodies_[k].begin || joint.begin > end) continue;
      if (index-- == 0) return joint;
    }
    return std::nullopt;
  }

  TextSpan Body(int body) const { return bodies_[static_cast<std::size_t>(body)]; }
  std::string TextOf(const TextSpan& tag) const { return tag.Of(text_); }
  void Replace(const TextSpan& tag, std::string by) { changes_.emplace_back(tag, std::move(by)); }

  std::string Changed() {
    std::sort(changes_.begin(), changes_.end(),
              [](const auto& a, const auto& b) { return a.first.begin > b.first.begin; });
    std::string text = text_;
    for (const auto& [tag, by] : changes_) text.replace(tag.begin, tag.length, by);
    return text;
  }

 private:
  const std::string& text_;
  const std::vector<TextSpan> bodies_, joints_;
  std::vector<std::pair<TextSpan, std::string>> changes_;
};

// A body's tag with the pose, relative to its parent, that it has in `data`.
std::string WithPose(std::string tag, const mjModel& model, const mjData& data, int body) {
  const int parent = model.body_parentid[body];
  mjtNum inverse[4], difference[3], position[3], quaternion[4];
  mju_negQuat(inverse, data.xquat + 4 * parent);
  mju_sub3(difference, data.xpos + 3 * body, data.xpos + 3 * parent);
  mju_rotVecQuat(position, difference, inverse);
  mju_mulQuat(quaternion, inverse, data.xquat + 4 * body);
  for (const char* other : {"axisangle", "xyaxes", "zaxis", "euler"}) RemoveAttribute(other, tag);
  SetAttribute("pos", Numbers(position, 3), tag);
  SetAttribute("quat", Numbers(quaternion, 4), tag);
  return tag;
}

// An axis and a point of it, in the frame of the joint's body.
struct JointLine {
  std::array<mjtNum, 3> axis, position;
};

// x -> rotation x + translation
struct Motion {
  std::array<mjtNum, 4> rotation = {1, 0, 0, 0};
  std::array<mjtNum, 3> translation = {0, 0, 0};

  std::array<mjtNum, 3> Turned(const mjtNum* vector) const {
    std::array<mjtNum, 3> turned;
    mju_rotVecQuat(turned.data(), vector, rotation.data());
    return turned;
  }
  std::array<mjtNum, 3> Moved(const mjtNum* point) const {
    std::array<mjtNum, 3> moved = Turned(point);
    mju_addTo3(moved.data(), translation.data());
    return moved;
  }
};

// The motion of a point that the joint carries, when the joint goes back from q to qpos0 and then
// `after` moves the point on.
Motion BackThenAfter(const mjModel& model, const std::vector<double>& q, int joint,
                     const Motion& after) {
  const int at = model.jnt_qposadr[joint];
  const mjtNum back = model.qpos0[at] - q[static_cast<std::size_t>(at)];
  const mjtNum *axis = model.jnt_axis + 3 * joint, *anchor = model.jnt_pos + 3 * joint;
  Motion motion;
  mjtNum origin[3] = {0, 0, 0};  // where the body's origin goes
  if (model.jnt_type[joint] == mjJNT_SLIDE) {
    mju_scl3(origin, axis, back);
    motion.rotation = after.rotation;
  } else {
    mjtNum turn[4], turned[3];
    mju_axisAngle2Quat(turn, axis, back);
    mju_rotVecQuat(turned, anchor, turn);
    mju_sub3(origin, anchor, turned);
    mju_mulQuat(motion.rotation.data(), after.rotation.data(), turn);
  }
  motion.translation = after.Moved(origin);
  return motion;
}

// Where the hinges and slides of a body have to be in its frame for the same motions, when it
// begins at q. Each moves those that come after it in the text, and these then carry what they
// were turned by: T1(d1) T2 T3 = T1 T2 T3 (T2 T3)^-1 T1(d1) (T2 T3), with T as at q.
std::vector<JointLine> LinesFrom(const mjModel& model, const std::vector<double>& q, int body) {
  std::vector<JointLine> lines(model.body_jntnum[body]);
  Motion back;
  for (int k = model.body_jntnum[body] - 1; k >= 0; --k) {
    const int joint = model.body_jntadr[body] + k;
    lines[k] = {back.Turned(model.jnt_axis + 3 * joint), back.Moved(model.jnt_pos + 3 * joint)};
    back = BackThenAfter(model, q, joint, back);
  }
  return lines;
}

// A joint's tag, for a model that begins at pose.q.
std::string WithLine(std::string tag, const mjModel& model, const ResetPose& pose, int joint,
                     const JointLine& line) {
  const mjtNum *axis = model.jnt_axis + 3 * joint, *anchor = model.jnt_pos + 3 * joint;
  if (!Near(axis, line.axis.data(), 3, kSameModel)) {
    SetAttribute("axis", Numbers(line.axis.data(), 3), tag);
  }
  if (!Near(anchor, line.position.data(), 3, kSameModel)) {
    SetAttribute("pos", Numbers(line.position.data(), 3), tag);
  }
  if (!Moves(model, pose.q, joint)) return tag;
  const double ref = pose.q[static_cast<std::size_t>(model.jnt_qposadr[joint])];
  const bool degrees = pose.degrees && model.jnt_type[joint] == mjJNT_HINGE;
  SetAttribute("ref", Number(degrees ? ref * 180.0 / std::numbers::pi : ref), tag);
  return tag;
}

// False where a tag is not found, or a ball joint would have to begin elsewhere.
bool MoveBody(const mjModel& model, const ResetPose& pose, int body, TagEditor& editor) {
  const int place = editor.FindBody(model, body), first = model.body_jntadr[body];
  const int joints = model.body_jntnum[body];
  bool moves = false, balls = false;
  for (int joint = first; joint < first + joints; ++joint) {
    moves |= Moves(model, pose.q, joint);
    balls |= model.jnt_type[joint] == mjJNT_BALL;
  }
  if (!moves) return true;
  if (place < 0 || balls) return false;
  if (model.jnt_type[first] != mjJNT_FREE) {
    const std::vector<JointLine> lines = LinesFrom(model, pose.q, body);
    for (int k = 0; k < joints; ++k) {
      const std::optional<TextSpan> span = editor.Joint(place, k);
      if (!span) return false;
      editor.Replace(*span, WithLine(editor.TextOf(*span), model, pose, first + k, lines[k]));
    }
  }
  const TextSpan span = editor.Body(place);
  const DataPtr data = At(model, pose.q.data());
  editor.Replace(span, WithPose(editor.TextOf(span), model, *data, body));
  return true;
}

// The bodies that an equality constraint holds where they are at qpos0, and what carries them.
void MarkHeld(const mjModel& m, int equality, std::vector<char>& stays) {
  for (const int object : {m.eq_obj1id[equality], m.eq_obj2id[equality]}) {
    if (object < 0 || m.eq_type[equality] == mjEQ_TENDON) continue;
    int body = m.eq_type[equality] == mjEQ_JOINT      ? m.jnt_bodyid[object]
               : m.eq_objtype[equality] == mjOBJ_SITE ? m.site_bodyid[object]
                                                      : object;
    for (; body > 0; body = m.body_parentid[body]) stays[body] = 1;
  }
}

// Bodies that MJCF cannot have begin elsewhere without more changes: those of ball joints, and
// those that equality constraints hold.
std::vector<std::string> Staying(const mjModel& m) {
  std::vector<char> stays(m.nbody, 0);
  for (int e = 0; e < m.neq; ++e) MarkHeld(m, e, stays);
  for (int joint = 0; joint < m.njnt; ++joint) {
    stays[m.jnt_bodyid[joint]] |= m.jnt_type[joint] == mjJNT_BALL;
  }
  std::vector<std::string> names;
  for (int body = 1; body < m.nbody; ++body) {
    const std::string name = BodyName(m, body);
    if (stays[body] && m.body_jntnum[body] > 0 && !name.empty()) names.push_back(name);
  }
  return names;
}

// A body that stays keeps joints outside their limits where qpos0 has them there, and no place of
// another body mends that: such limits do not count. True if there are any.
bool DropLimitsLeft(const std::vector<std::string>& staying, mjModel& m) {
  bool dropped = false;
  for (int joint = 0; joint < m.njnt; ++joint) {
    const int type = m.jnt_type[joint];
    if (!m.jnt_limited[joint] || (type != mjJNT_HINGE && type != mjJNT_SLIDE)) continue;
    const std::string body = BodyName(m, m.jnt_bodyid[joint]);
    if (std::find(staying.begin(), staying.end(), body) == staying.end()) continue;
    const mjtNum q = m.qpos0[m.jnt_qposadr[joint]], *range = m.jnt_range + 2 * joint;
    if (q >= range[0] && q <= range[1]) continue;
    m.jnt_limited[joint] = 0;
    dropped = true;
  }
  return dropped;
}

// The text that begins at pose.q, where bodies of `staying` stay; none if that changes more.
std::optional<std::string> BeginningAt(const ResetPose& pose, const std::string& text,
                                       const mjModel& before,
                                       const std::vector<std::string>& staying) {
  TagEditor editor(text);
  for (int body = 1; body < before.nbody; ++body) {
    if (!MoveBody(before, pose, body, editor)) return std::nullopt;
  }
  std::string moved = editor.Changed();
  const ModelPtr after = Compiled(moved, pose.path);
  if (!after || !IsSameModel(before, *after)) return std::nullopt;
  DropLimitsLeft(staying, *after);
  const Scene scene = Scene::FromModel(after.get(), pose.scene);
  if (!Verify(scene, scene.DefaultQpos(), pose.solve).free) return std::nullopt;
  return moved;
}

}  // namespace

std::optional<MovedReset> WithResetPose(const std::string& text, const ResetPose& pose) {
  const ModelPtr before = Compiled(text, pose.path);
  if (!before) return std::nullopt;
  if (auto moved = BeginningAt(pose, text, *before, {})) return MovedReset{*moved, true};
  // Elsewhere, moving only bodies that MJCF can place.
  SceneOptions options = pose.scene;
  options.fixed = Staying(*before);
  if (options.fixed.empty()) return std::nullopt;
  const bool dropped = DropLimitsLeft(options.fixed, *before);
  const Scene scene = Scene::FromModel(before.get(), options);
  const Result result = Solver(scene, pose.solve).Solve(scene.DefaultQpos());
  if (result.status == Status::kUnsolved) return std::nullopt;
  const ResetPose placed{pose.path, result.q, pose.degrees, pose.scene, pose.solve};
  auto moved = BeginningAt(placed, text, *before, options.fixed);
  if (!moved) return std::nullopt;
  return MovedReset{*std::move(moved), !dropped};
}

}  // namespace mjcf_pdg::app
