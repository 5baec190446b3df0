// mjcf-pdg view in a window on a display in memory: real events, what they do to the command and
// its repair, and what is to be seen. Skipped where the program has no window, or no Xvfb, xdotool
// or OpenGL is installed.
#include <mujoco/mujoco.h>

#include <cmath>
#include <functional>
#include <optional>

#include "mjcf_pdg/pdg.h"
#include "tests/support/cli_test.h"
#include "tests/support/virtual_display.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;
using Q = std::vector<double>;

constexpr char kFigure[] = MJCF_PDG_MODEL_DIR "/figure/figure_bench.xml";

// A ball at the end of a swing, before the middle of a wall. The ball fills the middle of the
// picture.
constexpr char kSwing[] = R"(<mujoco><statistic center="0 0 0" extent="1"/>
  <visual><global azimuth="90" elevation="0"/></visual><worldbody><light pos="0 -2 2" dir="0 1 -1"/>
  <geom name="wall" type="box" size=".1 .6 .6" pos=".5 0 0"/>
  <body name="swing" pos="0 0 1"><joint name="hinge" axis="0 1 0" range="-90 90"/>
    <geom type="capsule" fromto="0 0 -.1 0 0 -.7" size=".02" contype="0" conaffinity="0"/>
    <geom name="ball" size=".25" pos="0 0 -1"/></body></worldbody>
  <keyframe><key name="home" qpos="0"/><key name="deep" qpos="-.3"/></keyframe></mujoco>)";

bool IsOrange(const std::uint8_t* p) { return p[0] > 110 && p[0] > 2 * p[2] && p[1] < p[0]; }
bool IsBlue(const std::uint8_t* p) { return p[2] > 80 && p[2] > 2 * p[0]; }

// What is to be seen between the panels.
int Count(const Pixels& pixels, bool (*is_kind)(const std::uint8_t*)) {
  int count = 0;
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 335; x < pixels.width - 335; ++x) count += is_kind(pixels.At(x, y));
  }
  return count;
}

int Differences(const Pixels& a, const Pixels& b) {
  int count = 0;
  for (std::size_t k = 0; k < a.rgb.size(); k += 3) {
    count += !std::equal(&a.rgb[k], &a.rgb[k] + 3, &b.rgb[k]);
  }
  return count;
}

class CliViewTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    if (IsSkipped()) return;
    if (Run({"view", "--help"}).exit_code != 0) {
      GTEST_SKIP() << "the program was built without GLFW or Dear ImGui";
    }
    Write("swing.xml", kSwing);
    if (const std::string missing = VirtualDisplay::Missing(); !missing.empty()) {
      GTEST_SKIP() << "not installed: " << missing;
    }
    display_.emplace();
  }

  // Runs `view` on the display. It writes its ticks to stdout.
  void Open(const std::string& model, const Arguments& more = {}) {
    Arguments arguments = {kProgram, "view", model, "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    program_.emplace(ChildProcess::Start{.arguments = arguments,
                                         .cwd = cwd(),
                                         .errors = cwd() / "errors",
                                         .variables = {display_->variable()}});
    scene_.emplace(Scene::FromFile(cwd() / model));  // an absolute path stays as it is
    if (!NextTick()) {
      const std::string errors = Read("errors");
      if (errors.find("no OpenGL") != std::string::npos) GTEST_SKIP() << errors;
      FAIL() << errors;
    }
    display_->Send({"search", "--sync", "--name", "^mjcf-pdg view", "windowfocus"});
  }

  // The next tick. Its answer is held against the verifier.
  bool NextTick() {
    const std::optional<std::string> line = program_->ReadLine();
    if (!line) return false;
    tick_ = Json::parse(*line);
    ++ticks_;
    if (tick_["status"] != "unsolved") {
      const Verdict verdict = Verify(*scene_, tick_["qpos"].get<Q>());
      EXPECT_TRUE(verdict.free) << "tick " << ticks_ << ": " << verdict.reason;
    }
    return true;
  }

  // Sends events and waits for a tick as described; sends them again if none comes: where events
  // come slowly two clicks are no double-click.
  bool After(const std::vector<std::string>& events, const std::function<bool()>& reached) {
    for (int turn = 0; turn < 5; ++turn) {
      display_->Send(events);
      for (int k = 0; k < 20; ++k) {
        if (!NextTick()) return false;
        if (reached()) return true;
      }
    }
    return false;
  }

  // Waits for a tick with a picture as described.
  bool Shows(const std::function<bool(const Pixels&)>& wanted) {
    for (int k = 0; k < 100; ++k) {
      if (wanted(display_->Look())) return true;
      if (!NextTick()) return wanted(display_->Look());
    }
    return false;
  }

  double command() const { return tick_["qpos_in"][0]; }

  std::optional<VirtualDisplay> display_;
  std::optional<ChildProcess> program_;
  std::optional<Scene> scene_;
  Json tick_;
  int ticks_ = 0;
};

