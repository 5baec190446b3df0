// Long batches: rows are streamed, what interrupts them leaves whole rows, --resume goes on, and
// several models go in one call.
#include <gmock/gmock.h>
#include <pty.h>
#include <signal.h>

#include "tests/support/cli_test.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;

constexpr int kRows = 40;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line + "\n");
  return lines;
}

std::string Joined(const std::vector<std::string>& lines, std::size_t count) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += lines[k];
  return text;
}

class CliBatchTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    Random random(3);
    for (int i = 0; i < kRows; ++i) {
      rows_.push_back(std::to_string(random.Uniform(-0.5, 0.5)) + " " +
                      std::to_string(random.Uniform(-0.3, 0.1)) + "\n");
    }
    Write("rows.txt", Joined(rows_, rows_.size()));
  }

  Outcome Solve(const Arguments& more) const {
    Arguments arguments = {"solve",  "scene.xml", "--qpos-file", "rows.txt",
                           "--json", "a.jsonl",   "--out-qpos",  "a.npy",
                           "--seed", "5",         "--threads",   "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run(arguments);
  }

  // What differs from run to run is the time.
  std::vector<Json> WithoutTimes(const std::string& name) const {
    std::vector<Json> lines = ParseLines(Read(name));
    for (Json& line : lines) line.erase("time_us");
    return lines;
  }

  bool Exists(const std::string& name) const { return std::filesystem::exists(cwd() / name); }

  std::vector<std::string> rows_;
};

TEST_F(CliBatchTest, AFileOfAnswersIsSaidToHoldUnsolvedOnes) {
  Write("stuck.xml", R"(<mujoco><worldbody><geom type="plane" size="1 1 .1"/><body pos="0 0 .05">
    <joint type="slide" axis="0 0 1" limited="true" range="0 .01"/><geom size=".1"/></body>
    </worldbody></mujoco>)");
  const Outcome outcome = Run({"solve", "stuck.xml", "--qpos", "0", "--out-qpos", "q.txt"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, testing::HasSubstr("q.txt has all 1 rows, also the 1 unsolved ones"));
}

TEST_F(CliBatchTest, ABadRowInTheMiddleLeavesTheRowsBeforeIt) {
  std::vector<std::string> rows = rows_;
  rows[25] = "0 nan\n";
  Write("rows.txt", Joined(rows, rows.size()));
  const Outcome outcome = Solve({});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("rows.txt line 26"), std::string::npos) << outcome.err;
  EXPECT_THAT(outcome.err, testing::HasSubstr("25 rows are in a.jsonl.part; the same command with "
                                              "--resume goes on\n"));
  EXPECT_EQ(Lines(outcome.err).size(), 1u);
  EXPECT_FALSE(Exists("a.jsonl"));
  EXPECT_EQ(ParseLines(Read("a.jsonl.part")).size(), 25u);
  // Mended, it goes on from there.
  Write("rows.txt", Joined(rows_, rows_.size()));
  EXPECT_EQ(Solve({"--resume"}).exit_code, 0);
  EXPECT_EQ(ParseLines(Read("a.jsonl")).size(), std::size_t{kRows});
  EXPECT_FALSE(Exists("a.jsonl.part"));
  EXPECT_FALSE(Exists("a.npy.part"));
}

// Whatever a killed run left, down to half a line: the same bytes in the end.
TEST_F(CliBatchTest, AResumedRunEndsWithTheBytesOfAWholeOne) {
  ASSERT_EQ(Solve({}).exit_code, 0);
  const std::vector<Json> whole = WithoutTimes("a.jsonl");
  ASSERT_EQ(whole.size(), std::size_t{kRows});
  const std::string json = Read("a.jsonl"), npy = Read("a.npy");
  const std::vector<std::string> lines = Lines(json);
  for (const std::size_t done : {0, 1, 17, kRows - 1, kRows}) {
    for (const std::size_t more : {0, 30}) {  // bytes of the row that was being written
      if (done == kRows && more > 0) continue;
      std::filesystem::remove(cwd() / "a.jsonl");
      std::filesystem::remove(cwd() / "a.npy");
      Write("a.jsonl.part", Joined(lines, done) + (more ? lines[done].substr(0, more) : ""));
      // The row of the .npy is written before the line of JSON.
      Write("a.npy.part", npy.substr(0, 128 + 16 * std::min<std::size_t>(done + more, kRows)));
      const Outcome outcome = Solve({"--resume"});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_EQ(WithoutTimes("a.jsonl"), whole);
      EXPECT_EQ(Joined(Lines(Read("a.jsonl")), done), Joined(lines, done)) << "kept as they were";
      EXPECT_EQ(Read("a.npy"), npy);
      EXPECT_NE(outcome.out.find("40 configurations"), std::string::npos) << outcome.out;
    }
  }
}

