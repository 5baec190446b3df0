// The view as its user drives it, without a window: keys, mouse, scripts, rows, iterations.
#include "apps/view/viewer.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using app::Configuration;
using app::KeyPress;
using app::ParseKey;
using app::ParseScript;
using app::Timeline;
using app::Viewer;
using app::ViewServices;
using ::testing::HasSubstr;

constexpr char kScene[] = R"(<mujoco><worldbody>
  <geom name="box" type="box" size=".5 .5 .5"/>
  <body name="ball"><joint name="x" type="slide" axis="1 0 0"/>
    <joint name="y" type="slide" axis="0 1 0" range="-2 3" limited="true"/>
    <geom name="ball" size=".1"/></body></worldbody></mujoco>)";

std::vector<Configuration> Rows(const std::vector<std::vector<double>>& qs) {
  std::vector<Configuration> rows;
  for (const std::vector<double>& q : qs) {
    rows.emplace_back();
    rows.back().label = "row" + std::to_string(rows.size() - 1);
    rows.back().q = q;
  }
  return rows;
}

class ViewerTest : public MujocoTest {
 protected:
  ViewServices Services() {
    ViewServices services;
    services.load = [this](const std::string& path) {
      if (path != "more.npy") throw Error(path + ": no such file");
      return Rows({{2, 2}});
    };
    services.save = [this](const std::string&, const Configuration& row, const Result& result) {
      saved_.push_back(result.q);
      return row.label + "_pdg";
    };
    services.ticked = [this](const Configuration&, const Result& result) {
      ticked_.push_back(result);
    };
    return services;
  }
  Viewer Make(const std::vector<std::vector<double>>& qs) {
    return Viewer(scene_, {}, Rows(qs), Services());
  }

  const Scene scene_ = Scene::FromString(kScene);
  std::vector<std::vector<double>> saved_;
  std::vector<Result> ticked_;
};

TEST_F(ViewerTest, TheGhostFollowsASliderAndStopsWhenPaused) {
  Viewer viewer = Make({{-1, 0}});
  viewer.NextFrame();
  EXPECT_EQ(viewer.result()->status, Status::kAlreadyFree);
  viewer.SetJoint(0, -0.4);
  for (int frame = 0; frame < 5; ++frame) {  // a jump takes the follower some ticks
    viewer.NextFrame();
    EXPECT_EQ(viewer.result()->status, Status::kSolved);
    EXPECT_TRUE(Verify(scene_, *viewer.ghost_q()).free);
  }
  EXPECT_NEAR((*viewer.ghost_q())[0], -0.6, 1e-5);
  EXPECT_EQ(viewer.session().command(), (std::vector{-0.4, 0.0}));

  viewer.Press(ParseKey("space"));
  viewer.SetJoint(1, 0.05);
  viewer.NextFrame();
  EXPECT_EQ((*viewer.ghost_q())[1], 0.0) << "paused";
  viewer.Press(ParseKey("right"));
  viewer.NextFrame();
  EXPECT_NEAR((*viewer.ghost_q())[1], 0.05, 1e-3) << "one tick";
  viewer.SetJoint(1, 0.1);
  viewer.NextFrame();
  EXPECT_NEAR((*viewer.ghost_q())[1], 0.05, 1e-3);

  viewer.Press(ParseKey("backspace"));
  viewer.NextFrame();
  EXPECT_EQ(viewer.session().command(), (std::vector{-1.0, 0.0}));
}

TEST_F(ViewerTest, ABodyIsSelectedAndDraggedByTheMouse) {
  Viewer viewer = Make({{-1, 0}});
  app::GhostScene& scene = viewer.ghost_scene();
  scene.camera.lookat[0] = -1;
  scene.camera.distance = 4;
  scene.camera.azimuth = 90;  // looks along y, x to the right
  scene.camera.elevation = 0;
  viewer.NextFrame();
  const double aspect = 1.5;
  viewer.PressButton({.left = true}, 0.75, 0.5, aspect, true);
  EXPECT_EQ(scene.perturb.select, mj_name2id(scene_.model(), mjOBJ_BODY, "ball"));
  viewer.ReleaseButton();

  const app::Held held = {.right = true, .ctrl = true};
  viewer.PressButton(held, 0.75, 0.5, aspect, false);
  for (int frame = 0; frame < 30; ++frame) {
    viewer.MoveMouse(held, 0.005, 0);
    viewer.NextFrame();
    EXPECT_TRUE(Verify(scene_, *viewer.ghost_q()).free) << frame;
  }
  // The window shows 2 tan(fovy / 2) * distance in its height.
  const double shown = 2 * std::tan(0.5 * scene_.model()->vis.global.fovy * mjPI / 180) * 4;
  EXPECT_NEAR(viewer.session().command()[0], -1 + 0.15 * shown, 0.1 * shown * 0.15);
  EXPECT_EQ(viewer.result()->status, Status::kSolved);
  viewer.ReleaseButton();
  const std::vector<double> command = viewer.session().command();
  viewer.MoveMouse({.right = true}, 0.1, 0);  // the camera now
  EXPECT_EQ(viewer.session().command(), command);
  EXPECT_NE(scene.camera.lookat[0], -1);
}

