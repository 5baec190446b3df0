// solve --trace and replay.
#include <regex>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

const std::string kPuma = MJCF_PDG_MODEL_DIR "/puma/puma_car.xml";

TEST_F(CliTest, ATraceHasEveryIteration) {
  ASSERT_EQ(Run({"solve", "scene.xml", "--seed", "7", "--trace", "t.jsonl"}).exit_code, 0);
  const std::vector<nlohmann::json> lines = ParseLines(Read("t.jsonl"));
  ASSERT_GT(lines.size(), 4u);
  EXPECT_EQ(lines[0]["trace"], 1);
  EXPECT_EQ(lines[0]["model"], "scene.xml");
  EXPECT_EQ(lines[0]["options"], nlohmann::json({"--seed", "7"}));
  EXPECT_EQ(lines[1]["qpos_in"], nlohmann::json({0.0, 0.0}));
  EXPECT_EQ(lines[2]["step"], 0);
  EXPECT_EQ(lines[2]["start"], "direct");
  EXPECT_EQ(lines[2]["qpos"], nlohmann::json({0.0, 0.0}));
  EXPECT_NEAR(lines[2]["violation"].get<double>(), 0.05, 1e-5);
  const nlohmann::json& row = lines[3]["rows"].at(0);
  EXPECT_EQ(row["geom1"], "sphere");
  EXPECT_EQ(row["geom2"], "wall");
  EXPECT_NEAR(row["gap"].get<double>(), -0.05, 1e-5);
  EXPECT_GT(row["multiplier"].get<double>(), 0.0);
  const std::vector<nlohmann::json> solved = SolveJson({"scene.xml", "--seed", "7"});
  EXPECT_EQ(lines.back()["status"], "already_free");
  std::size_t ends = 0;
  for (const nlohmann::json& line : lines) {
    if (!line.contains("status")) continue;
    EXPECT_EQ(line["qpos"], solved.at(ends)["qpos"]);
    ++ends;
  }
  EXPECT_EQ(ends, 2u);
}

TEST_F(CliTest, ATraceDoesNotDependOnThreads) {
  const std::string poses = "0 0\n0 .01\n0 .02\n0 .03\n";
  Write("poses.txt", poses);
  Run({"solve", "scene.xml", "--qpos-file", "poses.txt", "--trace", "one"});
  Run({"solve", "scene.xml", "--qpos-file", "poses.txt", "--threads", "3", "--trace", "three"});
  EXPECT_FALSE(Read("one").empty());
  EXPECT_EQ(Read("one"), Read("three"));
}

TEST_F(CliTest, ReplayRecomputesATrace) {
  for (const char* method : {"auto", "paper"}) {
    ASSERT_EQ(Run({"solve", kPuma, "--method", method, "--exclude", "car,link1", "--exclude",
                   "car,link2", "--trace", "t"})
                  .exit_code,
              0)
        << method;
    const Outcome outcome = Run({"replay", "t"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
    EXPECT_TRUE(std::regex_match(outcome.out, std::regex("the same: \\d+ rows, \\d+ iterations\n")))
        << outcome.out;
  }
}

TEST_F(CliTest, ReplayStopsAtTheFirstDifference) {
  Run({"solve", "scene.xml", "--trace", "t"});
  std::string trace = Read("t");
  const std::size_t at = trace.find("\"sigma\":", trace.find("\"step\":1"));
  ASSERT_NE(at, std::string::npos);
  trace.insert(at + 8, "1");
  Write("changed", trace);
  const Outcome outcome = Run({"replay", "changed"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(
      outcome.out.find("changed line 4: row 0, descent 0, step 1, start \"direct\": sigma is"),
      std::string::npos)
      << outcome.out;
}

// The model as it is now decides: a bug that was mended shows as a difference.
TEST_F(CliTest, ReplayTakesAModelFromElsewhere) {
  Run({"solve", "scene.xml", "--trace", "t"});
  Write("moved.xml", Read("scene.xml"));
  std::string thicker = Read("scene.xml");
  thicker.replace(thicker.find("1 1 .1"), 6, "1 1 .11");
  Write("thicker.xml", thicker);
  std::filesystem::remove(cwd() / "scene.xml");
  ExpectRefused({"replay", "t"}, "scene.xml");
  EXPECT_EQ(Run({"replay", "t", "--model", "moved.xml"}).exit_code, 0);
  EXPECT_EQ(Run({"replay", "t", "--model", "thicker.xml"}).exit_code, 3);
}

TEST_F(CliTest, ReplayRefusesWhatIsNoTrace) {
  Run({"solve", "scene.xml", "--trace", "t"});
  const std::string trace = Read("t");
  const std::size_t header = trace.find('\n') + 1;
  Write("empty", "");
  Write("text", "hello\n");
  Write("headless", trace.substr(header));
  Write("header", trace.substr(0, header));
  Write("cut", trace.substr(0, trace.find('\n', trace.find("\"step\":0")) + 1));
  Write("qpos", trace.substr(0, header) + R"({"row":0,"label":"a","qpos_in":[1]})" + "\n");
  Write("option",
        R"({"trace":1,"mjcf_pdg":"","mujoco":"","model":"scene.xml","options":["--no"]})");
  ExpectRefused({"replay", "none"}, "none: cannot be read");
  ExpectRefused({"replay", "empty"}, "empty: empty");
  ExpectRefused({"replay", "text"}, "text line 1: not a trace of mjcf-pdg solve --trace");
  ExpectRefused({"replay", "headless"}, "headless line 1: not a trace");
  ExpectRefused({"replay", "header"}, "there is no row in it");
  ExpectRefused({"replay", "cut"}, "cut line 3: the trace ends within row 0");
  ExpectRefused({"replay", "qpos"}, "qpos line 2: ");
  ExpectRefused({"replay", "option"}, "option line 1: options: ");
  ExpectRefused({"solve", "scene.xml", "--trajectory", "--trace", "u"}, "--trace");
  ExpectRefused({"solve", "scene.xml", "scene.xml", "--trace", "u"},
                "--trace is for a single model");
}

}  // namespace
}  // namespace mjcf_pdg::test
