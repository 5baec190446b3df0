// Keys and mouse buttons mean what they mean in MuJoCo's simulate.
#include "apps/view/input.h"

#include <gmock/gmock.h>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

KeyAction Of(const std::string& name) { return ActionOf(ParseKey(name)); }

void ExpectAction(const std::string& name, Action action, int index = 0) {
  const KeyAction found = Of(name);
  EXPECT_EQ(found.action, action) << name;
  EXPECT_EQ(found.index, index) << name;
}

TEST(ViewInputTest, TheLettersOfSimulateToggleWhatTheyToggleThere) {
  ExpectAction("c", Action::kVisualFlag, mjVIS_CONTACTPOINT);
  ExpectAction("f", Action::kVisualFlag, mjVIS_CONTACTFORCE);
  ExpectAction("h", Action::kVisualFlag, mjVIS_CONVEXHULL);
  ExpectAction("t", Action::kVisualFlag, mjVIS_TRANSPARENT);
  ExpectAction("s", Action::kRenderFlag, mjRND_SHADOW);
  ExpectAction("w", Action::kRenderFlag, mjRND_WIREFRAME);
}

TEST(ViewInputTest, EveryKeyOfMujocosTableIsBound) {
  int bound = 0;
  for (int flag = 0; flag < mjNVISFLAG; ++flag) {
    const std::string key = mjVISSTRING[flag][2];
    if (key.empty()) continue;
    ExpectAction(key, Action::kVisualFlag, flag);
    ++bound;
  }
  EXPECT_GE(bound, 20);
}

TEST(ViewInputTest, KeysOfSimulate) {
  ExpectAction("space", Action::kPlayPause);
  ExpectAction("left", Action::kStepBack);
  ExpectAction("right", Action::kStepForward);
  ExpectAction("backspace", Action::kReset);
  ExpectAction("escape", Action::kFreeCamera);
  ExpectAction("]", Action::kNextCamera);
  ExpectAction("pageup", Action::kSelectParent);
  ExpectAction("tab", Action::kToggleLeft);
  ExpectAction("shift+tab", Action::kToggleRight);
  ExpectAction("f6", Action::kNextFrame);
  ExpectAction("ctrl+c", Action::kCopyQpos, 0);
  ExpectAction("ctrl+shift+c", Action::kCopyQpos, 1);
  ExpectAction("ctrl+q", Action::kQuit);
  ExpectAction("3", Action::kGeomGroup, 3);
  ExpectAction("shift+3", Action::kSiteGroup, 3);
}

TEST(ViewInputTest, OtherKeysDoNothing) {
  for (const char* name : {"6", "9", "ctrl+t", "ctrl+3", "shift+c", "shift+space", "!"}) {
    ExpectAction(name, Action::kNone);
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