TEST_F(CliBatchTest, ResumeRefusesRowsOfOtherOptions) {
  ASSERT_EQ(Solve({}).exit_code, 0);
  const std::string json = Read("a.jsonl"), npy = Read("a.npy");
  const std::string part = Joined(Lines(json), 20);
  const auto resume = [&](const Arguments& more) {
    Write("a.jsonl.part", part);
    Write("a.npy.part", npy);
    Arguments arguments = {"--resume"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Solve(arguments);
  };
  for (const Arguments& other : {Arguments{"--clearance", "0.01"}, {"--metric", "displacement"}}) {
    const Outcome outcome = resume(other);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, testing::HasSubstr("is solved otherwise than the earlier run did"));
    EXPECT_EQ(Read("a.jsonl.part"), part);
  }
  EXPECT_EQ(resume({}).exit_code, 0);
}

TEST_F(CliBatchTest, ResumeRefusesWhatItCannotGoOnWith) {
  ASSERT_EQ(Solve({}).exit_code, 0);
  const std::vector<std::string> lines = Lines(Read("a.jsonl"));
  const std::string npy = Read("a.npy");
  const auto refused = [&](const std::string& part, const std::string& words) {
    Write("a.jsonl.part", part);
    Write("a.npy.part", npy);
    ExpectRefused({"solve", "scene.xml", "--qpos-file", "rows.txt", "--json", "a.jsonl",
                   "--out-qpos", "a.npy", "--resume"},
                  words);
    EXPECT_EQ(Read("a.jsonl.part"), part);
  };
  refused(lines[1], "another configuration");
  refused(Joined(lines, kRows) + lines[0], "fewer configurations");
  refused("no JSON\n", "line 1: is not a line that solve wrote");
  refused("{\"status\": 3}\n", "line 1");
  Write("a.npy.part", npy.substr(0, 200));
  Write("a.jsonl.part", Joined(lines, 20));
  EXPECT_EQ(Solve({"--resume"}).exit_code, 2);
  ExpectRefused({"solve", "scene.xml", "--resume"}, "--resume needs --json FILE");
  ExpectRefused({"solve", "scene.xml", "--resume", "--json", "-"}, "--resume needs --json FILE");
  ExpectRefused({"solve", "scene.xml", "--resume", "--json", "b.jsonl", "--trajectory"}, "frames");
  ExpectRefused({"solve", "scene.xml", "--resume", "--json", "b.jsonl", "--out-mjcf", "b.xml"},
                "--out-mjcf");
}

// A row that comes through a pipe is answered before the next one is there, and Ctrl-C while the
// program waits for it leaves whole rows and says how to go on.
TEST_F(CliBatchTest, RowsAreAnsweredAsTheyComeAndAnInterruptLeavesThem) {
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, {SIGTERM, 143}}) {
    int in[2], out[2], err[2];
    ASSERT_EQ(pipe(in) + pipe(out) + pipe(err), 0);
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(cwd().c_str()) != 0) _exit(99);
      dup2(in[0], 0), dup2(out[1], 1), dup2(err[1], 2);
      for (const int end : {in[0], in[1], out[0], out[1], err[0], err[1]}) close(end);
      execl(kProgram, kProgram, "solve", "scene.xml", "--qpos-file", "-", "--json", "a.jsonl",
            "--out-qpos", "-", nullptr);
      _exit(99);
    }
    close(in[0]), close(out[1]), close(err[1]);
    std::FILE* answers = fdopen(out[0], "r");
    char line[256];
    for (int k = 0; k < 5; ++k) {
      ASSERT_GT(write(in[1], rows_[k].data(), rows_[k].size()), 0);
      ASSERT_NE(std::fgets(line, sizeof line, answers), nullptr) << "row " << k;
    }
    ASSERT_EQ(kill(child, signal), 0);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), code);
    char said[1000] = {};
    EXPECT_GT(read(err[0], said, sizeof said - 1), 0);
    EXPECT_THAT(said, testing::HasSubstr("interrupted after 5 rows, which are in a.jsonl.part"));
    EXPECT_EQ(ParseLines(Read("a.jsonl.part")).size(), 5u);
    EXPECT_FALSE(Exists("a.jsonl"));
    std::fclose(answers);
    close(in[1]), close(err[0]);
  }
}

// What a program writes to a terminal, where stdout and stderr are one.
std::string OnATerminal(const std::filesystem::path& folder, const Arguments& arguments) {
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), kProgram);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    if (chdir(folder.c_str()) == 0) execv(kProgram, argv.data());
    _exit(99);
  }
  std::string text;
  char piece[1000];
  for (ssize_t n; (n = read(terminal, piece, sizeof piece)) > 0;) {
    text.append(piece, static_cast<std::size_t>(n));
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << text;
  close(terminal);
  return text;
}

