// Scripts: what is understood, and where what is not understood stands.
#include "apps/view/script.h"

#include <gmock/gmock.h>

#include "mjcf_pdg/types.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using app::ParseScript;
using app::ScriptEvent;
using Kind = ScriptEvent::Kind;

constexpr char kModel[] = R"(<mujoco><worldbody><body name="box"><freejoint name="flies"/>
  <geom size=".1"/><body name="lid"><joint name="hinge"/><geom size=".1"/></body></body>
  </worldbody></mujoco>)";

class ViewScriptTest : public MujocoTest {
 protected:
  std::string Refusal(const std::string& text) const {
    try {
      ParseScript(text, "s.txt", *model_);
    } catch (const Error& e) {
      return e.what();
    }
    ADD_FAILURE() << "accepted: " << text;
    return "";
  }
  ModelPtr model_ = LoadModel(kModel);
};

TEST_F(ViewScriptTest, EventsAreRead) {
  const std::vector<ScriptEvent> events = ParseScript(
      "# a comment\n\nframes 3\nkey ctrl+shift+c # another\njoint hinge -0.5\n"
      "drag lid 1 -2 3e-1 40\ncamera 90 -20 2.5\nrow home\nsolve\nstep -1\nscreenshot a.png",
      "s.txt", *model_);
  ASSERT_EQ(events.size(), 9u);
  EXPECT_EQ(events[0].frames, 3);
  EXPECT_EQ(events[1].key.key, 'C');
  EXPECT_TRUE(events[1].key.ctrl && events[1].key.shift);
  EXPECT_EQ(events[2].id, mj_name2id(model_.get(), mjOBJ_JOINT, "hinge"));
  EXPECT_EQ(events[2].numbers[0], -0.5);
  EXPECT_EQ(events[3].kind, Kind::kDrag);
  EXPECT_THAT(events[3].numbers, testing::ElementsAre(1, -2, 0.3));
  EXPECT_EQ(events[3].frames, 40);
  EXPECT_EQ(events[4].numbers[2], 2.5);
  EXPECT_EQ(events[5].text, "home");
  EXPECT_EQ(events[6].kind, Kind::kSolve);
  EXPECT_EQ(events[7].frames, -1);
  EXPECT_EQ(events[8].text, "a.png");
  EXPECT_TRUE(ParseScript("", "s.txt", *model_).empty());
}

TEST_F(ViewScriptTest, MistakesAreNamedWithTheirLine) {
  EXPECT_EQ(Refusal("frames 1\nfames 3").rfind("s.txt line 2: no event 'fames' (events: ", 0), 0u);
  EXPECT_EQ(Refusal("frames"), "s.txt line 1: is not: frames N");
  EXPECT_EQ(Refusal("solve now"), "s.txt line 1: is not: solve");
  const std::pair<const char*, const char*> mistakes[] = {
      {"frames 0", "'0' is not a whole number"},
      {"frames 1.5", "'1.5' is not a whole number"},
      {"frames 1e9", "at most 1000000"},
      {"frames x", "'x' is not a number"},
      {"frames nan", "not finite"},
      {"key shift", "no key 'shift'"},
      {"joint elbow 1", "no joint 'elbow'"},
      {"joint flies 1", "neither hinge nor slide"},
      {"drag arm 1 1 1 1", "no body 'arm'"},
      {"drag lid 1 1 inf 1", "not finite"},
      {"camera 1 1 0", "more than 0"},
      {"step -2", "at least -1"},
      {"screenshot a.jpg", "does not end in .png"},
  };
  for (const auto& [text, words] : mistakes) {
    EXPECT_THAT(Refusal(text), testing::HasSubstr(words));
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
