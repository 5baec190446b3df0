// mjcf-pdg plan: what it writes, its exit codes, what it refuses.
#include <pty.h>
#include <signal.h>

#include "tests/support/cli_test.h"
#include "tests/support/report_file.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;

// A ball of radius 0.1 on two slides, and a wall 0.2 thick with a gap at y = 0.
constexpr char kGap[] = R"(<mujoco><worldbody>
  <geom name="lower" type="box" size=".1 1 .5" pos="0 -1.15 0"/>
  <geom name="upper" type="box" size=".1 1 .5" pos="0 1.15 0"/>
  <body name="ball">
    <joint name="x" type="slide" axis="1 0 0" range="-1 1" limited="true"/>
    <joint name="y" type="slide" axis="0 1 0" range="-1 1" limited="true"/>
    <geom name="sphere" size=".1"/>
  </body></worldbody>
  <keyframe><key name="start" qpos="-.5 .5"/><key name="goal" qpos=".5 .5"/>
            <key name="deep" qpos="-.15 .5"/></keyframe></mujoco>)";

class CliPlanTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    if (kProgram) Write("gap.xml", kGap);
  }
  static Arguments Ends(const std::string& start, const std::string& goal,
                        const Arguments& more = {}) {
    Arguments arguments = {"plan", "gap.xml", "--start", start, "--goal", goal};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(CliPlanTest, WritesThePath) {
  const Outcome outcome = Run(Ends("start", "goal",
                                   {"--planner", "birrt-pdg", "--seed", "3", "--json", "p.json",
                                    "--out-qpos", "p.csv", "--out-mjcf", "p.xml"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const Json json = Json::parse(Read("p.json"));
  EXPECT_EQ(json["found"], true);
  EXPECT_EQ(json["certified"], true);
  EXPECT_GT(json["time_us"], 0.0);
  EXPECT_GT(json["nodes"], 1);
  EXPECT_GT(json["collision_queries"], 10);
  // From (-.5, .5) to (.5, .5) by the gap's two mouths: 0.8 m at least.
  EXPECT_GT(json["length"], 1.2);
  EXPECT_LT(json["length"], 2.0);
  ASSERT_GE(json["path"].size(), 4u);
  EXPECT_EQ(json["path"].front(), (Json{-0.5, 0.5}));
  EXPECT_EQ(json["path"].back(), (Json{0.5, 0.5}));

  // The files hold the same path, and all of it is free.
  EXPECT_EQ(Run({"check", "gap.xml", "--qpos-file", "p.csv"}).exit_code, 0);
  Arguments keys = {"check", "p.xml", "--json", "-", "--key", "path_pdg"};
  for (std::size_t k = 2; k <= json["path"].size(); ++k) {
    keys.push_back("--key");
    keys.push_back("path_pdg_" + std::to_string(k));
  }
  const Outcome check = Run(keys);
  EXPECT_EQ(check.exit_code, 0) << check.err;
  EXPECT_EQ(ParseLines(check.out).size(), json["path"].size());
}

TEST_F(CliPlanTest, EdgesAreTheMotionsThatCheckProves) {
  const Outcome outcome = Run(Ends("0", "1", {"--json", "-"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json path = Json::parse(outcome.out)["path"];
  const auto text = [](const Json& q) { return q[0].dump() + " " + q[1].dump(); };
  for (std::size_t k = 1; k < path.size(); ++k) {
    const Outcome check =
        Run({"check", "gap.xml", "--motion", "--from", text(path[k - 1]), "--to", text(path[k])});
    EXPECT_EQ(check.exit_code, 0) << k;
  }
}

TEST_F(CliPlanTest, WaypointsAreWrittenInEveryFormat) {
  const Json path = Json::parse(Run(Ends("start", "goal", {"--json", "-"})).out)["path"];
  for (const std::string file : {"p.npy", "p.csv", "p.txt", "p.jsonl"}) {
    EXPECT_EQ(Run(Ends("start", "goal", {"--out-qpos", file})).exit_code, 0);
    const Outcome check = Run({"check", "gap.xml", "--qpos-file", file, "--json", "-"});
    EXPECT_EQ(check.exit_code, 0) << file;
    EXPECT_EQ(ParseLines(check.out).size(), path.size()) << file;
  }
  std::vector<Json> rows = ParseLines(Read("p.jsonl"));
  for (std::size_t k = 0; k < rows.size(); ++k) EXPECT_EQ(rows[k]["qpos"], path[k]);
}

TEST_F(CliPlanTest, SaysThatMocapBodiesStandAsAtTheStart) {
  std::string model = kGap;
  model.replace(model.find("<body "), 0, R"(<body name="post" mocap="true" pos="3 3 0">
    <geom size=".1"/></body>)");
  model.replace(model.find("<key name=\"goal\""), 0,
                R"(<key name="moved" qpos=".5 .5" mpos="3 4 0"/>)");
  Write("gap.xml", model);
  EXPECT_EQ(Run(Ends("start", "goal")).err, "");
  EXPECT_EQ(Run(Ends("start", ".5 .5")).err, "");
  const Outcome outcome = Run(Ends("start", "moved"));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("warning: mocap bodies stand as at the start"), std::string::npos)
      << outcome.err;
}

TEST_F(CliPlanTest, RepairsEndsAndSaysSo) {
  const Outcome outcome = Run(Ends("deep", ".5 .5", {"--json", "-"}));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("warning: the start is not free"), std::string::npos) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["start"]["status"], "solved");
  EXPECT_NEAR(json["start"]["sigma"], 0.0025, 1e-4);
  EXPECT_EQ(json["goal"]["status"], "already_free");
}

TEST_F(CliPlanTest, WhatIsNotFoundExitsThreeAndWritesNoPath) {
  Write("gap.xml", std::string(kGap).replace(std::string(kGap).find("1.15 0"), 4, "1.05"));
  const Outcome outcome = Run(Ends(
      "-.5 .5", ".5 .5",
      {"--time-limit", "200", "--json", "p.json", "--out-qpos", "p.npy", "--out-mjcf", "p.xml"}));
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.out.find("no path"), std::string::npos);
  const Json json = Json::parse(Read("p.json"));
  EXPECT_EQ(json["found"], false);
  EXPECT_EQ(json["path"], Json::array());
  EXPECT_NE(json["reason"], "");
  EXPECT_FALSE(std::filesystem::exists(cwd() / "p.npy"));
  EXPECT_FALSE(std::filesystem::exists(cwd() / "p.xml"));
}

// Ctrl-C on a terminal, where the bar tells that it plans, and SIGTERM. There is no path.
TEST_F(CliPlanTest, AnInterruptEndsTheSearchAndWritesWhatThereIs) {
  Write("gap.xml", std::string(kGap).replace(std::string(kGap).find("1.15 0"), 4, "1.05"));
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, {SIGTERM, 143}}) {
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
      if (chdir(cwd().c_str()) != 0) _exit(99);
      execl(kProgram, kProgram, "plan", "gap.xml", "--start", "-.5 .5", "--goal", ".5 .5",
            "--time-limit", "60000", "--json", "p.json", "--out-qpos", "p.csv", nullptr);
      _exit(99);
    }
    std::string said;
    bool asked = false;
    char piece[1000];
    for (ssize_t n; (n = read(terminal, piece, sizeof piece)) > 0;) {
      said.append(piece, static_cast<std::size_t>(n));
      if (asked || said.find("planning, at most so many ms (60000)") == std::string::npos) continue;
      asked = true;
      if (signal == SIGINT) {
        ASSERT_EQ(write(terminal, "\x03", 1), 1);
      } else {
        ASSERT_EQ(kill(child, signal), 0);
      }
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    close(terminal);
    EXPECT_TRUE(asked);
    EXPECT_TRUE(WIFEXITED(status)) << said;
    EXPECT_EQ(WEXITSTATUS(status), code) << said;
    EXPECT_NE(said.find("no path: the search was stopped before one was found"), std::string::npos)
        << said;
    EXPECT_NE(said.find("warning: interrupted before a path was found"), std::string::npos) << said;
    const Json json = Json::parse(Read("p.json"));
    EXPECT_EQ(json["found"], false);
    EXPECT_LT(json["time_us"], 60e6);
    EXPECT_FALSE(std::filesystem::exists(cwd() / "p.csv"));
    std::filesystem::remove(cwd() / "p.json");
  }
}

TEST_F(CliPlanTest, TheSameSeedGivesTheSameBytes) {
  const auto run = [this](const std::string& seed) {
    Json json = Json::parse(Run(Ends("start", "goal", {"--seed", seed, "--json", "-"})).out);
    json.erase("time_us");
    return json;
  };
  EXPECT_EQ(run("7"), run("7"));
  EXPECT_NE(run("7")["path"], run("8")["path"]);
}

TEST_F(CliPlanTest, BadInputIsOneLineAndNothingIsWritten) {
  const std::set<std::string> before = Files();
  for (const auto& [arguments, words] :
       {std::pair{Ends("nowhere", "goal"), "--start: no keyframe 'nowhere'"},
        {Ends("start", "17"), "--goal: no keyframe '17'"},
        {Ends("start", "1 2 3"), "--goal"},
        {Ends("start", "0 1e999"), "--goal"},
        {Ends("start", "0 nan"), "--goal: 'nan' is not finite"},
        {Ends("start", "nan 0"), "--goal: 'nan' is not finite"},
        {Ends("start", "0 a"), "--goal: 'a' is not a number"},
        {Ends("start", "far away"), "--goal: no keyframe 'far away'"},
        {Ends("start", ""), "--goal"},
        {Ends("start", "goal", {"--planner", "astar"}), "birrt-pdg"},
        {Ends("start", "goal", {"--time-limit", "0"}), "--time-limit"},
        {Ends("start", "goal", {"--threads", "0"}), "--threads"},
        {Ends("start", "goal", {"--out-qpos", "p.doc"}), "--out-qpos"},
        {Ends("start", "goal", {"--as-the-crow-flies"}), "--as-the-crow-flies"},
        {Arguments{"plan", "gap.xml", "--start", "start"}, "--goal"},
        {Arguments{"plan", "none.xml", "--start", "0", "--goal", "1"}, "none.xml"}}) {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(outcome.err.rfind("mjcf-pdg: error: ", 0), 0u) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_EQ(Files(), before);
}

TEST_F(CliPlanTest, AReportGoesAlongThePathEdgeByEdge) {
  const Outcome outcome = Run(Ends("deep", "goal", {"--json", "-", "--html", "r.html"}));
  ASSERT_EQ(outcome.exit_code, 0);
  const Json plan = Json::parse(outcome.out);
  const Block row = Unpack(Script(Read("r.html"), "row0"));
  const Json& edges = row.json["tables"][0];
  ASSERT_EQ(edges["rows"].size(), plan["path"].size() - 1);
  double length = 0.0;
  for (const Json& edge : edges["rows"]) {
    const Json& told = plan["edges"].at(edge[0].get<std::size_t>() - 1);
    EXPECT_DOUBLE_EQ(edge[1].get<double>(), 1e3 * told["length"].get<double>());
    EXPECT_EQ(told["certified"], true);
    EXPECT_EQ(edge[3], told["poses"]);
    length += edge[1].get<double>() / 1e3;
    EXPECT_EQ(edge[2], "proven free");
    EXPECT_GT(edge[3], 0);
  }
  EXPECT_NEAR(length, plan["length"].get<double>(), 1e-9);
  // The start as given, in the wall; then the path, each edge from its configuration on.
  ASSERT_EQ(row.json["contacts_in"].size(), 1u);
  EXPECT_EQ(row.json["contacts_in"][0]["distance"], plan["start"]["contacts_in"][0]["distance"]);
  const Json alone = Json::parse(Run(Ends("deep", "goal", {"--json", "-"})).out);
  EXPECT_EQ(alone["collision_queries"], plan["collision_queries"]);
  const auto x = [&](std::size_t frame) {  // of the ball, which is body 1 of 2
    float value = 0.0f;
    std::memcpy(&value, PoseBytes(row).data() + 7 * (2 * frame + 1) * sizeof value, sizeof value);
    return value;
  };
  EXPECT_FLOAT_EQ(x(0), -0.15f);
  for (std::size_t e = 0; e < edges["frames"].size(); ++e) {
    EXPECT_FLOAT_EQ(x(edges["frames"][e]), plan["path"][e][0].get<float>());
  }
  EXPECT_FLOAT_EQ(x(row.json["frames"].size() - 1), 0.5f);
}

TEST_F(CliPlanTest, AReportOfNoPathHasNoLength) {
  ASSERT_EQ(Run(Ends("start", "goal", {"--time-limit", "1e-6", "--html", "r.html"})).exit_code, 3);
  const Block row = Unpack(Script(Read("r.html"), "row0"));
  EXPECT_EQ(row.json["facts"][0][0], "start");
  EXPECT_FALSE(row.json.contains("joints"));
  EXPECT_EQ(row.json["frames"].size(), 2u);
}

}  // namespace
}  // namespace mjcf_pdg::test
