#include "apps/audit/mended_text.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "apps/audit/mjcf_text.h"
#include "apps/audit/reset_pose.h"
#include "apps/audit/same_model.h"
#include "apps/input/configurations.h"
#include "apps/input/qpos_file.h"
#include "apps/input/text_file.h"
#include "apps/output/repaired_mjcf.h"
#include "apps/output/setpoints.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

// What a model may be reset to whose qpos0 penetrates and has to stay.
constexpr char kDefaultKey[] = "qpos0_pdg";

// Where keyframe `key` of the model stands among the <key> tags of the text; null: nowhere. The
// tags of a part of the keyframes (others came with an <attach>, or are only counted by
// <size nkey>) are told apart by their names.
const TextSpan* FindKey(const std::string& text, const std::vector<TextSpan>& tags,
                        const AuditedKey& key, int nkey) {
  if (static_cast<int>(tags.size()) == nkey) return &tags[static_cast<std::size_t>(key.of.key)];
  for (const TextSpan& tag : tags) {
    const std::string written = tag.Of(text);
    const std::optional<TextSpan> name = FindAttribute(written, "name");
    if (name && name->Of(written) == Escaped(key.of.label)) return &tag;
  }
  return nullptr;
}

// A URDF's root is <robot>.
bool IsUrdf(const std::string& text) {
  const std::vector<TextSpan> robots = FindTags(text, "robot");
  return !robots.empty() && FindTags(text, "mujoco").empty();
}

// What a keyframe is to have instead of what it has. Setpoints that do not change are empty.
struct FreeKey {
  std::vector<double> q;
  Setpoints setpoints;
};

std::string WithNumbers(std::string tag, const std::string& name,
                        const std::vector<double>& values) {
  if (values.empty()) return tag;
  std::string numbers = FormatQposRow(values, "rows.txt");
  numbers.pop_back();  // its line break
  if (const std::optional<TextSpan> attribute = FindAttribute(tag, name)) {
    return tag.replace(attribute->begin, attribute->length, numbers);
  }
  return "<key " + name + "=\"" + numbers + "\"" + tag.substr(4);
}

std::string WithKey(std::string tag, const FreeKey& key) {
  tag = WithNumbers(std::move(tag), "act", key.setpoints.act);
  tag = WithNumbers(std::move(tag), "ctrl", key.setpoints.ctrl);
  return WithNumbers(std::move(tag), "qpos", key.q);
}

FreeKey ToFreeKey(const Configuration& row, const std::vector<double>& q, SetpointMover& mover) {
  const Setpoints before = mover.Of(row);
  FreeKey key{q, mover.Moved(row, q)};
  if (key.setpoints.ctrl == before.ctrl) key.setpoints.ctrl.clear();
  if (key.setpoints.act == before.act) key.setpoints.act.clear();
  return key;
}

// What replaces keyframes that are wrong, and the new lines of the model.
struct Mending {
  std::vector<std::pair<TextSpan, FreeKey>> keys;
  std::vector<std::string> contact, keyframe;
  FreeKey begin;                  // where the model is to begin instead of qpos0; empty: there
  std::vector<std::string> left;  // what stays wrong, and why
};

// <size nkey> counts more keyframes than stand in the text: those are qpos0, and the next <key> of
// the text becomes the first of them.
bool IsOnlyCounted(const std::string& text, const std::vector<TextSpan>& tags, int key) {
  return key >= static_cast<int>(tags.size()) && FindTags(text, "attach").empty();
}

