// What the program writes: exit codes, JSON, tables, files.
#include "tests/support/cli_test.h"

#include <mujoco/mujoco.h>

#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;

// Limits leave the ball no way out of the wall.
constexpr char kTrapped[] = R"(<mujoco><worldbody>
  <geom name="wall" type="box" size="1 1 .1"/>
  <body name="ball"><joint type="slide" range="-.1 .1"/><geom name="sphere" size=".1"/></body>
  </worldbody><keyframe><key name="stuck" qpos="0"/></keyframe></mujoco>)";

// The same qpos; the keyframes differ in where they put the mocap obstacle.
constexpr char kMocap[] = R"(<mujoco><worldbody>
  <body name="obstacle" mocap="true" pos="0 0 5"><geom size=".1"/></body>
  <body name="ball"><joint type="slide" axis="1 0 0"/><geom size=".1"/></body></worldbody>
  <keyframe><key name="far" mpos="0 0 3"/><key name="near" mpos="-.15 0 0"/><key name="again"/>
  </keyframe></mujoco>)";

std::string Rows(int n) {
  std::string text;
  Random random(7);
  for (int i = 0; i < n; ++i) {
    text += std::to_string(random.Uniform(-0.5, 0.5)) + " " +
            std::to_string(random.Uniform(-0.3, 0.1)) + "\n";
  }
  return text;
}

TEST_F(CliTest, EveryVerbHasHelpAndVersion) {
  for (const Arguments& verb : {Arguments{}, {"solve"}, {"norm"}, {"check"}, {"import"}}) {
    for (const std::string flag : {"--help", "--version"}) {
      Arguments arguments = verb;
      arguments.push_back(flag);
      const Outcome outcome = Run(arguments);
      EXPECT_EQ(outcome.exit_code, 0);
      EXPECT_EQ(outcome.err, "");
      EXPECT_NE(outcome.out.find(flag == "--help" ? "Usage" : "mjcf-pdg "), std::string::npos);
    }
  }
}

TEST_F(CliTest, ExitCodesTellWhatIsFree) {
  Write("trapped.xml", kTrapped);
  EXPECT_EQ(Run({"solve", "scene.xml"}).exit_code, 0);
  EXPECT_EQ(Run({"solve", "trapped.xml"}).exit_code, 3);
  EXPECT_EQ(Run({"check", "scene.xml"}).exit_code, 3);
  EXPECT_EQ(Run({"check", "scene.xml", "--key", "1"}).exit_code, 0);
  EXPECT_EQ(Run({"norm", "scene.xml", "--from", "0 0", "--to", "0 1"}).exit_code, 0);
}

