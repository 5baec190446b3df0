// mjcf-pdg regress: what it catches, what it writes, what it refuses.
#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <map>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

constexpr char kSuite[] = R"({"version": 1, "cases": [
  {"model": "a/scene.xml"},
  {"model": "b/*.xml", "configurations": ["keyframes", "qpos0", {"file": "rows.txt"},
                                          {"random": 5, "seed": 2}]}]})";

// The ball of kBallAndWall, whose "deep" keyframe overlaps by `depth`.
std::string Scene(double depth) {
  std::string xml = kBallAndWall;
  const std::string pos = "pos=\"0 0 .15\"";
  return xml.replace(xml.find(pos), pos.size(), "pos=\"0 0 " + std::to_string(0.2 - depth) + "\"");
}

// A ball that its limits keep in the wall.
constexpr char kTrapped[] = R"(<mujoco><worldbody>
  <geom name="wall" type="box" size="1 1 .1"/>
  <body name="ball" pos="0 0 .15"><joint name="x" type="slide" axis="1 0 0" range="-.1 .1"/>
  <joint name="z" type="slide" axis="0 0 1" range="-.1 .01"/>
  <geom name="sphere" size=".1"/></body></worldbody>
  <keyframe><key name="deep" qpos="0 0"/><key qpos="0 .2"/></keyframe></mujoco>)";

class CliRegressTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    Write("a/scene.xml", Scene(0.05));
    Write("b/one.xml", Scene(0.02));
    Write("b/two.xml", Scene(0.03));
    Write("rows.txt", "0 -.1\n.3 .4\n");
    Write("suite.json", kSuite);
  }

  // The lines of JSON about rows that changed, by row; of models as a whole under their name.
  std::map<std::string, Json> Changes(int exit_code) const {
    const Outcome outcome = Run({"regress", "suite.json", "--json", "-"});
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err << outcome.out;
    std::map<std::string, Json> changes;
    for (const Json& line : ParseLines(outcome.out)) {
      if (line.contains("failed")) {
        changes[line["model"]] = line;
      } else if (line["change"] != "same") {
        changes[line["model"].get<std::string>() + " " + line["row"].get<std::string>()] = line;
      }
    }
    return changes;
  }

  void Update() const { ASSERT_EQ(Run({"regress", "suite.json", "--update"}).exit_code, 0); }

  Json Golden() const { return Json::parse(Read("suite.golden.json")); }
  void EditGolden(const std::function<void(Json& row)>& edit) const {
    Json golden = Golden();
    for (Json& row : golden["rows"]) edit(row);
    Write("suite.golden.json", golden.dump());
  }
};

TEST_F(CliRegressTest, WhatIsUpdatedHasNotChangedAndDiffsByLine) {
  const Outcome first = Run({"regress", "suite.json"});
  EXPECT_EQ(first.exit_code, 0) << "nothing to compare with";
  EXPECT_THAT(first.out, HasSubstr("new"));
  Update();
  const std::map<std::string, Json> changes = Changes(0);
  EXPECT_EQ(changes.size(), 3u) << "the models as a whole";
  EXPECT_EQ(Golden()["rows"].size(), 2u + 2 * (2 + 1 + 2 + 5));
  const std::string text = Read("suite.golden.json");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'),
            static_cast<std::ptrdiff_t>(Golden()["rows"].size()) + 2);
  Update();
  EXPECT_EQ(Read("suite.golden.json"), text);
  ASSERT_EQ(Run({"regress", "suite.json", "--update", "--threads", "3"}).exit_code, 0);
  EXPECT_EQ(Read("suite.golden.json"), text);
}

TEST_F(CliRegressTest, AModelMadeToPenetrateIsCaught) {
  Write("rows.txt", "0 .3\n.3 .4\n");
  Update();
  Write("b/two.xml", Scene(0.4));  // the free keyframe and rows are in the wall now
  const std::map<std::string, Json> changes = Changes(3);
  EXPECT_EQ(changes.at("b/two.xml keyframe key1")["change"], "penetrates");
  EXPECT_EQ(changes.at("b/two.xml rows.txt row 0")["change"], "penetrates");
  EXPECT_THAT(changes.at("b/two.xml keyframe key1")["reason"].get<std::string>(),
              HasSubstr(" overlap by "));
  EXPECT_TRUE(changes.at("b/two.xml")["failed"]);
  EXPECT_FALSE(changes.at("b/one.xml")["failed"]);
  EXPECT_THAT(Run({"regress", "suite.json"}).out, HasSubstr("b/two.xml: keyframe key1: "));
}