void MendKeys(const Scene& scene, const Audit& audit, const std::string& text,
              const Options& options, Mending& mending) {
  const mjModel& model = *scene.model();
  Solver solver(scene, options);
  SetpointMover mover(model);
  const std::vector<TextSpan> tags = FindTags(text, "key");
  for (const AuditedKey& key : audit.keys) {
    if (!key.Wrong()) continue;
    const auto leave = [&](const std::string& why) {
      mending.left.push_back((key.of.key < 0 ? "" : "keyframe ") + key.of.label + " stays: " + why);
    };
    solver.SetMocap(key.of.mocap_pos, key.of.mocap_quat);
    const Result result = solver.Solve(key.of.q);
    if (result.status == Status::kAlreadyFree) {  // with the <exclude> lines
      if (key.violates) leave("an equality constraint that it violates is none of those held");
    } else if (result.status == Status::kUnsolved) {
      leave(result.reason);
    } else if (key.of.key < 0) {
      mending.begin = ToFreeKey(key.of, result.q, mover);
    } else if (const TextSpan* tag = FindKey(text, tags, key, static_cast<int>(model.nkey))) {
      mending.keys.emplace_back(*tag, ToFreeKey(key.of, result.q, mover));
    } else if (IsOnlyCounted(text, tags, key.of.key)) {
      mending.keyframe.push_back(WithKey("<key/>", ToFreeKey(key.of, result.q, mover)));
    } else {
      leave("no <key> of the model's text is its");
    }
  }
  std::sort(mending.keys.begin(), mending.keys.end(),
            [](const auto& a, const auto& b) { return a.first.begin > b.first.begin; });
}

std::string Section(const std::string& name, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string text = "  <" + name + ">\n";
  for (const std::string& line : lines) text += "    " + line + "\n";
  return text + "  </" + name + ">\n";
}

// The new lines go to the end of the model, and keyframes are replaced from the last on, so that
// the places of those before stay what they are.
std::string Applied(std::string text, const Mending& mending) {
  const std::string lines =
      Section("contact", mending.contact) + Section("keyframe", mending.keyframe);
  if (!lines.empty()) {
    const std::size_t end = WithoutComments(text).rfind("</mujoco");
    if (end == std::string::npos) throw Error("--fix: the model has no </mujoco>");
    text.insert(end, lines);
  }
  for (const auto& [tag, key] : mending.keys) {
    text.replace(tag.begin, tag.length, WithKey(tag.Of(text), key));
  }
  return text;
}

// Of permanent overlaps of bodies of which one has no name: it gets one, and there is a line for
// the two. Bodies are numbered as their tags stand in the text, unless some come from elsewhere.
void ExcludeUnnamed(const Audit& audit, const std::string& path, std::string& text,
                    Mending& mending) {
  std::set<int> bodies;
  for (const auto& [body1, body2] : audit.unnamed) bodies.insert({body1, body2});
  bodies.erase(0);  // the world, which is not written and has a name
  if (bodies.empty()) return;
  const ModelPtr model = Compiled(text, path);
  std::vector<TextSpan> tags = FindTags(text, "body");
  if (!model || static_cast<int>(tags.size()) != model->nbody - 1) {
    mending.left.push_back("a permanent overlap stays: no <body> of the model's text is its");
    return;
  }
  std::map<int, std::string> names = {{0, "world"}};
  for (auto body = bodies.rbegin(); body != bodies.rend();
       ++body) {  // what is before keeps its place
    const TextSpan& tag = tags[static_cast<std::size_t>(*body - 1)];
    const std::string written = tag.Of(text);
    const std::optional<TextSpan> name = FindAttribute(written, "name");
    names[*body] = name ? name->Of(written) : "body_pdg_" + std::to_string(*body);
    if (!name) text.insert(tag.begin + 5, " name=\"" + names[*body] + "\"");  // behind "<body"
  }
  std::set<std::string> lines;
  for (const auto& [body1, body2] : audit.unnamed) {
    lines.insert("<exclude body1=\"" + names[body1] + "\" body2=\"" + names[body2] + "\"/>");
  }
  mending.contact.insert(mending.contact.end(), lines.begin(), lines.end());
}

// What was mended, in words.
std::string Done(const Mending& mending, bool begins_free) {
  std::string words;
  const auto append = [&words](std::size_t count, const std::string& what) {
    if (count == 0) return;
    words += (words.empty() ? "" : ", ") + std::to_string(count) + " " + what;
    if (count > 1) words += "s";
  };
  append(mending.contact.size(), "<exclude>");
  append(mending.keys.size() + mending.keyframe.size(), "keyframe");
  if (begins_free) words += std::string(words.empty() ? "" : ", ") + "qpos0";
  return words.empty() ? "nothing" : words;
}

