// solve --trajectory and --smooth: what they write, and what they refuse.
#include <gmock/gmock.h>

#include "tests/support/cli_test.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;

class CliTrajectoryTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    std::string rows;
    for (int k = 0; k < 40; ++k) {
      rows += std::to_string(-0.6 + 0.03 * k) + " " + std::to_string(-0.05 - 0.001 * k) + "\n";
    }
    Write("clip.txt", rows);
  }

  std::vector<Json> Solve(const Arguments& more) {
    Arguments arguments = {"solve",  "scene.xml",  "--qpos-file", "clip.txt",    "--json",
                           "a.json", "--out-qpos", "a.npy",       "--trajectory"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("40 configurations"), std::string::npos) << outcome.out;
    std::vector<Json> lines = ParseLines(Read("a.json"));
    EXPECT_EQ(lines.size(), 40u);
    for (Json& line : lines) line.erase("time_us");
    return lines;
  }
};

double Change(const std::vector<Json>& lines) {
  double sum = 0.0;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    for (std::size_t j = 0; j < lines[k]["qpos"].size(); ++j) {
      sum += std::pow(lines[k]["qpos"][j].get<double>() - lines[k - 1]["qpos"][j].get<double>(), 2);
    }
  }
  return sum;
}

TEST_F(CliTrajectoryTest, FramesAreFollowedAndSmoothedTheSameAtAnyThreadCount) {
  const std::vector<Json> followed = Solve({});
  const std::string npy = Read("a.npy");
  EXPECT_EQ(Solve({"--threads", "4"}), followed);
  EXPECT_EQ(Read("a.npy"), npy);
  EXPECT_EQ(Solve({"--smooth", "0"}), followed);
  const std::vector<Json> smooth = Solve({"--smooth", "5"});
  EXPECT_EQ(Read("a.npy").size(), npy.size());
  EXPECT_NE(Read("a.npy"), npy);
  EXPECT_EQ(Solve({"--smooth", "5", "--threads", "4"}), smooth);
  EXPECT_LT(Change(smooth), 0.9 * Change(followed));
  for (std::size_t k = 0; k < smooth.size(); ++k) {
    EXPECT_EQ(smooth[k]["index"], k);
    EXPECT_GE(smooth[k]["sigma"], smooth[k]["sigma_lower_bound"]);
    EXPECT_GE(smooth[k]["min_distance"], -1e-6);
  }
}

TEST_F(CliTrajectoryTest, WhatCannotBeSmoothedIsRefused) {
  const auto refused = [&](const Arguments& more, const std::string& words) {
    Arguments arguments = {"solve", "scene.xml", "--qpos-file", "clip.txt", "--json", "b.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ExpectRefused(arguments, words);
  };
  refused({"--smooth", "1"}, "--smooth needs --trajectory");
  refused({"--smooth", "1", "--trajectory", "--method", "paper"}, "--smooth needs --method auto");
  refused({"--smooth", "1", "--trajectory", "--time-limit", "5"}, "--time-limit is per row");
  refused({"--smooth", "1", "--trajectory", "--resume"}, "--resume");
  for (const char* bad : {"-1", "nan", "inf", "1e7", "x", ""}) {
    refused({"--trajectory", "--smooth", bad}, "--smooth");
  }
}

// Rows are told when all are solved: a bad one leaves none.
TEST_F(CliTrajectoryTest, ABadFrameOfASmoothedClipLeavesNothing) {
  Write("clip.txt", Read("clip.txt") + "0 nan\n");
  const Outcome outcome = Run({"solve", "scene.xml", "--qpos-file", "clip.txt", "--trajectory",
                               "--smooth", "1", "--json", "c.json"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("clip.txt line 41"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(cwd() / "c.json"));
}

}  // namespace
}  // namespace mjcf_pdg::test
