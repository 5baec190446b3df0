// mjcf-pdg regress: what is wrong with suites, golden results and folders is told in one line, and
// nothing that people wrote is lost.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class CliRegressInputTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    if (IsSkipped()) return;
    Write("suite.json", R"({"version": 1, "cases": [{"model": "scene.xml"}]})");
  }

  void RefusedSuite(const std::string& cases, const std::string& words) const {
    Write("bad.json", R"({"version": 1, "cases": [)" + cases + "]}");
    ExpectRefused({"regress", "bad.json", "--update"}, words);
  }

  void Update() const { ASSERT_EQ(Run({"regress", "suite.json", "--update"}).exit_code, 0); }
};

TEST_F(CliRegressInputTest, WhatASuiteSaysTwiceOrInVainIsRefused) {
  RefusedSuite(R"({"model": "scene.xml", "model": "other.xml"})", "has 'model' twice");
  RefusedSuite(R"({"model": "scene.xml"}, {"model": "./scene.xml"})", "scene.xml is in two cases");
  const auto configurations = [&](const std::string& list, const std::string& words) {
    RefusedSuite(R"({"model": "scene.xml", "configurations": [)" + list + "]}", words);
  };
  configurations(R"("qpos0", "qpos0")", "configurations[1]: names the rows of an entry before it");
  configurations(R"({"random": 2}, {"random": 3})", "configurations[1]: names the rows");
  configurations(R"({"random": 0})", "configurations[0].random");
  configurations(R"({"random": 1000001})", "configurations[0].random");
  configurations(R"({"file": "rows.txt", "seed": 1})", "a 'seed', which goes with 'random'");
  Write("bad.json", R"({"version": 1.5, "cases": [{"model": "scene.xml"}]})");
  ExpectRefused({"regress", "bad.json"}, "version is not 1");
}

// A model without keyframes has its qpos0 in their place: "qpos0" beside it is no second row.
TEST_F(CliRegressInputTest, Qpos0ThatStandsForKeyframesIsOneRow) {
  Write("plain.xml", R"(<mujoco><worldbody><body><joint/><geom size=".1"/></body></worldbody>
      </mujoco>)");
  Write("suite.json", R"({"version": 1, "cases": [{"model": "plain.xml",
      "configurations": ["keyframes", "qpos0"]}]})");
  Update();
  EXPECT_EQ(Json::parse(Read("suite.golden.json"))["rows"].size(), 1u);
  EXPECT_EQ(Run({"regress", "suite.json"}).exit_code, 0);
}

TEST_F(CliRegressInputTest, BrokenGoldenResultsAreRefusedWithTheirPlace) {
  Update();
  const std::string good = Read("suite.golden.json");
  const auto refused = [&](const std::function<void(Json&)>& edit, const std::string& words) {
    Json golden = Json::parse(good);
    edit(golden);
    Write("suite.golden.json", golden.dump());
    ExpectRefused({"regress", "suite.json"}, "suite.golden.json" + words);
    ExpectRefused({"regress", "suite.json", "--update"}, "suite.golden.json" + words);
    EXPECT_EQ(Read("suite.golden.json"), golden.dump());
  };
  refused([](Json& g) { g["rows"] = Json::object(); }, ".rows: is no list");
  refused([](Json& g) { g.erase("rows"); }, ": needs version and rows");
  refused([](Json& g) { g.erase("version"); }, ": needs version and rows");
  refused([](Json& g) { g["version"] = 2; }, ": is of version 2, this program knows 1 (remove");
  refused([](Json& g) { g["rows"][1]["sigma"] = -1; }, ".rows[1].sigma: ");
  refused([](Json& g) { g["rows"][1]["queries"] = 1e30; }, ".rows[1].queries: ");
  refused([](Json& g) { g["rows"][1]["queries"] = 8.5; }, ".rows[1].queries: ");
  refused([](Json& g) { g["rows"][0]["status"] = "slved"; }, ".rows[0].status: 'slved' is none of ");
  refused([](Json& g) { g["rows"][0].erase("row"); }, ".rows[0]: needs model, row, ");
  refused([](Json& g) { g["rows"].push_back(g["rows"][0]); }, ".rows[2]: is of a row that has one");
  std::filesystem::remove(cwd() / "suite.golden.json");
  std::filesystem::create_directory(cwd() / "suite.golden.json");
  ExpectRefused({"regress", "suite.json"}, "suite.golden.json: is a folder");
}

