// --html: what is in the file. How it behaves in a browser: tests/html.
#include <algorithm>
#include <cstring>
#include <regex>

#include "tests/support/cli_test.h"
#include "tests/support/report_file.h"

namespace mjcf_pdg::test {
namespace {

// What the page shows as the fact `name` of a row.
nlohmann::json Fact(const Block& row, const std::string& name) {
  for (const nlohmann::json& fact : row.json["facts"]) {
    if (fact[0] == name) return fact[1];
  }
  return nullptr;
}

// The z of body `body` (of `nbody`) in a frame.
float HeightIn(const Block& row, std::size_t frame, std::size_t body, std::size_t nbody) {
  float z = 0.0f;
  std::memcpy(&z, PoseBytes(row).data() + (7 * (frame * nbody + body) + 2) * sizeof z, sizeof z);
  return z;
}

// The numbers of --qpos in a command.
std::string QposIn(const std::string& command) {
  const std::size_t quote = command.find('\'');
  return command.substr(quote + 1, command.find('\'', quote + 1) - quote - 1);
}

TEST_F(CliTest, AReportHoldsSceneRowsAndSearch) {
  ASSERT_EQ(Run({"solve", "scene.xml", "--seed", "3", "--html", "r.html"}).exit_code, 0);
  const std::string page = Read("r.html");
  EXPECT_FALSE(std::regex_search(page.substr(0, 9000), std::regex("(src|href)=\"?http")));
  const nlohmann::json rows = Head(page)["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["label"], "deep");
  EXPECT_EQ(rows[0]["status"], "solved");
  EXPECT_EQ(Head(page)["columns"][0], "depth mm");
  EXPECT_NEAR(rows[0]["values"][0].get<double>(), 50.0, 1e-2);
  EXPECT_NE(Head(page)["options"].dump().find(R"(["--seed","3"])"), std::string::npos);
  EXPECT_NE(Head(page)["options"].dump().find(R"(["--method","auto"])"), std::string::npos);
  EXPECT_EQ(rows[1]["status"], "already_free");

  const Block scene = Unpack(Script(page, "scene0"));
  ASSERT_EQ(scene.json["geoms"].size(), 2u);
  EXPECT_EQ(scene.json["geoms"][1]["type"], "sphere");

  const Block row = Unpack(Script(page, "row0"));
  EXPECT_EQ(row.json["contacts_in"].size(), 1u);
  EXPECT_EQ(row.json["joints"][0]["name"], "z");
  EXPECT_EQ(row.json["joints"][0]["moved"].front(), 0.0);
  EXPECT_NEAR(row.json["joints"][0]["moved"].back().get<double>(), 50.0, 1e-2);
  EXPECT_GE(row.json["iterations"].size(), 2u);
  EXPECT_EQ(row.json["command"], "mjcf-pdg solve scene.xml --seed 3 --qpos '0.0 0.0' --json -");
  EXPECT_EQ(row.json["trace"], "mjcf-pdg solve scene.xml --seed 3 --qpos '0.0 0.0' --trace -");
  EXPECT_EQ(row.json["norm"], "mjcf-pdg norm scene.xml");
  double q = 1.0;  // z as given, the second number
  std::memcpy(&q, row.bytes.data() + sizeof q, sizeof q);
  EXPECT_EQ(q, 0.0);
  // Poses of the world and the ball in each frame: z of the ball, as given and in the answer.
  const std::size_t frames = row.json["frames"].size(), pose = 7 * sizeof(float);
  ASSERT_GE(frames, 3u);
  ASSERT_EQ(PoseBytes(row).size(), frames * 2 * pose);
  EXPECT_FLOAT_EQ(HeightIn(row, 0, 1, 2), 0.15f);
  EXPECT_NEAR(HeightIn(row, frames - 1, 1, 2), 0.2f, 1e-5f);
}

// The command that a report shows makes the row again.
TEST_F(CliTest, AReportsCommandMakesTheRowAgain) {
  const std::string model = MJCF_PDG_MODEL_DIR "/puma/puma_car.xml";
  ASSERT_EQ(Run({"solve", model, "--key", "arm_through_door", "--html", "r.html"}).exit_code, 0);
  const std::string page = Read("r.html");
  const Block row = Unpack(Script(page, "row0"));
  const nlohmann::json again = SolveJson({model, "--qpos", QposIn(row.json["command"])}).at(0);
  EXPECT_EQ(Fact(row, "σ, m²"), again["sigma"]);
  EXPECT_GT(Unpack(Script(page, "scene0")).json["meshes"].size(), 0u);
}

// What else than overlaps was wrong with the input is a fact, as JSON has it.
TEST_F(CliTest, AReportHasViolatedLimitsAndEqualities) {
  Write("held.xml", R"(<mujoco><worldbody>
    <body><joint name="a" type="slide" range="-1 1" limited="true"/><geom size=".1"/></body>
    <body pos="1 0 0"><joint name="b" type="slide"/><geom size=".1"/></body></worldbody>
    <equality><joint joint1="a" joint2="b"/></equality></mujoco>)");
  const Outcome outcome =
      Run({"solve", "held.xml", "--qpos", "1.5 1", "--json", "-", "--html", "r.html"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json told = ParseLines(outcome.out).at(0);
  const Block row = Unpack(Script(Read("r.html"), "row0"));
  EXPECT_EQ(told["limit_excess_in"], 0.5);
  EXPECT_EQ(Fact(row, "joint limits exceeded as given by, rad or m"), told["limit_excess_in"]);
  EXPECT_GT(told["equality_residual_in"], 0.1);
  EXPECT_EQ(Fact(row, "equalities violated as given by, m or rad"), told["equality_residual_in"]);
}

TEST_F(CliTest, NamesCannotLeaveTheirPlaceInAReport) {
  Write("evil.xml", std::regex_replace(std::string(kBallAndWall), std::regex("\"deep\""),
                                       "\"&lt;/script&gt;&lt;b&gt;\""));
  ASSERT_EQ(Run({"solve", "evil.xml", "--html", "r.html"}).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(Script(Read("r.html"), "page"))["rows"][0]["label"],
            "</script><b>");
}

TEST_F(CliTest, AReportIsWrittenWholeOrNotAtAll) {
  ExpectRefused({"solve", "scene.xml", "--html", "scene.xml"}, "--html");
  ExpectRefused({"solve", "scene.xml", "--key", "none", "--html", "r.html"}, "none");
  ExpectRefused({"check", "scene.xml", "--html", "scene.xml"}, "--html");
  ExpectRefused({"audit", "scene.xml", "--html", "scene.xml"}, "--html");
}

TEST_F(CliTest, AReportOfSeveralModelsHasTheSceneOfEach) {
  ASSERT_EQ(Run({"solve", "scene.xml", MJCF_PDG_MODEL_DIR "/loops/leg.xml", "--html", "r.html"})
                .exit_code,
            0);
  const std::string page = Read("r.html");
  EXPECT_EQ(Head(page)["models"].size(), 2u);
  EXPECT_EQ(Head(page)["rows"].back()["model"], 1);
  EXPECT_EQ(Unpack(Script(page, "scene0")).json["nbody"], 2);
  EXPECT_GT(Unpack(Script(page, "scene1")).json["nbody"], 2);
}

TEST_F(CliTest, AReportOfATrajectoryHasAllFramesInOneRow) {
  Write("clip.csv", "0 0\n.1 0\n.2 .3\n");
  ASSERT_EQ(
      Run({"solve", "scene.xml", "--qpos-file", "clip.csv", "--trajectory", "--html", "r.html"})
          .exit_code,
      0);
  const std::string page = Read("r.html");
  ASSERT_EQ(Head(page)["rows"].size(), 4u);
  EXPECT_EQ(Head(page)["rows"][3]["status"], "motion");
  const Block row = Unpack(Script(page, "row3"));
  ASSERT_EQ(row.json["frames"].size(), 3u);
  EXPECT_NEAR(HeightIn(row, 0, 1, 2), 0.2f, 1e-5f);
  EXPECT_FLOAT_EQ(HeightIn(row, 2, 1, 2), 0.45f);
  EXPECT_EQ(row.json["command"],
            "mjcf-pdg solve scene.xml --trajectory --qpos-file clip.csv --json -");
  EXPECT_EQ(row.json["note"], "");
  const nlohmann::json rows = Head(page)["rows"];
  for (int column : {0, 1}) {
    double largest = 0.0;
    for (int k : {0, 1, 2}) largest = std::max(largest, rows[k]["values"][column].get<double>());
    EXPECT_EQ(rows[3]["values"][column], largest);
    EXPECT_GT(largest, 40.0);
  }
}

TEST_F(CliTest, AReportOfCheckHasTheContacts) {
  ASSERT_EQ(Run({"check", "scene.xml", "--html", "r.html"}).exit_code, 3);
  const std::string page = Read("r.html");
  const nlohmann::json rows = Head(page)["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["wrong"], true);
  EXPECT_EQ(rows[1]["status"], "free");
  const Block row = Unpack(Script(page, "row0"));
  EXPECT_EQ(row.json["frames"].size(), 1u);
  EXPECT_NEAR(row.json["contacts_in"][0]["distance"].get<double>(), -0.05, 1e-5);
  EXPECT_EQ(row.json["contacts_in"][0]["geom2"], "wall");
  EXPECT_EQ(row.json["command"], "mjcf-pdg check scene.xml --qpos '0.0 0.0' --json -");
}

// As in the table on the terminal, what touches within the tolerance is no overlap.
TEST_F(CliTest, AReportOfCheckCountsWhatOverlaps) {
  ASSERT_EQ(Run({"check", "scene.xml", "--qpos", "0 0", "--qpos", "0 0.04995", "--tolerance",
                 "1e-4", "--html", "r.html"})
                .exit_code,
            3);
  const nlohmann::json rows = Head(Read("r.html"))["rows"];
  EXPECT_EQ(rows[0]["values"][0], 1.0);
  EXPECT_EQ(rows[1]["status"], "free");
  EXPECT_EQ(rows[1]["values"][0], 0.0);
}

// The ball falls on the wall: the slider has where that is, and where it would have gone.
TEST_F(CliTest, AReportOfAMotionGoesToWhereItStops) {
  ASSERT_EQ(
      Run({"check", "scene.xml", "--motion", "--from", "0 0.4", "--to", "0 0", "--html", "r.html"})
          .exit_code,
      3);
  const Block row = Unpack(Script(Read("r.html"), "row0"));
  EXPECT_NEAR(Fact(row, "free up to t").get<double>(), 0.875, 1e-3);
  const std::size_t frames = row.json["frames"].size();
  EXPECT_FLOAT_EQ(HeightIn(row, 0, 1, 2), 0.55f);
  EXPECT_NEAR(HeightIn(row, frames - 2, 1, 2), 0.2f, 1e-3f);
  EXPECT_FLOAT_EQ(HeightIn(row, frames - 1, 1, 2), 0.15f);
  EXPECT_EQ(row.json["opens"], frames - 2);
  ASSERT_EQ(row.json["contacts_stop"].size(), 1u);
  EXPECT_EQ(row.json["contacts_stop"][0]["geom1"], "sphere");
  EXPECT_EQ(row.json["contacts_stop"][0]["geom2"], "wall");
  EXPECT_NEAR(row.json["contacts_stop"][0]["distance"].get<double>(), 3e-6, 1.1e-6);
  EXPECT_TRUE(row.json["tables"].empty());
}

TEST_F(CliTest, AReportOfAuditHasPairsAndKeyframes) {
  ASSERT_EQ(Run({"audit", "scene.xml", "--samples", "50", "--html", "r.html", "--json", "a.json"})
                .exit_code,
            3);
  const std::string page = Read("r.html");
  const nlohmann::json rows = Head(page)["rows"], audit = ParseLines(Read("a.json")).at(0);
  ASSERT_EQ(rows.size(), audit["pairs"].size() + audit["keyframes"].size());
  EXPECT_EQ(rows[0]["label"], "sphere / wall");
  EXPECT_EQ(rows[0]["status"], audit["pairs"][0]["class"]);
  EXPECT_EQ(rows.back()["status"], "keyframe, free");
  // Where the pair is shown it overlaps as deep as is said, by the command beside it.
  const Block pair = Unpack(Script(page, "row0"));
  EXPECT_EQ(pair.json["contacts_in"][0]["distance"], audit["pairs"][0]["depth"]);
  const std::string qpos = QposIn(pair.json["command"]);
  const nlohmann::json again =
      ParseLines(Run({"check", "scene.xml", "--qpos", qpos, "--json", "-"}).out).at(0);
  EXPECT_EQ(again["min_distance"], audit["pairs"][0]["depth"]);
  EXPECT_EQ(Head(page)["again"], "mjcf-pdg audit scene.xml --samples 50 --json -");
  EXPECT_EQ(Fact(pair, "of 50 random configurations"), audit["pairs"][0]["count"]);
  EXPECT_EQ(Fact(pair, "deepest in"), audit["pairs"][0]["deepest_in"]);
  EXPECT_EQ(Head(page)["tables"][0]["rows"].back()[1], audit["never"]);
}

TEST_F(CliTest, AReportOfAuditTellsOfAModelThatDoesNotLoad) {
  Write("broken.xml", "<mujoco>");
  ASSERT_EQ(
      Run({"audit", "broken.xml", "scene.xml", "--samples", "10", "--html", "r.html"}).exit_code,
      3);
  const std::string page = Read("r.html");
  EXPECT_EQ(Head(page)["rows"][0]["status"], "failed");
  const Block row = Unpack(Script(page, "row0"));
  EXPECT_EQ(row.json["frames"].size(), 0u);
  EXPECT_NE(row.json["reason"].get<std::string>().find("broken.xml"), std::string::npos);
}

TEST_F(CliTest, AReportOfRegressSaysWhatChanged) {
  Write("m/scene.xml", kBallAndWall);
  ASSERT_EQ(Run({"regress", "--discover", "m", "--update"}).exit_code, 0);
  const std::string golden = Read("m/pdg.golden.json");
  // A nearer golden result than there is, and one of a model that is gone.
  std::string altered =
      std::regex_replace(golden, std::regex("\"sigma\": 0\\.[0-9]*[1-9][0-9]*"), "\"sigma\": 1e-6");
  ASSERT_NE(altered, golden);
  altered.replace(altered.rfind("\n]"), 0,
                  ",\n  {\"model\": \"lost.xml\", \"row\": \"qpos0\", \"status\": \"solved\", "
                  "\"sigma\": 1, \"queries\": 1}");
  Write("m/pdg.golden.json", altered);
  ASSERT_EQ(Run({"regress", "m/pdg.json", "--html", "r.html"}).exit_code, 3);
  const std::string page = Read("r.html");
  const nlohmann::json rows = Head(page)["rows"];
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0]["status"], "solved, sigma_up");
  EXPECT_EQ(rows[0]["wrong"], true);
  EXPECT_EQ(rows[1]["status"], "already_free");
  EXPECT_EQ(rows[2]["status"], "gone");
  EXPECT_NEAR(rows[0]["values"][0].get<double>(), 50.0, 1e-2);  // its depth
  EXPECT_EQ(rows[2]["values"][1], 1000.0);                      // the golden rms
  const Block row = Unpack(Script(page, "row0"));
  EXPECT_EQ(row.json["tables"][0]["rows"][1][1], 1e-6);
  EXPECT_NEAR(row.json["contacts_in"][0]["distance"].get<double>(), -0.05, 1e-5);
  EXPECT_GE(row.json["iterations"].size(), 2u);
  EXPECT_EQ(row.json["command"], "mjcf-pdg solve m/scene.xml --qpos '0.0 0.0' --json -");
  EXPECT_EQ(row.json["trace"], "mjcf-pdg solve m/scene.xml --qpos '0.0 0.0' --trace -");
  EXPECT_EQ(Head(page)["again"], "mjcf-pdg regress m/pdg.json --json -");
}

// What it compares with is what it wrote, so that its command says the same again: of the first
// golden results, and of some that replace others.
TEST_F(CliTest, AReportOfAnUpdateIsThatOfTheNextRun) {
  Write("m/scene.xml", kBallAndWall);
  ASSERT_EQ(Run({"regress", "--discover", "m", "--update", "--html", "first.html"}).exit_code, 0);
  std::string altered = Read("m/pdg.golden.json");
  const std::size_t sigma = altered.find("\"sigma\"");
  altered.replace(sigma, altered.find(',', sigma) - sigma, "\"sigma\": 1e-6");
  altered.replace(altered.rfind("\n]"), 0,
                  ",\n  {\"model\": \"lost.xml\", \"row\": \"qpos0\", \"status\": \"solved\", "
                  "\"sigma\": 1, \"queries\": 1}");
  Write("m/pdg.golden.json", altered);
  ASSERT_EQ(Run({"regress", "m/pdg.json", "--update", "--html", "second.html"}).exit_code, 0);
  ASSERT_EQ(Run({"regress", "m/pdg.json", "--html", "again.html"}).exit_code, 0);
  const nlohmann::json again = Head(Read("again.html"));
  for (const char* const name : {"first.html", "second.html"}) {
    const std::string page = Read(name);
    EXPECT_EQ(Head(page)["rows"], again["rows"]);
    EXPECT_EQ(Head(page)["tables"][0]["rows"], again["tables"][0]["rows"]);
    EXPECT_EQ(Unpack(Script(page, "row0")).json["tables"][0]["rows"],
              Unpack(Script(Read("again.html"), "row0")).json["tables"][0]["rows"]);
    EXPECT_NE(Head(page)["note"], "");
  }
  EXPECT_EQ(again["note"], "");
  EXPECT_GT(again["tables"][0]["rows"][0][1], 0);
}

// A model that fails after some rows keeps its golden results: nothing is shown as if it had
// others.
TEST_F(CliTest, AReportOfAnUpdateLeavesOutTheRowsOfAModelThatFails) {
  Write("rows.csv", "0 0\n0 0 0\n");
  Write("suite.json", R"({"version": 1, "cases": [
    {"model": "scene.xml", "configurations": ["keyframes", {"file": "rows.csv"}]}]})");
  ASSERT_EQ(Run({"regress", "suite.json", "--update", "--html", "r.html"}).exit_code, 3);
  const std::string page = Read("r.html");
  ASSERT_EQ(Head(page)["rows"].size(), 1u);
  EXPECT_EQ(Head(page)["rows"][0]["status"], "failed");
  EXPECT_EQ(Head(page)["models"].size(), 1u);
  EXPECT_EQ(Head(page)["tables"][0]["rows"][0][2], "-");
  EXPECT_EQ(Unpack(Script(page, "row0")).json["nq"], 0);
}

}  // namespace
}  // namespace mjcf_pdg::test