TEST_F(ViewerTest, TheCameraObeysItsKeysAndButtons) {
  Viewer viewer = Make({{-1, 0}});
  mjvCamera& camera = viewer.ghost_scene().camera;
  const mjvCamera before = camera;
  viewer.NextFrame();
  viewer.MoveMouse({.left = true}, 0.1, 0.1);
  EXPECT_NE(camera.azimuth, before.azimuth);
  EXPECT_NE(camera.elevation, before.elevation);
  viewer.Scroll(-1);
  EXPECT_LT(camera.distance, before.distance);
  viewer.Press(ParseKey("ctrl+a"));
  EXPECT_EQ(camera.azimuth, before.azimuth);
  EXPECT_EQ(camera.distance, before.distance);
  viewer.Press(ParseKey("]"));
  EXPECT_EQ(camera.type, mjCAMERA_FREE) << "the model has no camera";
  viewer.Press(ParseKey("c"));
  EXPECT_EQ(viewer.ghost_scene().option.flags[mjVIS_CONTACTPOINT], 1);
  viewer.Press(ParseKey("0"));
  EXPECT_EQ(viewer.ghost_scene().option.geomgroup[0], 0);
}

TEST_F(ViewerTest, ASolveIsSteppedThrough) {
  Viewer viewer = Make({{-0.4, 0.1}});
  viewer.NextFrame();
  viewer.Run(ParseScript("solve\nstep 0\nframes 1\nkey right\nframes 1\nstep -1\nframes 1",
                         "script", viewer.model()));
  viewer.NextFrame();
  ASSERT_TRUE(viewer.record());
  EXPECT_EQ(viewer.timeline(), Timeline::kSearch);
  EXPECT_EQ(*viewer.ghost_q(), (std::vector{-0.4, 0.1})) << "where the search begins";
  viewer.NextFrame();
  EXPECT_EQ(viewer.step(), 1u);
  EXPECT_EQ(*viewer.ghost_q(), viewer.record()->steps[1].q);
  viewer.NextFrame();
  EXPECT_EQ(*viewer.ghost_q(), viewer.record()->result.q);
  EXPECT_FALSE(viewer.done());
  viewer.NextFrame();
  EXPECT_TRUE(viewer.done());
  // The hand goes on where it was.
  viewer.SetJoint(0, -0.3);
  EXPECT_EQ(viewer.timeline(), Timeline::kLive);
  viewer.NextFrame();
  EXPECT_EQ(viewer.session().result()->status, Status::kSolved);
}

TEST_F(ViewerTest, ASearchBesideTheFramesIsShownWhenItHasEnded) {
  Viewer viewer = Make({{-0.4, 0.1}});
  viewer.Press(ParseKey("enter"));
  for (int frame = 0; viewer.searching() && frame < 1000000; ++frame) viewer.NextFrame();
  ASSERT_TRUE(viewer.record());
  EXPECT_EQ(viewer.step(), viewer.record()->steps.size() - 1);
  viewer.Press(ParseKey("left"));
  viewer.NextFrame();
  EXPECT_EQ(viewer.step(), viewer.record()->steps.size() - 2);
  viewer.Press(ParseKey("right"));
  viewer.Press(ParseKey("space"));  // at the end: from the beginning
  viewer.NextFrame();
  EXPECT_EQ(viewer.step(), 1u);
  for (std::size_t frame = 0; frame <= viewer.record()->steps.size(); ++frame) viewer.NextFrame();
  EXPECT_EQ(viewer.step(), viewer.record()->steps.size() - 1) << "played to its end";
  EXPECT_FALSE(viewer.running());
}

TEST_F(ViewerTest, RowsArePlayedAndFollowed) {
  std::vector<std::vector<double>> qs;
  for (int k = 0; k < 50; ++k) qs.push_back({-1 + 0.02 * k, 0.0});
  Viewer viewer = Make(qs);
  viewer.PlayRows();
  for (int frame = 0; viewer.running() && frame < 100; ++frame) {
    viewer.NextFrame();
    EXPECT_TRUE(Verify(scene_, *viewer.ghost_q()).free) << frame;
  }
  EXPECT_EQ(viewer.row(), 49u);
  EXPECT_EQ(viewer.session().command(), qs.back());
  viewer.Press(ParseKey("up"));
  viewer.NextFrame();
  EXPECT_EQ(viewer.session().command(), qs[48]);
  viewer.Open("more.npy");
  EXPECT_EQ(viewer.rows().size(), 1u);
  viewer.Open("less.npy");
  EXPECT_EQ(viewer.rows().size(), 1u);
  EXPECT_EQ(viewer.message(), "less.npy: no such file");
}