TEST_F(CliRegressTest, ALostSolutionIsCaught) {
  Update();
  Write("a/scene.xml", kTrapped);
  const std::map<std::string, Json> changes = Changes(3);
  EXPECT_EQ(changes.at("a/scene.xml keyframe deep")["change"], "lost");
}

TEST_F(CliRegressTest, SigmaBeyondItsToleranceIsCaughtUpAndDown) {
  Update();
  const double sigma = Golden()["rows"][0]["sigma"];
  ASSERT_NEAR(sigma, 0.05 * 0.05, 1e-5);
  for (const auto& [factor, change] :
       {std::pair{1.02, "sigma_down"}, {0.98, "sigma_up"}, {1.005, ""}, {0.995, ""}}) {
    EditGolden([&](Json& row) {
      if (row["model"] == "a/scene.xml" && row["status"] == "solved") row["sigma"] = factor * sigma;
    });
    const std::string expected = change;
    const std::map<std::string, Json> changes = Changes(expected == "sigma_up" ? 3 : 0);
    const auto found = changes.find("a/scene.xml keyframe deep");
    EXPECT_EQ(found == changes.end() ? "" : found->second["change"], expected) << factor;
  }
}

// A squeezed grasp is part of the suite as it is.
TEST_F(CliRegressTest, OverlapsThatTheSuiteAllowsAreFree) {
  for (const auto& [depth, status] : {std::pair{"0.06", "already_free"}, {"0.01", "solved"}}) {
    Write("suite.json", std::string(R"({"version": 1, "options": {"allow": [["ball", "wall", )") +
                            depth + R"(]]}, "cases": [{"model": "a/scene.xml"}]})");
    Update();
    for (const Json& line : ParseLines(Run({"regress", "suite.json", "--json", "-"}).out)) {
      if (line.contains("row") && line["row"] == "keyframe deep") {
        EXPECT_EQ(line["status"], status) << line;
      }
    }
  }
}

TEST_F(CliRegressTest, ASlowedSolverIsCaughtByItsQueries) {
  const std::string robot = std::string(MJCF_PDG_SOURCE_DIR) + "/models/puma/puma_car.xml";
  Write("suite.json", R"({"version": 1, "options": {"effort": "fast"}, "cases": [{"model": ")" +
                          robot + R"("}, {"model": "a/scene.xml"}]})");
  Update();
  EXPECT_FALSE(Changes(0).at(robot)["failed"]);
  EditGolden([&](Json& row) { row["queries"] = row["queries"].get<int>() / 2; });
  const std::map<std::string, Json> changes = Changes(3);
  EXPECT_TRUE(changes.at(robot)["failed"]);
  EXPECT_FALSE(changes.at("a/scene.xml")["failed"]) << "a handful of queries is no news";
  EXPECT_THAT(Run({"regress", "suite.json"}).out, HasSubstr("puma_car.xml: queries"));
  EXPECT_THAT(Run({"regress", "suite.json"}).out, HasSubstr("failed, 1 that take more queries\n"));
}

TEST_F(CliRegressTest, NewAndGoneRowsAreSaidAndFailNothing) {
  Update();
  Write("rows.txt", "0 -.1\n");
  Write("b/three.xml", Scene(0.01));
  const std::map<std::string, Json> changes = Changes(0);
  EXPECT_EQ(changes.at("b/one.xml rows.txt row 1")["change"], "gone");
  EXPECT_EQ(changes.at("b/three.xml keyframe deep")["change"], "new");
}

TEST_F(CliRegressTest, OneBadModelEndsNothingAndKeepsItsGoldenResults) {
  Update();
  const std::string golden = Read("suite.golden.json");
  Write("b/one.xml", "<mujoco>");
  const std::map<std::string, Json> changes = Changes(3);
  EXPECT_THAT(changes.at("b/one.xml")["error"].get<std::string>(), HasSubstr("one.xml"));
  EXPECT_FALSE(changes.at("b/two.xml")["failed"]);
  const Outcome update = Run({"regress", "suite.json", "--update"});
  EXPECT_EQ(update.exit_code, 3);
  EXPECT_THAT(update.out, HasSubstr("1 models that failed"));
  EXPECT_EQ(Read("suite.golden.json"), golden);
}