TEST_F(CliTest, TheTableGoesToStdoutAndAPipeSeesNoProgress) {
  const Outcome outcome = Run({"solve", "scene.xml"});
  EXPECT_EQ(outcome.err, "");
  for (const char* words : {"deep", "key1", "solved", "already_free", "1 already free, 1 solved"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << outcome.out;
  }
}

TEST_F(CliTest, AJsonLineHasEveryField) {
  const Outcome outcome = Run({"solve", "scene.xml", "--json", "-"});
  const std::vector<Json> lines = ParseLines(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  for (const char* field :
       {"index", "status", "qpos_in", "qpos", "sigma", "rms", "sigma_lower_bound", "depth_in",
        "min_distance", "iterations", "collision_queries", "time_us", "start", "contacts_in",
        "contacts", "contacts_kept", "certified", "geometry", "proven"}) {
    for (const Json& line : lines) EXPECT_TRUE(line.contains(field)) << field;
  }
  EXPECT_EQ(lines[0]["index"], 0);
  EXPECT_EQ(lines[0]["name"], "deep");
  EXPECT_FALSE(lines[1].contains("name"));
  EXPECT_FALSE(lines[0].contains("reason"));
  EXPECT_EQ(lines[0]["status"], "solved");
  EXPECT_NEAR(lines[0]["sigma"], 0.05 * 0.05, 1e-6);  // straight up by the depth
  EXPECT_NEAR(lines[0]["rms"], 0.05, 1e-5);
  EXPECT_NEAR(lines[0]["depth_in"], -0.05, 1e-9);
  EXPECT_LE(lines[0]["sigma_lower_bound"], lines[0]["sigma"]);
  ASSERT_EQ(lines[0]["contacts_in"].size(), 1u);
  const Json& contact = lines[0]["contacts_in"][0];
  const std::set<std::string> geoms = {contact["geom1"], contact["geom2"]};
  EXPECT_EQ(geoms, (std::set<std::string>{"wall", "sphere"}));
  EXPECT_EQ(contact["normal"].size(), 3u);
  EXPECT_EQ(contact["position"].size(), 3u);
  EXPECT_NEAR(contact["distance"], -0.05, 1e-9);
}

TEST_F(CliTest, AFreeConfigurationComesBackBitForBit) {
  const std::vector<Json> lines =
      SolveJson({"scene.xml", "--qpos", "0.12345678901234566,0.30000000000000004"});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["status"], "already_free");
  EXPECT_EQ(lines[0]["qpos"], (std::vector<double>{0.12345678901234566, 0.30000000000000004}));
  EXPECT_EQ(lines[0]["sigma"], 0.0);
}

TEST_F(CliTest, AnUnsolvedRowSaysWhy) {
  Write("trapped.xml", kTrapped);
  const std::vector<Json> lines = SolveJson({"trapped.xml"});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["status"], "unsolved");
  EXPECT_NE(lines[0]["reason"], "");
  EXPECT_EQ(lines[0]["qpos"].size(), 1u);
}

TEST_F(CliTest, AnUnnamedGeomIsGivenByItsId) {
  Write("mocap.xml", kMocap);
  const std::vector<Json> lines = SolveJson({"mocap.xml", "--key", "near"});
  ASSERT_EQ(lines.at(0)["contacts_in"].size(), 1u);
  const Json& contact = lines[0]["contacts_in"][0];
  EXPECT_EQ(contact["geom1"].get<int>() + contact["geom2"].get<int>(), 1);
}

TEST_F(CliTest, ThreadsOrderAndCompanyChangeNothing) {
  constexpr int kRows = 12;
  Write("rows.txt", Rows(kRows));
  const std::vector<Json> one = SolveJson({"scene.xml", "--qpos-file", "rows.txt"});
  ASSERT_EQ(one.size(), std::size_t{kRows});
  const auto solved = std::count_if(one.begin(), one.end(),
                                    [](const Json& line) { return line["status"] == "solved"; });
  EXPECT_GT(solved, kRows / 3);
  EXPECT_EQ(SolveJson({"scene.xml", "--qpos-file", "rows.txt", "--threads", "3"}), one);

  std::istringstream stream(Rows(kRows));
  std::string line, reversed;
  for (int i = 0; std::getline(stream, line); ++i) {
    reversed.insert(0, line + "\n");
    Json alone = SolveJson({"scene.xml", "--qpos", line}).at(0);
    alone["index"] = i;
    EXPECT_EQ(alone.dump(), one[static_cast<std::size_t>(i)].dump());
  }
  std::vector<Json> backwards = SolveJson({"scene.xml", "--qpos-file", "-"}, reversed);
  std::reverse(backwards.begin(), backwards.end());
  for (std::size_t i = 0; i < backwards.size(); ++i) backwards[i]["index"] = i;
  EXPECT_EQ(backwards, one);
}