// With a keyframe for the model to be reset to, unless there is one of that name.
std::string WithDefaultKey(std::string text, const FreeKey& key) {
  const std::vector<TextSpan> tags = FindTags(text, "key");
  for (const TextSpan& tag : tags) {
    const std::string written = tag.Of(text);
    const std::optional<TextSpan> name = FindAttribute(written, "name");
    if (name && name->Of(written) == kDefaultKey) return text;
  }
  Mending mending;
  mending.keyframe.push_back(WithKey(std::string("<key name=\"") + kDefaultKey + "\"/>", key));
  return Applied(std::move(text), mending);
}

struct Beginning {
  std::string text;
  bool free = false;  // at qpos0
};

// The model begins where it is free: at its own qpos0, if MJCF can say that, else at a keyframe.
// MJCF cannot say at which controls it begins, which are 0.
Beginning BeginningFree(std::string text, const FreeKey& begin, const ResetPose& pose,
                        std::vector<std::string>& left) {
  const fs::path folder = fs::absolute(pose.path).parent_path();
  const std::string whole = WithIncludesOf(text, "body", folder);
  std::optional<MovedReset> moved = WithResetPose(whole, pose);
  const std::string key = std::string("keyframe ") + kDefaultKey;
  if (moved && moved->within_limits) {
    const auto& [ctrl, act] = begin.setpoints;
    if (ctrl.empty() && act.empty()) return {std::move(moved->text), true};
    left.push_back(
        "position actuators pull qpos0 back to where it overlapped, as ctrl and act begin at 0; " +
        key + " has what holds it");
  } else {
    const std::string why =
        moved ? "nothing overlaps at qpos0, but joints that have to begin there stay outside their "
                "limits"
              : "qpos0 stays: other places of bodies would change more than that";
    left.push_back(why + "; " + key + " is free");
  }
  if (moved) text = std::move(moved->text);
  return {WithDefaultKey(std::move(text), begin), moved.has_value()};
}

}  // namespace

std::string ExcludeLine(const std::string& body1, const std::string& body2) {
  return "<exclude body1=\"" + Escaped(body1) + "\" body2=\"" + Escaped(body2) + "\"/>";
}

MendedModel Mended(const std::string& model, const Audit& audit, const MendOptions& options) {
  std::error_code ec;
  const fs::path from = fs::weakly_canonical(fs::absolute(model), ec).parent_path();
  const fs::path to = fs::weakly_canonical(fs::absolute(options.target), ec).parent_path();
  if (from != to) throw Error("--fix: " + options.target + ": must be in the folder of " + model);
  std::string text = ReadTextFile(model);
  if (fs::path(model).extension() == ".mjb" || text.find('\0') != std::string::npos) {
    throw Error("--fix: " + model + " is no text");
  }
  if (IsUrdf(text)) {
    throw Error("--fix: " + model +
                " is a URDF, which has neither excludes nor keyframes: let solve " +
                "--out-mjcf write it as MJCF");
  }
  Mending mending;
  for (const auto& [body1, body2] : audit.exclude) {
    mending.contact.push_back(ExcludeLine(body1, body2));
  }
  ExcludeUnnamed(audit, options.target, text, mending);
  bool any_wrong = false, key_wrong = false;
  for (const AuditedKey& key : audit.keys) {
    any_wrong |= key.Wrong();
    key_wrong |= key.Wrong() && key.of.key >= 0;
  }
  if (key_wrong) text = WithIncludesOf(std::move(text), "key", from);
  if (any_wrong) {
    const ModelPtr excluding = Compiled(Applied(text, mending), options.target);
    if (!excluding) throw Error("--fix: " + model + " does not load with its <exclude> lines");
    const Scene scene = Scene::FromModel(excluding.get(), options.scene);
    MendKeys(scene, audit, text, options.solve, mending);
  }
  text = Applied(std::move(text), mending);
  Beginning beginning;
  if (!mending.begin.q.empty()) {
    const bool degrees = ParseSpec(model)->compiler.degree != 0;
    const ResetPose pose{options.target, mending.begin.q, degrees, options.scene, options.solve};
    beginning = BeginningFree(std::move(text), mending.begin, pose, mending.left);
    text = std::move(beginning.text);
  }
  return {std::move(text), Done(mending, beginning.free), std::move(mending.left)};
}

}  // namespace mjcf_pdg::app
