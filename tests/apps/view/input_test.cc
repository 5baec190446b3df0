// Keys and mouse buttons mean what they mean in MuJoCo's simulate.
#include "apps/view/input.h"

#include <gmock/gmock.h>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

KeyAction Of(const std::string& name) { return ActionOf(ParseKey(name)); }

void ExpectAction(const std::string& name, Command command, int index = 0) {
  const KeyAction action = Of(name);
  EXPECT_EQ(action.command, command) << name;
  EXPECT_EQ(action.index, index) << name;
}

TEST(ViewInputTest, TheLettersOfSimulateToggleWhatTheyToggleThere) {
  ExpectAction("c", Command::kVisualFlag, mjVIS_CONTACTPOINT);
  ExpectAction("f", Command::kVisualFlag, mjVIS_CONTACTFORCE);
  ExpectAction("h", Command::kVisualFlag, mjVIS_CONVEXHULL);
  ExpectAction("t", Command::kVisualFlag, mjVIS_TRANSPARENT);
  ExpectAction("s", Command::kRenderFlag, mjRND_SHADOW);
  ExpectAction("w", Command::kRenderFlag, mjRND_WIREFRAME);
}

TEST(ViewInputTest, EveryKeyOfMujocosTableIsBound) {
  int bound = 0;
  for (int flag = 0; flag < mjNVISFLAG; ++flag) {
    const std::string key = mjVISSTRING[flag][2];
    if (key.empty()) continue;
    ExpectAction(key, Command::kVisualFlag, flag);
    ++bound;
  }
  EXPECT_GE(bound, 20);
}

TEST(ViewInputTest, KeysOfSimulate) {
  ExpectAction("space", Command::kPlayPause);
  ExpectAction("left", Command::kStepBack);
  ExpectAction("right", Command::kStepForward);
  ExpectAction("backspace", Command::kReset);
  ExpectAction("escape", Command::kFreeCamera);
  ExpectAction("]", Command::kNextCamera);
  ExpectAction("pageup", Command::kSelectParent);
  ExpectAction("tab", Command::kToggleLeft);
  ExpectAction("shift+tab", Command::kToggleRight);
  ExpectAction("f6", Command::kNextFrame);
  ExpectAction("ctrl+c", Command::kCopyCommand, 0);
  ExpectAction("ctrl+shift+c", Command::kCopyCommand, 1);
  ExpectAction("ctrl+q", Command::kQuit);
  ExpectAction("3", Command::kGeomGroup, 3);
  ExpectAction("shift+3", Command::kSiteGroup, 3);
}

TEST(ViewInputTest, OtherKeysDoNothing) {
  for (const char* name : {"6", "9", "ctrl+t", "ctrl+3", "shift+c", "shift+space", "!"}) {
    ExpectAction(name, Command::kNone);
  }
}

TEST(ViewInputTest, UnknownNamesOfKeysAreRefused) {
  for (const char* name : {"", "ctrl+", "spacebar", "alt+c"}) {
    EXPECT_THROW(ParseKey(name), Error) << name;
  }
}

TEST(ViewInputTest, ButtonsMoveTheCameraOrTheBody) {
  EXPECT_EQ(MotionOf({.left = true}), mjMOUSE_ROTATE_V);
  EXPECT_EQ(MotionOf({.left = true, .shift = true}), mjMOUSE_ROTATE_H);
  EXPECT_EQ(MotionOf({.right = true}), mjMOUSE_MOVE_V);
  EXPECT_EQ(MotionOf({.right = true, .shift = true}), mjMOUSE_MOVE_H);
  EXPECT_EQ(MotionOf({.middle = true}), mjMOUSE_ZOOM);
  EXPECT_EQ(MotionOf({.ctrl = true}), mjMOUSE_NONE);

  EXPECT_EQ(DragOf({.right = true, .ctrl = true}), mjPERT_TRANSLATE);
  EXPECT_EQ(DragOf({.left = true, .ctrl = true}), mjPERT_ROTATE);
  EXPECT_EQ(DragOf({.left = true}), 0);

  EXPECT_EQ(DoubleClickOf({.left = true}), DoubleClick::kSelect);
  EXPECT_EQ(DoubleClickOf({.right = true}), DoubleClick::kLookAt);
  EXPECT_EQ(DoubleClickOf({.right = true, .ctrl = true}), DoubleClick::kTrack);
  EXPECT_EQ(DoubleClickOf({.middle = true}), DoubleClick::kNone);
}

}  // namespace
}  // namespace mjcf_pdg::app