TEST_F(CliTest, EveryFileFormatCarriesTheSameNumbers) {
  constexpr char kText[] = "# a comment\n0.1 -0.05\r\n\n0.30000000000000004, +.25\n-1e-1,\t1\n";
  Write("rows.csv", kText);
  const std::vector<Json> expected = SolveJson({"scene.xml", "--qpos-file", "rows.csv"});
  ASSERT_EQ(expected.size(), 3u);
  // What is free stays as it is, so that repaired rows go round unchanged.
  ASSERT_EQ(Run({"solve", "scene.xml", "--qpos-file", "rows.csv", "--out-qpos", "a.npy"}).err, "");
  ASSERT_EQ(Run({"solve", "scene.xml", "--qpos-file", "a.npy", "--out-qpos", "a.csv"}).err, "");
  ASSERT_EQ(Run({"solve", "scene.xml", "--qpos-file", "a.csv", "--out-qpos", "a.txt"}).err, "");
  ASSERT_EQ(Run({"solve", "scene.xml", "--qpos-file", "a.txt", "--out-qpos", "a.jsonl"}).err, "");
  ASSERT_EQ(Run({"solve", "scene.xml", "--qpos-file", "a.jsonl", "--out-qpos", "b.npy"}).err, "");
  EXPECT_EQ(Read("a.npy"), Read("b.npy"));
  EXPECT_EQ(ParseLines(Read("a.jsonl")).size(), 3u);
  EXPECT_EQ(Run({"solve", "scene.xml", "--qpos-file", "-", "--out-qpos", "-"}, Read("b.npy")).out,
            Read("a.txt"));
  const std::vector<Json> again = SolveJson({"scene.xml", "--qpos-file", "-"}, Read("b.npy"));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(again.at(i)["qpos_in"], expected[i]["qpos"]);
}

TEST_F(CliTest, KeyframesMoveMocapBodies) {
  Write("mocap.xml", kMocap);
  const std::vector<Json> lines = SolveJson({"mocap.xml"});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0]["status"], "already_free");
  EXPECT_EQ(lines[1]["status"], "solved");
  EXPECT_NEAR(lines[1]["qpos"][0], 0.05, 1e-5);
  EXPECT_EQ(lines[2]["status"], "already_free");  // mocap at the body's own place
  EXPECT_EQ(Run({"check", "mocap.xml", "--key", "near"}).exit_code, 3);
  EXPECT_EQ(Run({"check", "mocap.xml", "--key", "far"}).exit_code, 0);
}

TEST_F(CliTest, CheckTellsPairsDepthsAndLimits) {
  const Outcome table = Run({"check", "scene.xml"});
  for (const char* words : {"wall", "sphere", "50", "1 free, 1 not free"}) {
    EXPECT_NE(table.out.find(words), std::string::npos) << table.out;
  }
  const std::vector<Json> lines = ParseLines(Run({"check", "scene.xml", "--json", "-"}).out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["free"], false);
  EXPECT_NEAR(lines[0]["contacts"][0]["distance"], -0.05, 1e-9);
  EXPECT_EQ(lines[1]["free"], true);
  Write("trapped.xml", kTrapped);
  const Outcome limit = Run({"check", "trapped.xml", "--qpos", ".5"});
  EXPECT_EQ(limit.exit_code, 3);
  EXPECT_NE(limit.out.find("outside its range"), std::string::npos) << limit.out;
  EXPECT_EQ(Run({"check", "scene.xml", "--key", "deep", "--tolerance", ".06"}).exit_code, 0);
}

TEST_F(CliTest, SolveTellsWhatWasOutsideItsLimits) {
  Write("arm.xml", R"(<mujoco><worldbody><geom type="plane" size="1 1 .1"/><body pos="0 0 .2">
      <joint axis="0 1 0" range="-30 80"/><geom type="capsule" size=".05" fromto="0 0 0 .3 0 0"/>
      </body></worldbody></mujoco>)");
  const auto says_limits = [this](const std::string& qpos, const std::string& clearance) {
    const Outcome solve = Run({"solve", "arm.xml", "--qpos", qpos, "--clearance", clearance});
    return solve.out.find("limits") != std::string::npos;
  };
  EXPECT_TRUE(says_limits("-.7", "0"));
  EXPECT_FALSE(says_limits("0", "0"));
  EXPECT_FALSE(says_limits("0", ".17")) << "too near";
  EXPECT_FALSE(says_limits(".7", "0")) << "in the floor";
  EXPECT_TRUE(says_limits("1.5", "0")) << "in the floor as well";
}