TEST_F(ViewerTest, TheClipboardHasAKeyThatCanBePasted) {
  Viewer viewer = Make({{-0.4, 0.1}});
  viewer.NextFrame();
  viewer.Press(ParseKey("ctrl+c"));
  EXPECT_EQ(viewer.TakeClipboard(), "<key qpos=\"-0.4 0.1\"/>");
  EXPECT_EQ(viewer.TakeClipboard(), "");
  viewer.Press(ParseKey("ctrl+shift+r"));
  const std::string repaired = viewer.TakeClipboard();
  const std::vector<double> q = *viewer.ghost_q();
  viewer.Paste("<key name='a'\n qpos='1 -1'/>");
  EXPECT_EQ(viewer.session().command(), (std::vector{1.0, -1.0}));
  viewer.Paste(repaired);
  EXPECT_EQ(viewer.session().command(), q) << "all digits";
  for (const char* text : {"", "1", "1 x", "1 nan", "qpos=\"1 2", "qpos="}) {
    viewer.Paste(text);
    EXPECT_EQ(viewer.session().command(), q) << text;
  }
  EXPECT_NE(viewer.message(), "");

  viewer.solve_command = "mjcf-pdg solve ball.xml";
  viewer.SetJoint(0, 0.1);
  viewer.SetJoint(1, -0.25);
  viewer.CopySolveCommand();
  EXPECT_EQ(viewer.TakeClipboard(), "mjcf-pdg solve ball.xml --qpos \"0.10000000000000001 -0.25\"");
}

TEST_F(ViewerTest, OnlyWhatIsFreeIsSaved) {
  Viewer viewer = Make({{-0.4, 0.1}});
  viewer.Press(ParseKey("ctrl+s"));
  EXPECT_THAT(viewer.message(), HasSubstr("nothing is repaired yet"));
  viewer.NextFrame();
  viewer.Press(ParseKey("ctrl+s"));
  ASSERT_EQ(saved_.size(), 1u);
  EXPECT_EQ(saved_[0], *viewer.ghost_q());
  EXPECT_THAT(viewer.message(), HasSubstr("keyframe row0_pdg saved"));

  const Scene tight = Scene::FromString(R"(<mujoco><worldbody><geom type="box" size="5 5 5"/>
    <body><joint type="slide" range="-1 1" limited="true"/><geom size=".1"/></body>
    </worldbody></mujoco>)");
  Viewer stuck(tight, {}, Rows({{0}}), Services());
  stuck.NextFrame();
  stuck.Press(ParseKey("ctrl+s"));
  EXPECT_THAT(stuck.message(), HasSubstr("not saved: not free"));
  EXPECT_EQ(saved_.size(), 1u);
}

TEST_F(ViewerTest, ACommandAtRestIsLeftAlone) {
  Viewer viewer = Make({{-0.4, 0.1}});
  for (int frame = 0; frame < 200; ++frame) viewer.NextFrame();
  EXPECT_EQ(ticked_.size(), 120u);
  viewer.SetJoint(0, -0.41);
  viewer.NextFrame();
  EXPECT_EQ(ticked_.size(), 121u);
}

TEST_F(ViewerTest, AScriptThatAsksForARowThatIsNotThereIsRefused) {
  Viewer viewer = Make({{-0.4, 0.1}});
  EXPECT_THROW(viewer.Run(ParseScript("row home", "script", viewer.model())), Error);
}

// At sixty frames a second the pelvis is pulled through the bench within two seconds, and a hand
// through the seat.
TEST_F(ViewerTest, AFigureIsDraggedThroughABenchAndIsFreeInEveryFrame) {
  const Scene scene = Scene::FromFile(MJCF_PDG_MODEL_DIR "/figure/figure_bench.xml");
  Configuration row;
  row.label = "home";
  row.q = scene.KeyQpos(0);
  Viewer viewer(scene, {}, {row}, Services());
  viewer.Run(ParseScript("frames 1\ndrag pelvis -0.6 0.4 -0.3 120\ndrag left_hand 0 0 -0.6 60",
                         "script", viewer.model()));
  int frames = 0, colliding = 0;
  double deepest = 0;
  for (; !viewer.done(); ++frames) {
    viewer.NextFrame();
    const Result& result = *viewer.result();
    const Verdict verdict = Verify(scene, *viewer.ghost_q());
    EXPECT_TRUE(verdict.free) << frames << ": " << verdict.reason;
    EXPECT_LE(result.sigma_lower_bound, result.sigma * (1 + 1e-9) + 1e-12);
    colliding += !result.contacts_in.empty();
    deepest = std::min(deepest, result.depth_in);
  }
  EXPECT_EQ(frames, 182);
  EXPECT_GE(colliding, 120);
  EXPECT_LT(deepest, -0.1) << "it went through";
}

}  // namespace
}  // namespace mjcf_pdg::test