constexpr char kMiddleX[] = "640", kMiddleY[] = "400";

TEST_F(CliViewTest, ABallIsDraggedIntoAWallAndItsGhostStaysBefore) {
  Open("swing.xml", {"--key", "home"});
  if (IsSkipped()) return;
  EXPECT_EQ(tick_["status"], "already_free");
  EXPECT_TRUE(Shows([](const Pixels& seen) { return Count(seen, IsBlue) < 50; }));
  const Pixels before = display_->Look();
  EXPECT_LT(Count(before, IsOrange), 50);

  // Double-click the ball, then pull it to the right with Ctrl and the right button.
  const bool dragged = After({"mousemove", kMiddleX,   kMiddleY,
                              "click",     "--repeat", "2",
                              "1",         "keydown",  "ctrl",
                              "mousedown", "3",        "mousemove_relative",
                              "60",        "0",        "mousemove_relative",
                              "60",        "0",        "mousemove_relative",
                              "30",        "0",        "mouseup",
                              "3",         "keyup",    "ctrl"},
                             [this] { return tick_["status"] == "solved"; });
  ASSERT_TRUE(dragged) << tick_;
  EXPECT_LT(command(), -0.16) << "the swing goes to the right for negative angles";
  // The nearest way out is back: the ball touches the wall where sin(q) = 0.15.
  EXPECT_NEAR(tick_["qpos"][0], -std::asin(0.15), 1e-3);
  EXPECT_LE(tick_["sigma_lower_bound"], tick_["sigma"]);
  EXPECT_TRUE(Shows([](const Pixels& seen) {
    return Count(seen, IsBlue) > 2000 && Count(seen, IsOrange) > 2000;
  }));

  // Backspace puts the row back, and the picture with it.
  EXPECT_TRUE(After({"key", "BackSpace"}, [this] { return command() == 0.0; }));
  EXPECT_TRUE(Shows(
      [](const Pixels& seen) { return Count(seen, IsBlue) < 50 && Count(seen, IsOrange) < 50; }));

  // The middle button zooms, the left one turns the camera: all that is shown changes.
  const Pixels reset = display_->Look();
  display_->Send({"mousemove", kMiddleX, "600", "mousedown", "1", "mousemove_relative", "200", "30",
                  "mouseup", "1"});
  EXPECT_TRUE(After({"key", "BackSpace"}, [] { return true; }));
  EXPECT_TRUE(Shows([&](const Pixels& seen) { return Differences(seen, reset) > 20000; }));

  display_->Send({"key", "ctrl+q"});
  EXPECT_EQ(program_->Wait(), 0) << Read("errors");
}

TEST_F(CliViewTest, KeysCopyPasteHideAndSave) {
  Open("swing.xml", {"--key", "deep", "--out-mjcf", "saved.xml"});
  if (IsSkipped()) return;
  EXPECT_EQ(tick_["status"], "solved");
  EXPECT_TRUE(Shows([](const Pixels& seen) { return Count(seen, IsOrange) > 2000; }));

  // The repaired configuration goes through the clipboard into the command.
  EXPECT_TRUE(After({"mousemove", kMiddleX, kMiddleY, "key", "ctrl+shift+r", "key", "ctrl+v"},
                    [this] { return tick_["status"] == "already_free"; }));
  EXPECT_NEAR(command(), -std::asin(0.15), 1e-3);
  EXPECT_TRUE(After({"key", "BackSpace"}, [this] { return command() == -0.3; }));

  // Ctrl+S writes a scene whose new keyframe is free.
  display_->Send({"key", "ctrl+s", "key", "ctrl+q"});
  EXPECT_EQ(program_->Wait(), 0) << Read("errors");
  const Outcome check = Run({"check", "saved.xml", "--key", "deep_pdg"});
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  EXPECT_FALSE(std::filesystem::exists(cwd() / "imgui.ini"));
}

// Everything in the scene is in group 0.
TEST_F(CliViewTest, AGroupIsHiddenByItsDigit) {
  Open("swing.xml", {"--key", "home"});
  if (IsSkipped()) return;
  const auto shows_ball = [](const Pixels& seen) {
    return *seen.At(640, 330) > 40;  // not where the pointer is
  };
  EXPECT_TRUE(Shows(shows_ball));
  const Pixels before = display_->Look();
  display_->Send({"mousemove", kMiddleX, kMiddleY, "key", "0"});
  EXPECT_TRUE(Shows(
      [&](const Pixels& seen) { return Differences(seen, before) > 20000 && !shows_ball(seen); }));
}