TEST_F(CliTest, NormPartsAddUp) {
  const Outcome outcome =
      Run({"norm", "scene.xml", "--from", "0 0", "--to", ".1 .2", "--json", "-"});
  const Json norm = Json::parse(outcome.out);
  EXPECT_NEAR(norm["sigma"], 0.05, 1e-12);
  EXPECT_NEAR(norm["rms"], std::sqrt(0.05), 1e-12);
  ASSERT_EQ(norm["parts"].size(), 2u);
  EXPECT_EQ(norm["parts"][0]["name"], "x");
  EXPECT_NEAR(norm["parts"][0]["sigma"], 0.01, 1e-12);
  EXPECT_NEAR(norm["parts"][0]["moved"], 0.1, 1e-12);
  EXPECT_NE(Run({"norm", "scene.xml", "--from", "0 0", "--to", ".1 .2"}).out.find("0.05"),
            std::string::npos);
}

// ---- --out-mjcf ----

constexpr char kTetrahedron[] =
    "v 0 0 0\nv .2 0 0\nv 0 .2 0\nv 0 0 .2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

// A mesh in another folder, a mocap body, servos with and without room, a motor.
constexpr char kRobot[] = R"(<mujoco><compiler meshdir="../parts/meshes"/>
  <asset><mesh name="tetra" file="tetra.obj"/></asset><worldbody>
  <geom name="floor" type="plane" size="1 1 1"/>
  <body mocap="true" pos="3 0 3"><geom size=".1"/></body>
  <body pos="0.123456789012345 0 0"><joint name="z" type="slide"/><geom type="mesh" mesh="tetra"/>
    <body pos="0 0 1"><joint name="y" type="slide" axis="0 1 0"/><geom size=".1"/></body>
  </body></worldbody>
  <actuator><position joint="z" gear="2" kp="10"/><motor joint="z"/>
    <position joint="z" ctrlrange="-1 0.51"/><position joint="y"/></actuator>
  <keyframe><key name="sunk" time="2" qpos="-.1 .3" qvel="1 2" ctrl="-.25 7 .5 .3" mpos="4 0 4"/>
    <key name="home" qpos="1 0"/></keyframe></mujoco>)";

