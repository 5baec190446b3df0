#include "apps/view/script.h"

#include <cmath>
#include <sstream>

#include "apps/console/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

using Kind = ScriptEvent::Kind;
using Words = std::vector<std::string>;

constexpr int kMostFrames = 1000000;

struct Form {
  const char* name;
  Kind kind;
  std::size_t words;  // after the name
  const char* shape;
};

constexpr Form kForms[] = {
    {"frames", Kind::kFrames, 1, "frames N"},
    {"key", Kind::kKey, 1, "key NAME"},
    {"row", Kind::kRow, 1, "row NAME"},
    {"joint", Kind::kJoint, 2, "joint NAME VALUE"},
    {"drag", Kind::kDrag, 5, "drag BODY DX DY DZ N"},
    {"camera", Kind::kCamera, 3, "camera AZIMUTH ELEVATION DISTANCE"},
    {"solve", Kind::kSolve, 0, "solve"},
    {"step", Kind::kStep, 1, "step N"},
    {"screenshot", Kind::kScreenshot, 1, "screenshot FILE.png"},
};

double Number(const std::string& word) {
  const std::vector<double> numbers = ParseNumbers(word, "a number");
  if (numbers.size() != 1) throw Error("'" + word + "' is not a number");
  return numbers[0];
}

int Whole(const std::string& word, int least) {
  const double number = Number(word);
  if (number != std::floor(number) || number < least || number > kMostFrames) {
    throw Error("'" + word + "' is not a whole number that is at least " + std::to_string(least) +
                " and at most " + std::to_string(kMostFrames));
  }
  return static_cast<int>(number);
}

int Find(const mjModel& model, mjtObj type, const char* what, const std::string& name) {
  const int id = mj_name2id(&model, type, name.c_str());
  if (id < 0) throw Error(std::string("no ") + what + " '" + name + "'");
  return id;
}

int FindJoint(const mjModel& model, const std::string& name) {
  const int joint = Find(model, mjOBJ_JOINT, "joint", name);
  if (model.jnt_type[joint] != mjJNT_HINGE && model.jnt_type[joint] != mjJNT_SLIDE) {
    throw Error("the joint '" + name + "' is neither hinge nor slide");
  }
  return joint;
}

void ReadNumbers(const Words& words, std::size_t first, std::size_t count, ScriptEvent& event) {
  for (std::size_t k = 0; k < count; ++k) event.numbers[k] = Number(words[first + k]);
}

// `words` begins with the name of the event.
ScriptEvent ParseEvent(const Words& words, const mjModel& model) {
  const Form* form = nullptr;
  std::string names;
  for (const Form& one : kForms) {
    if (words[0] == one.name) form = &one;
    names += (names.empty() ? "" : ", ") + std::string(one.name);
  }
  if (!form) throw Error("no event '" + words[0] + "' (events: " + names + ")");
  if (words.size() != form->words + 1) throw Error(std::string("is not: ") + form->shape);
  ScriptEvent event;
  event.kind = form->kind;
  switch (form->kind) {
    case Kind::kFrames:
      event.frames = Whole(words[1], 1);
      break;
    case Kind::kKey:
      event.key = ParseKey(words[1]);
      break;
    case Kind::kJoint:
      event.id = FindJoint(model, words[1]);
      ReadNumbers(words, 2, 1, event);
      break;
    case Kind::kDrag:
      event.id = Find(model, mjOBJ_BODY, "body", words[1]);
      ReadNumbers(words, 2, 3, event);
      event.frames = Whole(words[5], 1);
      break;
    case Kind::kCamera:
      ReadNumbers(words, 1, 3, event);
      if (!(event.numbers[2] > 0)) throw Error("the distance of a camera is more than 0");
      break;
    case Kind::kStep:
      event.frames = Whole(words[1], -1);
      break;
    case Kind::kScreenshot:
      if (!words[1].ends_with(".png")) throw Error("'" + words[1] + "' does not end in .png");
      event.text = words[1];
      break;
    case Kind::kRow:
      event.text = words[1];
      break;
    case Kind::kSolve:
      break;
  }
  return event;
}

}  // namespace

std::vector<ScriptEvent> ParseScript(const std::string& text, const std::string& name,
                                     const mjModel& model) {
  std::vector<ScriptEvent> events;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream stream(line.substr(0, line.find('#')));
    Words words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) continue;
    try {
      events.push_back(ParseEvent(words, model));
    } catch (const Error& e) {
      throw Error(name + " line " + std::to_string(number) + ": " + e.what());
    }
  }
  return events;
}

}  // namespace mjcf_pdg::app