TEST_F(CliRegressInputTest, ReportsAreNotWrittenOverWhatIsRead) {
  Write("rows.txt", "0 0\n");
  Write("suite.json", R"({"version": 1, "cases": [{"model": "scene.xml",
      "configurations": [{"file": "rows.txt"}]}]})");
  Update();
  for (const char* input : {"suite.json", "suite.golden.json", "scene.xml", "rows.txt"}) {
    const std::string before = Read(input);
    ExpectRefused({"regress", "suite.json", "--json", input}, "is an input file");
    ExpectRefused({"regress", "suite.json", "--junit", input}, "is an input file");
    EXPECT_EQ(Read(input), before);
  }
}

TEST_F(CliRegressInputTest, MissingGoldenResultsAndModelsThatAreGoneAreSaid) {
  Write("b/one.xml", kBallAndWall);
  Write("b/two.xml", kBallAndWall);
  Write("suite.json", R"({"version": 1, "cases": [{"model": "b/*.xml"}]})");
  const Outcome first = Run({"regress", "suite.json"});
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_THAT(first.err, HasSubstr("suite.golden.json: no such file"));
  Update();
  EXPECT_EQ(Run({"regress", "suite.json"}).err, "");
  std::filesystem::remove(cwd() / "b/two.xml");
  const Outcome gone = Run({"regress", "suite.json"});
  EXPECT_EQ(gone.exit_code, 0);
  EXPECT_THAT(gone.out, testing::ContainsRegex("b/two.xml +keyframe deep +gone"));
  Update();
  EXPECT_EQ(Json::parse(Read("suite.golden.json"))["rows"].size(), 2u);
}

// The same model and pose, of which two suites expect different things.
TEST_F(CliRegressInputTest, SuitesThatDisagreeAreToldApart) {
  for (const std::string folder : {"a", "b"}) {
    Write(folder + "/scene.xml", kBallAndWall);
    Write(folder + "/pdg.json", Read("suite.json"));
  }
  const Arguments both = {"regress", "a/pdg.json", "b/pdg.json"};
  ASSERT_EQ(Run({"regress", "a/pdg.json", "b/pdg.json", "--update"}).exit_code, 0);
  EXPECT_EQ(Run(both).exit_code, 0);
  Json golden = Json::parse(Read("b/pdg.golden.json"));
  golden["rows"][0]["sigma"] = 0.001;
  Write("b/pdg.golden.json", golden.dump());
  const Outcome outcome = Run({"regress", "a/pdg.json", "b/pdg.json", "--junit", "out.xml"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("b/pdg.json: scene.xml  keyframe deep  sigma_up"));
  EXPECT_THAT(outcome.out, testing::Not(HasSubstr("a/pdg.json")));
  EXPECT_THAT(Read("out.xml"), HasSubstr("<testsuite name=\"a/pdg.json: scene.xml\""));
}

TEST_F(CliRegressInputTest, DiscoverLosesNeitherAnEditedSuiteNorAModelThatBroke) {
  Write("b/one.xml", kBallAndWall);
  Write("b/two.xml", kBallAndWall);
  ASSERT_EQ(Run({"regress", "--discover", "b", "--update"}).exit_code, 0);
  const std::string suite = Read("b/pdg.json"), golden = Read("b/pdg.golden.json");
  Write("b/one.xml", "<mujoco>");
  const Outcome broken = Run({"regress", "--discover", "b", "--update"});
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_THAT(broken.out, HasSubstr("one.xml: "));
  EXPECT_EQ(Read("b/pdg.json"), suite);
  EXPECT_EQ(Read("b/pdg.golden.json"), golden);
  Write("b/pdg.json", R"({"version": 1, "options": {"effort": "fast"},
                          "cases": [{"model": "two.xml"}]})");
  ExpectRefused({"regress", "--discover", "b", "--update"}, "b/pdg.json says more than");
}

// Root may read everything, so that the test becomes somebody else for as long as this lives.
class Nobody {
 public:
  explicit Nobody(const std::filesystem::path& folder) : was_(geteuid()) {
    for (const auto& open : {folder, folder.parent_path()}) {
      EXPECT_EQ(chmod(open.c_str(), 0777), 0);
    }
    // The real user, too: a program that is run for another one than it belongs to may not look at
    // itself, as the search for leaks does.
    const uid_t user = was_ == 0 ? 65534 : was_;
    EXPECT_EQ(setresuid(user, user, was_), 0);
  }
  ~Nobody() { EXPECT_EQ(setresuid(was_, was_, was_), 0); }

 private:
  const uid_t was_;
};

TEST_F(CliRegressInputTest, WhatCannotBeReadIsSaid) {
  Write("b/one.xml", kBallAndWall);
  Write("b/three.xml", kBallAndWall);
  Write("b/closed/two.xml", kBallAndWall);
  Write("bad.json", R"({"version": 1, "cases": [{"model": "b/*/*.xml"}]})");
  for (const char* closed : {"b/three.xml", "b/closed"}) {
    ASSERT_EQ(chmod((cwd() / closed).c_str(), 0), 0);
  }
  {
    const Nobody nobody(cwd());
    if (faccessat(AT_FDCWD, kProgram, X_OK, AT_EACCESS) != 0) {
      GTEST_SKIP() << "only root may run what was built here";
    }
    const Outcome outcome = Run({"regress", "--discover", "b"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("left out: b/closed: Permission denied"));
    EXPECT_THAT(outcome.err, HasSubstr("left out: b/three.xml: cannot be opened"));
    const auto refused = [&](const Arguments& arguments, const std::string& words) {
      const Outcome bad = Run(arguments);
      EXPECT_EQ(bad.exit_code, 2);
      EXPECT_THAT(bad.err, HasSubstr(words));
    };
    refused({"regress", "bad.json"}, "cases[0].model: a folder that it names cannot be read");
    refused({"regress", "--discover", "b/closed"}, "b/closed: Permission denied");
    refused({"regress", "b/closed/suite.json"}, "b/closed/suite.json: Permission denied");
    refused({"check", "b/closed/two.xml"}, "b/closed/two.xml: Permission denied");
    refused({"check", "b/three.xml"}, "b/three.xml: cannot be opened");
  }
  EXPECT_EQ(chmod((cwd() / "b/closed").c_str(), 0700), 0);
}

// Names with quotes, markup and bytes that are no UTF-8 leave XML and JSON whole.
TEST_F(CliRegressInputTest, OddNamesLeaveReportsWhole) {
  std::string xml = kBallAndWall;
  const std::string deep = "name=\"deep\"";
  xml.replace(xml.find(deep), deep.size(), "name=\"&lt;a&gt; &amp; &quot;b&quot; \xff\"");
  Write("odd <&>\".xml", xml);
  Write("suite.json", R"({"version": 1, "cases": [{"model": "odd <&>\".xml"}]})");
  Update();
  const Outcome outcome = Run({"regress", "suite.json", "--json", "-", "--junit", "out.xml"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<Json> lines = ParseLines(outcome.out);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0]["row"], "keyframe <a> & \"b\" \xEF\xBF\xBD");
  EXPECT_EQ(lines[0]["change"], "same");
  const std::string junit = Read("out.xml");
  EXPECT_THAT(junit, HasSubstr("name=\"keyframe &lt;a&gt; &amp; &quot;b&quot; \xEF\xBF\xBD\""));
  EXPECT_THAT(junit, HasSubstr("<testsuite name=\"odd &lt;&amp;&gt;&quot;.xml\""));
}

}  // namespace
}  // namespace mjcf_pdg::test