TEST_F(CliTest, ARepairedSceneLoadsWhereItIsWrittenAndKeepsTheRest) {
  Write("parts/meshes/tetra.obj", kTetrahedron);
  Write("robots/robot.xml", kRobot);
  Write("deep/down/keep", "");
  const Outcome outcome =
      Run({"solve", "robots/robot.xml", "--out-mjcf", "deep/down/fixed.xml", "--json", "r.jsonl"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  char error[500] = "";
  const ModelPtr m(mj_loadXML((cwd() / "deep/down/fixed.xml").c_str(), nullptr, error, 500));
  ASSERT_NE(m, nullptr) << error;
  ASSERT_EQ(m->nkey, 4);
  EXPECT_EQ(m->body_pos[3 * 2], 0.123456789012345);  // to the last digit
  const int key = mj_name2id(m.get(), mjOBJ_KEY, "sunk_pdg");
  ASSERT_GE(key, 0);
  EXPECT_GE(mj_name2id(m.get(), mjOBJ_KEY, "home_pdg"), 0);
  const std::vector<double> q(m->key_qpos + 2 * key, m->key_qpos + 2 * key + 2);
  EXPECT_EQ(Json(q), ParseLines(Read("r.jsonl")).at(0)["qpos"]);
  const double lift = q[0] + 0.1;
  EXPECT_NEAR(lift, 0.1, 1e-5);
  const double* ctrl = m->key_ctrl + 4 * key;
  EXPECT_NEAR(ctrl[0], -0.25 + 2.0 * lift, 1e-12);  // the gear doubles it
  EXPECT_EQ(ctrl[1], 7.0);                          // a motor's torque stays
  EXPECT_EQ(ctrl[2], 0.51);                         // no further than its range
  EXPECT_NEAR(ctrl[3], 0.3 + q[1] - 0.3, 1e-12);
  EXPECT_EQ(m->key_time[key], 2.0);
  EXPECT_EQ(m->key_qvel[2 * key + 1], 2.0);
  EXPECT_EQ(m->key_mpos[3 * key], 4.0);
  EXPECT_EQ(Run({"check", "deep/down/fixed.xml", "--key", "sunk_pdg"}).exit_code, 0);
}

TEST_F(CliTest, RepairingARepairedSceneReplacesItsKeyframes) {
  ASSERT_EQ(Run({"solve", "scene.xml", "--key", "deep", "--out-mjcf", "a.xml"}).exit_code, 0);
  ASSERT_EQ(Run({"solve", "a.xml", "--key", "deep", "--out-mjcf", "b.xml"}).exit_code, 0);
  EXPECT_EQ(Read("a.xml"), Read("b.xml"));
}

TEST_F(CliTest, AKeyframeThatIsAskedForTwiceComesOutTwice) {
  ASSERT_EQ(Run({"solve", "scene.xml", "--key", "deep", "--key", "deep", "--out-mjcf", "out.xml"})
                .exit_code,
            0);
  EXPECT_NE(Read("out.xml").find("\"deep_pdg\""), std::string::npos);
  EXPECT_NE(Read("out.xml").find("\"deep_pdg_2\""), std::string::npos);
}

TEST_F(CliTest, KeyframesOfAnAttachedModelAreKept) {
  Write("child.xml", R"(<mujoco><worldbody><body name="ball"><joint type="slide"/>
    <geom size=".1"/></body></worldbody><keyframe><key name="low" qpos=".05"/></keyframe></mujoco>)");
  Write("parent.xml", R"(<mujoco><asset><model name="child" file="child.xml"/></asset><worldbody>
    <geom type="plane" size="1 1 1"/><body><attach model="child" body="ball" prefix="a_"/></body>
    </worldbody></mujoco>)");
  ASSERT_EQ(Run({"solve", "parent.xml", "--key", "a_low", "--out-mjcf", "out.xml"}).exit_code, 0);
  EXPECT_EQ(Run({"check", "out.xml", "--key", "a_low"}).exit_code, 3);
  EXPECT_EQ(Run({"check", "out.xml", "--key", "a_low_pdg"}).exit_code, 0);
}

TEST_F(CliTest, UnsolvedRowsStayOutOfTheScene) {
  Write("trapped.xml", kTrapped);
  ASSERT_EQ(Run({"solve", "trapped.xml", "--out-mjcf", "out.xml"}).exit_code, 3);
  EXPECT_NE(Read("out.xml").find("stuck"), std::string::npos);
  EXPECT_EQ(Read("out.xml").find("stuck_pdg"), std::string::npos);
}

TEST_F(CliTest, AnUnnamedKeyframeGetsANameOfItsOwn) {
  Write("names.xml", R"(<mujoco><worldbody><body><joint type="slide"/><geom size=".1"/></body>
    </worldbody><keyframe><key name="key1" qpos="1"/><key qpos="2"/></keyframe></mujoco>)");
  ASSERT_EQ(Run({"solve", "names.xml", "--out-mjcf", "out.xml"}).exit_code, 0);
  const std::string text = Read("out.xml");
  EXPECT_NE(text.find("name=\"key1_pdg\" qpos=\"1\""), std::string::npos) << text;
  EXPECT_NE(text.find("name=\"key1__pdg\" qpos=\"2\""), std::string::npos) << text;
}

}  // namespace
}  // namespace mjcf_pdg::test
