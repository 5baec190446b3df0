#include "apps/view/input.h"

#include <array>
#include <cctype>
#include <utility>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

struct Binding {
  KeyPress press;
  Action action;
  int index = 0;
};

constexpr std::array kBindings = {
    Binding{{' '}, Action::kPlayPause},
    Binding{{kKeyLeft}, Action::kStepBack},
    Binding{{kKeyRight}, Action::kStepForward},
    Binding{{kKeyUp}, Action::kPreviousRow},
    Binding{{kKeyDown}, Action::kNextRow},
    Binding{{kKeyBackspace}, Action::kReset},
    Binding{{kKeyEnter}, Action::kSolve},
    Binding{{kKeyEscape}, Action::kFreeCamera},
    Binding{{']'}, Action::kNextCamera},
    Binding{{'['}, Action::kPreviousCamera},
    Binding{{'A', true}, Action::kAlign},
    Binding{{kKeyPageUp}, Action::kSelectParent},
    Binding{{kKeyTab}, Action::kToggleLeft},
    Binding{{kKeyTab, false, true}, Action::kToggleRight},
    Binding{{kKeyF1}, Action::kHelp},
    Binding{{kKeyF5}, Action::kFullScreen},
    Binding{{kKeyF6}, Action::kNextFrame},
    Binding{{kKeyF7}, Action::kNextLabel},
    Binding{{'C', true}, Action::kCopyQpos},
    Binding{{'C', true, true}, Action::kCopyQpos, 1},
    Binding{{'R', true}, Action::kCopyRepaired},
    Binding{{'R', true, true}, Action::kCopyRepaired, 1},
    Binding{{'V', true}, Action::kPaste},
    Binding{{'S', true}, Action::kSave},
    Binding{{'P', true}, Action::kScreenshot},
    Binding{{'Q', true}, Action::kQuit},
};

constexpr std::array<std::pair<const char*, int>, 14> kNames = {{{"escape", kKeyEscape},
                                                                 {"enter", kKeyEnter},
                                                                 {"tab", kKeyTab},
                                                                 {"backspace", kKeyBackspace},
                                                                 {"right", kKeyRight},
                                                                 {"left", kKeyLeft},
                                                                 {"down", kKeyDown},
                                                                 {"up", kKeyUp},
                                                                 {"pageup", kKeyPageUp},
                                                                 {"space", ' '},
                                                                 {"f1", kKeyF1},
                                                                 {"f5", kKeyF5},
                                                                 {"f6", kKeyF6},
                                                                 {"f7", kKeyF7}}};

bool Is(const KeyPress& a, const KeyPress& b) {
  return a.key == b.key && a.ctrl == b.ctrl && a.shift == b.shift;
}

template <int kCount>
int FlagOf(const char* const (&table)[kCount][3], int key) {
  for (int flag = 0; flag < kCount; ++flag) {
    const char* const shortcut = table[flag][2];
    if (shortcut[0] == key && shortcut[0] != '\0' && shortcut[1] == '\0') return flag;
  }
  return -1;
}

// Removes `prefix` from the head of `text` if it is there.
bool Take(std::string& text, const std::string& prefix) {
  if (!text.starts_with(prefix)) return false;
  text.erase(0, prefix.size());
  return true;
}

}  // namespace

KeyAction ActionOf(const KeyPress& press) {
  for (const Binding& binding : kBindings) {
    if (Is(binding.press, press)) return {binding.action, binding.index};
  }
  if (press.ctrl) return {};
  if (press.key >= '0' && press.key < '0' + mjNGROUP) {
    return {press.shift ? Action::kSiteGroup : Action::kGeomGroup, press.key - '0'};
  }
  if (press.shift) return {};
  if (const int flag = FlagOf(mjVISSTRING, press.key); flag >= 0) {
    return {Action::kVisualFlag, flag};
  }
  if (const int flag = FlagOf(mjRNDSTRING, press.key); flag >= 0) {
    return {Action::kRenderFlag, flag};
  }
  return {};
}

KeyPress ParseKey(const std::string& name) {
  KeyPress press;
  std::string rest = name;
  press.ctrl = Take(rest, "ctrl+");
  press.shift = Take(rest, "shift+");
  for (const auto& [word, key] : kNames) {
    if (rest == word) press.key = key;
  }
  if (rest.size() == 1) press.key = std::toupper(static_cast<unsigned char>(rest[0]));
  if (press.key == 0) {
    throw Error("no key '" + name + "' (a character, space, left, f1, ctrl+shift+c, ...)");
  }
  return press;
}

mjtMouse MotionOf(const Held& held) {
  if (held.right) return held.shift ? mjMOUSE_MOVE_H : mjMOUSE_MOVE_V;
  if (held.left) return held.shift ? mjMOUSE_ROTATE_H : mjMOUSE_ROTATE_V;
  return held.middle ? mjMOUSE_ZOOM : mjMOUSE_NONE;
}

int DragOf(const Held& held) {
  if (!held.ctrl) return 0;
  if (held.right) return mjPERT_TRANSLATE;
  return held.left ? mjPERT_ROTATE : 0;
}

DoubleClick DoubleClickOf(const Held& held) {
  if (held.left) return DoubleClick::kSelect;
  if (!held.right) return DoubleClick::kNone;
  return held.ctrl ? DoubleClick::kTrack : DoubleClick::kLookAt;
}

}  // namespace mjcf_pdg::app