TEST_F(CliViewTest, AScriptDragsAFigureThroughABench) {
  Write("drag.txt",
        "camera 160 -15 3\nframes 1\ndrag pelvis -0.6 0.4 -0.3 60\nscreenshot drag.png\n");
  Open(kFigure, {"--key", "home", "--script", "drag.txt"});
  if (IsSkipped()) return;
  int colliding = 0;
  double deepest = 0;
  while (NextTick()) {
    colliding += !tick_["contacts_in"].empty();
    deepest = std::min<double>(deepest, tick_["depth_in"]);
    EXPECT_EQ(tick_["index"], ticks_ - 1);
  }
  EXPECT_EQ(program_->Wait(), 0) << Read("errors");
  EXPECT_EQ(ticks_, 63);  // the screenshot's frame and the last one, too
  EXPECT_GE(colliding, 40);
  EXPECT_LT(deepest, -0.05);
  EXPECT_EQ(Read("drag.png").substr(1, 3), "PNG");
}

// A ball over a table that is dragged up into it. The keyframe that is saved has the table where it
// was dragged, and the servo's setpoint has gone along from where it was in the keyframe.
TEST_F(CliViewTest, WhatIsSavedHasTheObstaclesWhereTheyWereDragged) {
  Write("table.xml", R"(<mujoco><worldbody>
    <body name="table" mocap="true"><geom type="box" size="1 1 .5" pos="0 0 -.5"/></body>
    <body name="ball" pos="0 0 1"><joint name="z" type="slide" axis="0 0 1"/>
      <geom name="ball" size=".1"/></body></worldbody>
    <actuator><position joint="z" kp="10"/></actuator>
    <keyframe><key name="home" qpos=".2" ctrl=".25"/></keyframe></mujoco>)");
  Write("drag.txt", "frames 1\ndrag table 0 0 1.2 30\nframes 10\nkey ctrl+s\nframes 1\n");
  Open("table.xml", {"--script", "drag.txt", "--out-mjcf", "saved.xml"});
  if (IsSkipped()) return;
  // Where the table is, is not in the ticks.
  while (program_->ReadLine()) continue;
  EXPECT_EQ(program_->Wait(), 0) << Read("errors");
  const Scene saved = Scene::FromFile(cwd() / "saved.xml");
  ASSERT_EQ(saved.KeyNames(), (std::vector<std::string>{"home", "home_pdg"}));
  const mjModel& m = *saved.model();
  EXPECT_NEAR(m.key_mpos[5], 1.2, 1e-9);
  EXPECT_NEAR(m.key_qpos[1], 0.3, 1e-5);
  EXPECT_NEAR(m.key_ctrl[1], 0.35, 1e-5);
}

TEST_F(CliViewTest, WhatCannotBeIsRefusedInOneLine) {
  Write("bad.txt", "frames 1\ndrag nobody 0 0 0 1\n");
  Write("row.txt", "row nowhere\n");
  ExpectRefused({"view"}, "MODEL is required");
  ExpectRefused({"view", "none.xml"}, "none.xml");
  ExpectRefused({"view", "swing.xml", "--key", "far"}, "no keyframe 'far'");
  ExpectRefused({"view", "swing.xml", "--qpos", "1 2"}, "--qpos");
  ExpectRefused({"view", "swing.xml", "--script", "bad.txt"}, "bad.txt line 2: no body 'nobody'");
  ExpectRefused({"view", "swing.xml", "--script", "row.txt"}, "a row 'nowhere'");
  ExpectRefused({"view", "swing.xml", "--script", "none.txt"}, "none.txt: no such file");
  ExpectRefused({"view", "swing.xml", "--out-mjcf", "swing.xml"}, "--out-mjcf");
  ExpectRefused({"view", "swing.xml", "--json", "none/a.json"},
                "--json: none/a.json: no such folder");
}

TEST_F(CliTest, AViewWithoutADisplayIsRefusedInOneLine) {
  if (Run({"view", "--help"}).exit_code != 0) {
    GTEST_SKIP() << "the program was built without GLFW or Dear ImGui";
  }
  const std::string display = std::getenv("DISPLAY") ? std::getenv("DISPLAY") : "";
  const std::string wayland = std::getenv("WAYLAND_DISPLAY") ? std::getenv("WAYLAND_DISPLAY") : "";
  setenv("DISPLAY", ":98765", 1);
  unsetenv("WAYLAND_DISPLAY");
  ExpectRefused({"view", "scene.xml"}, "no window: there is no display");
  display.empty() ? unsetenv("DISPLAY") : setenv("DISPLAY", display.c_str(), 1);
  if (!wayland.empty()) setenv("WAYLAND_DISPLAY", wayland.c_str(), 1);
}

}  // namespace
}  // namespace mjcf_pdg::test
