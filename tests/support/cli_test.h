// A fixture that runs the built program in a folder of its own, as a user would.
#ifndef MJCF_PDG_TESTS_SUPPORT_CLI_TEST_H_
#define MJCF_PDG_TESTS_SUPPORT_CLI_TEST_H_

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace mjcf_pdg::test {

#ifdef MJCF_PDG_PROGRAM
inline constexpr const char* kProgram = MJCF_PDG_PROGRAM;
#else
inline constexpr const char* kProgram = nullptr;  // a build without the program
#endif

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

using Arguments = std::vector<std::string>;

inline std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline std::vector<nlohmann::json> ParseLines(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

// A ball on two slides above a wall. In the keyframe "deep" they overlap by 5 cm; the unnamed
// keyframe is free.
inline constexpr char kBallAndWall[] = R"(<mujoco><worldbody>
  <geom name="wall" type="box" size="1 1 .1"/>
  <body name="ball" pos="0 0 .15">
    <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>
    <geom name="sphere" size=".1"/>
  </body></worldbody>
  <keyframe><key name="deep" qpos="0 0"/><key qpos="0 .2"/></keyframe></mujoco>)";

class CliTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!kProgram) GTEST_SKIP() << "the program was not built";
    std::filesystem::create_directory(cwd());
    Write("scene.xml", kBallAndWall);
  }

  void TearDown() override { EXPECT_FALSE(std::filesystem::exists(cwd() / "MUJOCO_LOG.TXT")); }

  // The folder in which the program runs.
  std::filesystem::path cwd() const { return folder_ / "cwd"; }

  void Write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((cwd() / name).parent_path());
    std::ofstream(cwd() / name, std::ios::binary) << content;
  }

  std::string Read(const std::string& name) const { return ReadFile(cwd() / name); }

  std::set<std::string> Files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(cwd())) {
      names.insert(entry.path().string());
    }
    return names;
  }

  // Runs the program with `input` as its stdin and waits for its end.
  Outcome Run(Arguments arguments, const std::string& input = "") const {
    const std::string in = folder_ / "stdin", out = folder_ / "stdout", err = folder_ / "stderr";
    std::ofstream(in, std::ios::binary) << input;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, cwd().c_str());
    posix_spawn_file_actions_addopen(&actions, 0, in.c_str(), O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    arguments.insert(arguments.begin(), kProgram);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_t child = 0;
    Outcome outcome;
    const int failed = posix_spawn(&child, kProgram, &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    if (failed != 0 || waitpid(child, &status, 0) != child) {
      ADD_FAILURE() << "cannot run " << kProgram;
      return outcome;
    }
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    outcome.out = ReadFile(out);
    outcome.err = ReadFile(err);
    return outcome;
  }

  // Runs `solve` with `--json -` and returns its lines without the times, which differ from run to
  // run.
  std::vector<nlohmann::json> SolveJson(Arguments arguments, const std::string& input = "") const {
    arguments.insert(arguments.begin(), "solve");
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = Run(arguments, input);
    EXPECT_EQ(outcome.err, "");
    std::vector<nlohmann::json> lines = ParseLines(outcome.out);
    for (nlohmann::json& line : lines) line.erase("time_us");
    return lines;
  }

  // Expects exit code 2, one line on stderr that contains `words`, nothing on stdout, and the same
  // files as before.
  void ExpectRefused(const Arguments& arguments, const std::string& words,
                     const std::string& input = "") const {
    const std::set<std::string> before = Files();
    const Outcome outcome = Run(arguments, input);
    SCOPED_TRACE(::testing::PrintToString(arguments));
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.rfind("mjcf-pdg: error: ", 0), 0u) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(Files(), before);
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_CLI_TEST_H_
