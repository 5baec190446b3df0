// Models that use MuJoCo's plugins, its own and those of --plugin-dir.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "tests/support/cli_test.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

namespace fs = std::filesystem;

class CliPluginsTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    if (IsSkipped()) return;
    Write("ring.xml", kRing);
    Write("idle.xml", kIdle);
  }

  // A ring lying 2 cm deep in the floor, by the plugin of MuJoCo's own that has such SDFs.
  static constexpr char kRing[] = R"(<mujoco><extension><plugin plugin="mujoco.sdf.torus">
    <instance name="ring"><config key="radius1" value=".35"/><config key="radius2" value=".15"/>
    </instance></plugin></extension>
    <asset><mesh name="ring"><plugin instance="ring"/></mesh></asset>
    <worldbody><geom name="floor" type="plane" size="2 2 1"/>
    <body name="ring" pos="0 0 .13"><joint type="slide" axis="0 0 1"/>
    <geom name="ring" type="sdf" mesh="ring"><plugin instance="ring"/></geom></body></worldbody>
    </mujoco>)";

  static constexpr char kIdle[] = R"(<mujoco><extension><plugin plugin="test.idle"/></extension>
    <worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 .05"><joint type="slide" axis="0 0 1"/>
    <geom size=".1"/><plugin plugin="test.idle"/></body></worldbody></mujoco>)";
};

TEST_F(CliPluginsTest, EveryCommandLoadsMujocosOwn) {
  const nlohmann::json solved = SolveJson({"ring.xml"})[0];
  EXPECT_EQ(solved["status"], "solved");
  EXPECT_NEAR(solved["qpos"][0].get<double>(), 0.02, 1e-3);
  EXPECT_EQ(Run({"check", "ring.xml"}).exit_code, 3);
  EXPECT_EQ(Run({"check", "ring.xml", "--qpos", ".03"}).exit_code, 0);
  EXPECT_EQ(Run({"norm", "ring.xml", "--from", "0", "--to", "1"}).exit_code, 0);
  EXPECT_EQ(Run({"audit", "ring.xml", "--samples", "10"}).exit_code, 3) << "qpos0 penetrates";
  const Outcome regress = Run({"regress", "--discover", ".", "--update"});
  EXPECT_EQ(regress.exit_code, 0) << regress.err;
  EXPECT_NE(Read("pdg.json").find("ring.xml"), std::string::npos);
  // The scene with its repaired keyframe needs the plugin as well.
  ASSERT_EQ(Run({"solve", "ring.xml", "--out-mjcf", "out/"}).exit_code, 0);
  EXPECT_EQ(Run({"check", "out/ring.xml", "--key", "qpos0_pdg"}).exit_code, 0);
}

TEST_F(CliPluginsTest, SensorsAndActuatorsOfPluginsDoNoHarm) {
  Write("servo.xml", R"(<mujoco><extension><plugin plugin="mujoco.pid"/>
    <plugin plugin="mujoco.sensor.touch_grid"/></extension>
    <worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 .05">
      <joint name="z" type="slide" axis="0 0 1"/><geom size=".1"/><site name="skin"/></body>
    </worldbody>
    <actuator><plugin joint="z" plugin="mujoco.pid"><config key="kp" value="40"/></plugin></actuator>
    <sensor><plugin plugin="mujoco.sensor.touch_grid" objtype="site" objname="skin">
      <config key="size" value="2 2"/><config key="fov" value="10 10"/><config key="gamma" value="0"/>
      <config key="nchannel" value="1"/></plugin></sensor></mujoco>)");
  EXPECT_NEAR(SolveJson({"servo.xml", "--threads", "2"})[0]["qpos"][0].get<double>(), 0.05, 1e-5);
}

