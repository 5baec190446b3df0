// mjcf-pdg plan --speeds: times in the JSON, in keyframes and in the trajectory, and what is
// refused.
#include <cmath>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;

// A ball of radius 0.1 on two slides and a hinge, and a wall with a gap at y = 0.
constexpr char kGap[] = R"(<mujoco><option timestep=".01"/><worldbody>
  <geom name="lower" type="box" size=".1 1 .5" pos="0 -1.15 0"/>
  <geom name="upper" type="box" size=".1 1 .5" pos="0 1.15 0"/>
  <body name="ball">
    <joint name="x" type="slide" axis="1 0 0" range="-1 1" limited="true"/>
    <joint name="y" type="slide" axis="0 1 0" range="-1 1" limited="true"/>
    <joint name="spin" axis="0 0 1"/>
    <geom name="sphere" size=".1"/>
  </body></worldbody>
  <keyframe><key name="start" qpos="-.5 .5 0"/><key name="goal" qpos=".5 .5 1"/></keyframe></mujoco>)";

class CliTrajectoryTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    if (kProgram) Write("gap.xml", kGap);
  }
  static Arguments Timed(const Arguments& more) {
    Arguments arguments = {"plan", "gap.xml", "--start", "start", "--goal", "goal"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(CliTrajectoryTest, TimesComeWithThePath) {
  const Outcome outcome =
      Run(Timed({"--speeds", "0.5/2,y=0.25", "--accelerations", "4", "--json", "p.json",
                 "--out-trajectory", "t.jsonl", "--out-mjcf", "keys.xml"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("duration"), std::string::npos) << outcome.out;
  const Json plan = Json::parse(Read("p.json"));
  const Json &path = plan["path"], &times = plan["times"];
  ASSERT_EQ(times.size(), path.size());
  EXPECT_EQ(times.front(), 0.0);

  const std::vector<Json> rows = ParseLines(Read("t.jsonl"));
  std::size_t corner = 0;
  const double limits[] = {0.5, 0.25, 2.0};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_NEAR(rows[k]["time"], 0.01 * static_cast<double>(k), 1e-9);  // the model's time step
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_LE(std::abs(rows[k]["qvel"][j].get<double>()), limits[j] + 1e-6);
    }
    if (corner < times.size() && rows[k]["time"] == times[corner]) {
      EXPECT_EQ(rows[k]["qpos"], path[corner]);
      EXPECT_EQ(rows[k]["qvel"], (Json{0.0, 0.0, 0.0}));
      ++corner;
    }
  }
  EXPECT_EQ(corner, times.size());
  EXPECT_EQ(rows.back()["time"], times.back());

  // Keyframes have the times, and every row of the trajectory is free.
  EXPECT_NE(Read("keys.xml").find("name=\"path_pdg_2\" time="), std::string::npos)
      << Read("keys.xml");
  EXPECT_EQ(Run({"check", "gap.xml", "--qpos-file", "t.jsonl"}).exit_code, 0);
}

TEST_F(CliTrajectoryTest, EveryKindOfFileHasTheSameRows) {
  const auto rows = [this](const std::string& file) {
    const Outcome outcome =
        Run(Timed({"--speeds", "1", "--time-step", "0.05", "--out-trajectory", file}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Read(file);
  };
  std::string csv = rows("t.csv"), txt = rows("t.txt");
  const std::string npy = rows("t.npy");
  const auto lines = static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n'));
  EXPECT_GT(lines, 20u);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), ','), static_cast<long>(6 * lines));  // 1 + 3 + 3
  std::replace(csv.begin(), csv.end(), ',', ' ');
  EXPECT_EQ(csv, txt);
  EXPECT_NE(npy.substr(0, 128).find("(" + std::to_string(lines) + ", 7)"), std::string::npos);
  EXPECT_EQ(npy.size(), 128 + lines * 7 * sizeof(double));
}

TEST_F(CliTrajectoryTest, ThePathIsTheSameWithoutTimes) {
  const Json with = Json::parse(Run(Timed({"--speeds", "1", "--json", "-"})).out);
  const Json without = Json::parse(Run(Timed({"--json", "-"})).out);
  EXPECT_EQ(with["path"], without["path"]);
  EXPECT_FALSE(without.contains("times"));
}

// The straight motion takes 893,000 steps, the path, through the gap, more than a million.
TEST_F(CliTrajectoryTest, APathThatTakesTooLongIsWrittenWithoutTimes) {
  const Outcome outcome = Run(Timed({"--speeds", "1.12", "--time-step", "1e-6", "--json", "p.json",
                                     "--out-qpos", "p.csv", "--out-trajectory", "t.npy"}));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("more than a million steps"), std::string::npos) << outcome.err;
  const Json json = Json::parse(Read("p.json"));
  EXPECT_EQ(json["found"], true);
  EXPECT_FALSE(json.contains("times"));
  EXPECT_EQ(Run({"check", "gap.xml", "--qpos-file", "p.csv"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(cwd() / "t.npy"));
}

TEST_F(CliTrajectoryTest, BadInputIsRefused) {
  ExpectRefused(Timed({"--speeds", "0"}), "--speeds: '0' is not a positive number");
  ExpectRefused(Timed({"--speeds", "1/-2"}), "--speeds: '1/-2'");
  ExpectRefused(Timed({"--speeds", "fast"}), "--speeds");
  ExpectRefused(Timed({"--speeds", ""}), "--speeds");
  ExpectRefused(Timed({"--speeds", "1,,2"}), "--speeds");
  ExpectRefused(Timed({"--speeds", "1,z=2"}), "--speeds: no joint 'z' (joints: x, y, spin)");
  ExpectRefused(Timed({"--speeds", "x=1,y=1"}), "no speed for joint 'spin'");
  ExpectRefused(Timed({"--speeds", "1", "--accelerations", "x="}), "--accelerations");
  ExpectRefused(Timed({"--accelerations", "1"}), "--accelerations needs --speeds");
  ExpectRefused(Timed({"--time-step", "1"}), "--time-step needs --speeds");
  ExpectRefused(Timed({"--out-trajectory", "t.csv"}), "--out-trajectory needs --speeds");
  ExpectRefused(Timed({"--speeds", "1", "--time-step", "0"}), "--time-step");
  ExpectRefused(Timed({"--speeds", "1", "--out-trajectory", "t.doc"}), "--out-trajectory");
  ExpectRefused(Timed({"--speeds", "1e-9"}),
                "more than a million steps of the trajectory (--speeds, --time-step)");
  // Before any path is sought.
  ExpectRefused(Timed({"--speeds", "1e-9", "--time-limit", "1e-6"}), "more than a million steps");
}

}  // namespace
}  // namespace mjcf_pdg::test