TEST_F(CliBatchTest, ABarIsShownOnATerminalAndNeverInAPipe) {
  int controlling = -1, terminal = -1;
  if (openpty(&controlling, &terminal, nullptr, nullptr, nullptr) != 0) {
    GTEST_SKIP() << "no pseudo-terminals here (a bare chroot without /dev/pts)";
  }
  close(controlling), close(terminal);
  Write("rows.jsonl", "{\"qpos\": [0, 0]}\n{\"qpos\": [0, 0.1]}\n");
  Write("suite.json", R"({"version": 1, "cases": [{"model": "scene.xml"}]})");
  const std::string full(51, '*');
  for (const auto& [arguments, title] :
       {std::pair<Arguments, std::string>{{"solve", "scene.xml"}, "solving (2)"},
        {{"check", "scene.xml", "--qpos", "0 0.1", "--qpos", "0 0.1"}, "checking (2)"},
        {{"solve", "scene.xml", "--qpos-file", "rows.jsonl"}, "solving (2)"},
        {{"regress", "suite.json"}, "solving rows (2)"}}) {
    const std::string text = OnATerminal(cwd(), arguments);
    EXPECT_LT(text.find(title), text.find(full)) << text;
    EXPECT_NE(text.find(full), std::string::npos) << text;
    const Outcome piped = Run(arguments);
    EXPECT_THAT(piped.err, testing::Not(testing::HasSubstr(title)));
  }
}

TEST_F(CliBatchTest, ADiskThatIsFullEndsTheRunWithOneLine) {
  const Outcome outcome =
      Run({"solve", "scene.xml", "--qpos-file", "rows.txt", "--json", "/dev/full"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(Lines(outcome.err).size(), 1u) << outcome.err;
}

TEST_F(CliBatchTest, OurOwnJsonLinesAreConfigurationsToo) {
  ASSERT_EQ(Solve({}).exit_code, 0);
  EXPECT_EQ(Run({"check", "scene.xml", "--qpos-file", "a.jsonl"}).exit_code, 0);
  const std::vector<Json> first = ParseLines(Read("a.jsonl"));
  const std::vector<Json> again = SolveJson({"scene.xml", "--qpos-file", "a.jsonl"});
  ASSERT_EQ(again.size(), first.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(again[k]["status"], "already_free");
    EXPECT_EQ(again[k]["qpos"], first[k]["qpos"]);
  }
  Write("bad.jsonl", "{\"qpos\": [0, 0]}\n{\"q\": 1}\n");
  ExpectRefused({"check", "scene.xml", "--qpos-file", "bad.jsonl"},
                "bad.jsonl line 2: has no qpos");
}

TEST_F(CliBatchTest, SeveralModelsGoInOneCallAndRowsNameTheirs) {
  Write("sub/other.xml", kBallAndWall);
  const std::vector<Json> lines = SolveJson({"scene.xml", "sub/other.xml", "--key", "deep"});
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["model"], "scene.xml");
  EXPECT_EQ(lines[1]["model"], "sub/other.xml");
  EXPECT_EQ(lines[1]["index"], 0);
  EXPECT_EQ(lines[0]["qpos"], lines[1]["qpos"]);
  const Outcome table = Run({"check", "scene.xml", "sub/other.xml"});
  EXPECT_EQ(table.exit_code, 3);
  EXPECT_THAT(table.out, testing::HasSubstr("4 configurations: 2 free, 2 not free"));
  EXPECT_THAT(table.out, testing::HasSubstr("sub/other.xml"));
  EXPECT_FALSE(SolveJson({"scene.xml"}).at(0).contains("model"));
  // A bad one is told before any work.
  Write("broken.xml", "<mujoco>");
  ExpectRefused({"solve", "scene.xml", "broken.xml", "--json", "a.jsonl"}, "broken.xml");
  ExpectRefused({"solve", "scene.xml", "sub/other.xml", "--out-qpos", "q.npy"}, "single model");
  // Rows of the first model, and of part of the second, stand already.
  ASSERT_EQ(Run({"solve", "scene.xml", "sub/other.xml", "--json", "b.jsonl"}).exit_code, 0);
  const std::vector<std::string> whole = Lines(Read("b.jsonl"));
  ASSERT_EQ(whole.size(), 4u);
  for (const std::size_t done : {1, 2, 3}) {
    Write("b.jsonl.part", Joined(whole, done));
    ASSERT_EQ(
        Run({"solve", "scene.xml", "sub/other.xml", "--json", "b.jsonl", "--resume"}).exit_code, 0);
    const std::vector<std::string> resumed = Lines(Read("b.jsonl"));
    ASSERT_EQ(resumed.size(), 4u);
    EXPECT_EQ(Joined(resumed, done), Joined(whole, done));
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