TEST_F(CliRegressTest, JunitTellsACiServer) {
  Update();
  EditGolden([](Json& row) { row["status"] = "already_free"; });
  EXPECT_EQ(Run({"regress", "suite.json", "--junit", "out.xml"}).exit_code, 3);
  const std::string xml = Read("out.xml");
  EXPECT_THAT(
      xml, HasSubstr("<testsuite name=\"a/scene.xml\" tests=\"2\" failures=\"1\" errors=\"0\" "));
  EXPECT_THAT(xml, HasSubstr("<failure type=\"failure\" message=\"penetrates: was already_free"));
}

TEST_F(CliRegressTest, AFolderBecomesASuite) {
  Write("b/part.xml", "<mujocoinclude/>");
  Write("b/broken.xml", "<mujoco><worldbody>");
  Write("b/notes.txt", "<mujoco>");
  const Outcome outcome = Run({"regress", "--discover", "b", "--update"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("left out: "));
  EXPECT_THAT(outcome.err, HasSubstr("broken.xml"));
  EXPECT_EQ(Json::parse(Read("b/pdg.json"))["cases"].size(), 2u);
  EXPECT_EQ(Run({"regress", "b/pdg.json"}).exit_code, 0);
  EXPECT_EQ(Run({"regress", "--discover", "b"}).exit_code, 0);
  Write("b/two.xml", Scene(0.4));
  EXPECT_EQ(Run({"regress", "b/pdg.json"}).exit_code, 3);
}

TEST_F(CliRegressTest, RefusesWhatIsNoSuiteBeforeAnyWork) {
  const auto refused = [this](const std::string& suite, const std::string& words) {
    Write("suite.json", suite);
    ExpectRefused({"regress", "suite.json", "--update"}, words);
  };
  refused("{", "suite.json: ");
  refused("[]", "no object");
  refused(R"({"cases": [{"model": "a/scene.xml"}]})", "version");
  refused(R"({"version": 2, "cases": [{"model": "a/scene.xml"}]})", "version");
  refused(R"({"version": 1})", "no 'cases'");
  refused(R"({"version": 1, "cases": []})", "suite.json.cases: is no list, or an empty one");
  refused(R"({"version": 1, "cases": [{"modle": "a/scene.xml"}]})",
          "suite.json.cases[0]: has no 'modle' (there are: configurations, model, options)");
  refused(R"({"version": 1, "cases": [{"model": "none/*.xml"}]})", "names no file");
  refused(R"({"version": 1, "cases": [{"model": "a/scene.xml", "configurations": ["all"]}]})",
          "keyframes|qpos0");
  refused(R"({"version": 1, "cases": [{"model": "a/scene.xml", "configurations": [{"seed": 1}]}]})",
          "either 'file' or 'random'");
  refused(R"({"version": 1, "options": {"tolerance": -1}, "cases": [{"model": "a/scene.xml"}]})",
          "suite.json.options.tolerance");
  refused(R"({"version": 1, "options": {"allow": [["a", "b"]]}, "cases": [{"model": "a"}]})",
          "suite.json.options.allow[0]: is not a list of two geoms or bodies and a depth");
  refused(R"({"version": 1, "cases": [{"model": "a/scene.xml"}, {"model": "a/*.xml"}]})",
          "is in two cases");
  ExpectRefused({"regress"}, "a suite is needed");
  ExpectRefused({"regress", "none.json"}, "none.json: no such file");
  ExpectRefused({"regress", "b"}, "--discover");
  ExpectRefused({"regress", "--discover", "none"}, "no such folder");
}

TEST_F(CliRegressTest, RefusesGoldenResultsOfAnotherVersionAndSuitesThatShareThem) {
  Update();
  Json golden = Golden();
  golden["version"] = 7;
  Write("suite.golden.json", golden.dump());
  ExpectRefused({"regress", "suite.json"}, "suite.golden.json: is of version 7");
  Write("suite.golden.json", "{\"version\": 1, \"rows\": [{}]}");
  ExpectRefused({"regress", "suite.json"}, "suite.golden.json");
  std::filesystem::remove(cwd() / "suite.golden.json");
  ExpectRefused({"regress", "suite.json", "./suite.json"}, "as those of a suite before it");
}

}  // namespace
}  // namespace mjcf_pdg::test