// A ball that lies 5 cm deep in a plate is lifted, and with it what the plugin pulls it to: its
// control and, of one whose control may only change so fast, the control of the last step.
TEST_F(CliPluginsTest, TheSetpointOfAPidGoesAlongWithTheRepairedKeyframe) {
  const auto model = [](const std::string& config) {
    return R"(<mujoco><extension><plugin plugin="mujoco.pid"/></extension><worldbody>
      <geom type="box" size="1 1 .1"/><body pos="0 0 1"><joint name="z" type="slide" axis="0 0 1"/>
      <geom size=".1"/></body></worldbody><actuator><motor joint="z"/><plugin joint="z"
      plugin="mujoco.pid"><config key="kp" value="40"/>)" +
           config + R"(</plugin></actuator><keyframe><key name="deep" qpos="-.85" ctrl=".3 -.9"/>
      </keyframe></mujoco>)";
  };
  // The n-th number of an attribute of the repaired keyframe.
  const auto number = [this](const std::string& attribute, int n) {
    const std::string text = Read("out.xml");
    const std::size_t key = text.find("deep_pdg"), at = text.find(attribute + "=\"", key);
    EXPECT_NE(at, std::string::npos) << text;
    std::istringstream numbers(text.substr(at + attribute.size() + 2));
    double value = 0.0;
    for (int k = 0; k <= n; ++k) numbers >> value;
    return value;
  };
  Write("pid.xml", model(""));
  ASSERT_EQ(Run({"solve", "pid.xml", "--key", "deep", "--out-mjcf", "out.xml"}).exit_code, 0);
  EXPECT_NEAR(number("ctrl", 1), -0.85, 1e-5) << "as far below the joint as before";
  EXPECT_EQ(number("ctrl", 0), 0.3) << "a motor's control is no place";
  std::string limited = model(R"(<config key="ki" value="1"/><config key="slewmax" value="1"/>)");
  limited.insert(limited.find(" plugin=\"mujoco.pid\"><config"), " actdim=\"2\"");
  limited.insert(limited.find(" ctrl="), " act=\".01 -.95\"");
  Write("pid.xml", limited);
  ASSERT_EQ(Run({"solve", "pid.xml", "--key", "deep", "--out-mjcf", "out.xml"}).exit_code, 0);
  EXPECT_NEAR(number("act", 1), -0.9, 1e-5);
  EXPECT_EQ(number("act", 0), 0.01) << "the integral of the error is no place";
}

TEST_F(CliPluginsTest, OthersAreLoadedFromTheirFolder) {
  const std::string folder = MJCF_PDG_TEST_PLUGIN_DIR;
  EXPECT_EQ(SolveJson({"idle.xml", "--plugin-dir", folder})[0]["status"], "solved");
  EXPECT_EQ(SolveJson({"ring.xml", "--plugin-dir", folder})[0]["status"], "solved");
  for (const Arguments& arguments : {Arguments{"solve", "idle.xml"},
                                     {"check", "idle.xml"},
                                     {"audit", "idle.xml"},
                                     {"norm", "idle.xml", "--from", "0", "--to", "1"},
                                     {"solve", "idle.xml", "--out-mjcf", "out.xml"}}) {
    ExpectRefused(arguments, "plugin test.idle not found");
    ExpectRefused(arguments, "loaded: mujoco.pid, mujoco.sdf.bolt");
    ExpectRefused(arguments, "--plugin-dir");
  }
}

TEST_F(CliPluginsTest, WhatCannotBeLoadedIsSaid) {
  ExpectRefused({"check", "ring.xml", "--plugin-dir", "none"}, "none: no such folder");
  fs::create_directory(cwd() / "empty");
  ExpectRefused({"check", "ring.xml", "--plugin-dir", "empty"}, "no plugin library");
  ExpectRefused({"check", "ring.xml", "--plugin-dir", ""}, "--plugin-dir");
  Write("junk/junk.so", "no library");
  ExpectRefused({"check", "ring.xml", "--plugin-dir", "junk"}, "junk.so: file too short");
}

// Two libraries with plugins of the same name, which MuJoCo refuses in the middle of loading; the
// second folder is not for people who have one of MuJoCo's own in theirs.
TEST_F(CliPluginsTest, ANameIsNotTakenTwice) {
  const fs::path folder = MJCF_PDG_TEST_PLUGIN_DIR;
  fs::create_directory(cwd() / "again");
  for (const auto& entry : fs::directory_iterator(folder)) {
    fs::copy(entry.path(), cwd() / "again" / entry.path().filename());
  }
  ExpectRefused({"check", "idle.xml", "--plugin-dir", folder, "--plugin-dir", "again"},
                "'test.idle' is already registered");
  EXPECT_EQ(Run({"solve", "idle.xml", "--plugin-dir", folder, "--plugin-dir", folder}).exit_code,
            0);
  fs::create_directory(cwd() / "own");
  for (const auto& entry : fs::directory_iterator(MJCF_PDG_MUJOCO_PLUGIN_DIR)) {
    fs::copy(entry.path(), cwd() / "own" / entry.path().filename());
  }
  EXPECT_EQ(SolveJson({"ring.xml", "--plugin-dir", "own"})[0]["status"], "solved");
}

TEST_F(CliPluginsTest, ABinaryModelThatUsesPluginsIsRefused) {
  mj_loadPluginLibrary((fs::path(MJCF_PDG_TEST_PLUGIN_DIR) / "libidle_plugin.so").c_str());
  const ModelPtr m = LoadModel(kIdle);
  mj_saveModel(m.get(), (cwd() / "idle.mjb").c_str(), nullptr, 0);
  ExpectRefused({"check", "idle.mjb"}, "pass the XML");
  EXPECT_NE(Scene::FromModel(m.get()).model(), nullptr) << "of this process the places are known";
}

}  // namespace
}  // namespace mjcf_pdg::test
