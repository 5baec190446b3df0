// What the program refuses: exit code 2, one line that says what and where, nothing written.
#include <cstring>
#include <limits>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

using CliInputTest = CliTest;

template <typename Value = double>
std::string Npy(const std::string& dict, const std::vector<Value>& values) {
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(dict.size() & 0xFF);
  bytes += static_cast<char>(dict.size() >> 8);
  bytes += dict;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
  return bytes;
}

std::string Dict(const std::string& descr, const std::string& fortran, const std::string& shape) {
  return "{'descr': '" + descr + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }\n";
}

TEST_F(CliInputTest, RefusesUnknownVerbsAndFlags) {
  ExpectRefused({}, "verb");
  ExpectRefused({"watch", "scene.xml"}, "no verb 'watch'");
  ExpectRefused({"--frobnicate"}, "");
  ExpectRefused({"solve"}, "MODEL");
  ExpectRefused({"solve", "scene.xml", "--frobnicate"}, "--frobnicate");
  ExpectRefused({"solve", "scene.xml", "other.xml"}, "other.xml");
  ExpectRefused({"norm", "scene.xml", "--from", "0 0"}, "--to");
  ExpectRefused({"check", "scene.xml", "--threads", "2"}, "--threads");
}

TEST_F(CliInputTest, RefusesModelsThatAreNone) {
  Write("broken.xml", "<mujoco>\n<worldbody>");
  Write("unknown.xml", "<mujoco>\n<world/></mujoco>");
  Write("still.xml", "<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>");
  Write("meshless.xml", "<mujoco><asset><mesh file='none.obj'/></asset></mujoco>");
  Write("flex.xml", R"(<mujoco><worldbody><body name="b"><joint/><geom size=".1"/></body>
    <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" dim="2" mass="1"/>
    </worldbody></mujoco>)");
  Write("junk.xml", std::string("\x00\xff\x13\x00junk", 8));
  Write("junk.mjb", "junk");
  Write("notes.txt", "hello");
  // MuJoCo's own error handler would write MUJOCO_LOG.TXT and leave with exit code 1.
  Write("cramped.xml", R"(<mujoco><size memory="1"/><worldbody><body><joint/><geom size=".1"/>
    </body></worldbody></mujoco>)");
  Write("empty.xml", "");
  for (const std::string verb : {"solve", "check"}) {
    ExpectRefused({verb, "none.xml"}, "none.xml: no such file");
    ExpectRefused({verb, ""}, "empty file name");
    ExpectRefused({verb, "."}, "directory");
    ExpectRefused({verb, "broken.xml"}, "broken.xml");
    ExpectRefused({verb, "unknown.xml"}, "line 2");
    ExpectRefused({verb, "still.xml"}, "no joints");
    ExpectRefused({verb, "meshless.xml"}, "none.obj");
    ExpectRefused({verb, "flex.xml"}, "flex");
    ExpectRefused({verb, "junk.xml"}, "junk.xml");
    ExpectRefused({verb, "junk.mjb"}, "junk.mjb");
    ExpectRefused({verb, "notes.txt"}, "notes.txt: not a model");
    ExpectRefused({verb, "empty.xml"}, "empty.xml");
    ExpectRefused({verb, "cramped.xml"}, "memory");
  }
}

TEST_F(CliInputTest, RefusesValuesOutOfRange) {
  const std::vector<Arguments> flags = {
      {"--tolerance", "0"},     {"--tolerance", "-1e-6"},
      {"--tolerance", "nan"},   {"--tolerance", "inf"},
      {"--tolerance", "1e-6m"}, {"--tolerance", ""},
      {"--clearance", "-1"},    {"--clearance", "inf"},
      {"--rest", "-1e-3"},      {"--rest", "nan"},
      {"--time-limit", "0"},    {"--time-limit", "-5"},
      {"--time-limit", "x"},    {"--threads", "0"},
      {"--threads", "-2"},      {"--threads", "1.5"},
      {"--threads", "many"},    {"--seed", "-1"},
      {"--seed", "1e3"},        {"--effort", "huge"},
      {"--metric", "euclid"},   {"--json"},
      {"--json", ""},           {"--threads", "1", "--threads", "2"},
      {"--movable", "nobody"},  {"--movable", "ball,"},
      {"--movable", ""},        {"--root", "nobody"},
      {"--armature", "-1"},     {"--armature", "heavy"},
      {"--root", ""},           {"--root", "world"}};
  for (const Arguments& flag : flags) {
    Arguments arguments = {"solve", "scene.xml"};
    arguments.insert(arguments.end(), flag.begin(), flag.end());
    ExpectRefused(arguments, "");
  }
  ExpectRefused({"solve", "scene.xml", "--movable", "nobody"}, "bodies: ball");
  Write("nameless.xml",
        "<mujoco><worldbody><body><joint/><geom size='.1'/></body></worldbody></mujoco>");
  ExpectRefused({"solve", "nameless.xml", "--movable", "nobody"}, "bodies: none has a name");
  ExpectRefused({"solve", "scene.xml", "--effort", "huge"}, "fast|default|max");
}

TEST_F(CliInputTest, RefusesUnknownKeyframesAndListsTheValidOnes) {
  ExpectRefused({"solve", "scene.xml", "--key", "nope"}, "keyframes: deep, 1");
  for (const std::string key : {"2", "-1", "", "1.0", "99999999999"}) {
    ExpectRefused({"solve", "scene.xml", "--key", key}, "no keyframe");
  }
  Write("keyless.xml",
        "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>");
  ExpectRefused({"check", "keyless.xml", "--key", "0"}, "no keyframes");
  ExpectRefused({"solve", "scene.xml", "--key", "deep", "--qpos", "0 0"}, "excludes");
}

TEST_F(CliInputTest, RefusesBadNumbersOnTheCommandLine) {
  for (const std::string q : {"", "0", "0 0 0", "0 x", "0 nan", "inf 0", "-inf 0", "0 1e999",
                              "0,,0", ",0 0", "0 0,", "0;0", "0x1 0", "1 2e"}) {
    ExpectRefused({"solve", "scene.xml", "--qpos", q}, "--qpos");
    ExpectRefused({"norm", "scene.xml", "--from", "0 0", "--to", q}, "--to");
  }
  Write("free.xml",
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>");
  ExpectRefused({"solve", "free.xml", "--qpos", "0 0 0 0 0 0 0"}, "quaternion");
}

TEST_F(CliInputTest, RefusesBadTextFiles) {
  Write("ragged.csv", "0 0\n0,0\n\n1\n");
  Write("empty.txt", "");
  Write("blank.txt", " \n\n# only a comment\n");
  Write("words.csv", "x,z\n0,0\n");
  Write("nan.txt", "0 0\nnan 0\n");
  Write("binary.txt", std::string("0 0\n\x00\x01", 6));
  Write("rows.json", "[0, 0]");
  Write("folder.csv/file", "");
  auto refused = [this](const std::string& file, const std::string& words) {
    ExpectRefused({"solve", "scene.xml", "--qpos-file", file}, words);
    ExpectRefused({"check", "scene.xml", "--qpos-file", file}, words);
  };
  refused("none.csv", "none.csv: no such file");
  refused("ragged.csv", "ragged.csv line 4: 1 values, the model needs 2");
  refused("empty.txt", "is empty");
  refused("blank.txt", "no configuration");
  refused("words.csv", "words.csv line 1: 'x' is not a number");
  refused("nan.txt", "nan.txt line 2");
  refused("binary.txt", "binary");
  refused("rows.json", ".npy, .csv, .txt or .jsonl");
  refused("folder.csv", "is a directory");
  refused("", "empty file name");
  ExpectRefused({"solve", "scene.xml", "--qpos-file", "-"}, "stdin: is empty");
  ExpectRefused({"solve", "scene.xml", "--qpos-file", "-"}, "stdin line 2", "0 0\n0\n");
}

TEST_F(CliInputTest, ReadsSinglePrecision) {
  Write("rows.npy", Npy<float>(Dict("<f4", "False", "(2, 2)"), {0.25f, 0, -0.125f, 1}));
  const std::vector<nlohmann::json> rows = SolveJson({"scene.xml", "--qpos-file", "rows.npy"});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["qpos_in"], (std::vector<double>{0.25, 0.0}));
  EXPECT_EQ(rows[1]["qpos_in"], (std::vector<double>{-0.125, 1.0}));
}

TEST_F(CliInputTest, RefusesBadNpyFiles) {
  const std::string good = Npy(Dict("<f8", "False", "(2, 2)"), {0, 0, 0, 1});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::string long_header = good;
  long_header[8] = long_header[9] = '\xff';
  std::string huge_header("\x93NUMPY\x02\x00\xff\xff\xff\xff{}", 14);
  std::string version = good;
  version[6] = 9;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {Npy(Dict("<f2", "False", "(1, 2)"), {0}), "<f2"},
      {Npy(Dict("<f4", "False", "(1, 3)"), {0}), "1 x 3 float32"},
      {Npy(Dict(">f8", "False", "(1, 2)"), {0, 0}), "big-endian"},
      {Npy(Dict("<i8", "False", "(1, 2)"), {0, 0}), "<i8"},
      {Npy(Dict("<f8", "True", "(2, 2)"), {0, 0, 0, 0}), "Fortran"},
      {Npy(Dict("<f8", "False", "(1, 3)"), {0, 0, 0}), "3 values, the model needs 2"},
      {Npy(Dict("<f8", "False", "(3,)"), {0, 0, 0}), "3 values, the model needs 2"},
      {Npy(Dict("<f8", "False", "()"), {0}), "dimensions"},
      {Npy(Dict("<f8", "False", "(1, 1, 2)"), {0, 0}), "dimensions"},
      {Npy(Dict("<f8", "False", "(0, 2)"), {}), "no configuration"},
      {Npy(Dict("<f8", "False", "(2, 0)"), {}), "empty"},
      {Npy(Dict("<f8", "False", "(4294967296, 4294967296)"), {0}), "4294967296 x 4294967296"},
      {Npy(Dict("<f8", "False", "(x, 2)"), {0, 0}), "shape"},
      {Npy("{'descr': '<f8'}", {0, 0}), "fortran_order"},
      {Npy(Dict("<f8", "False", "(1, 2)"), {0, nan}), "row 0"},
      {good.substr(0, good.size() - 3), "bytes of data"},
      {good + "x", "bytes of data"},
      {good.substr(0, 40), "truncated"},
      {good.substr(0, 9), "truncated"},
      {long_header, "truncated"},
      {huge_header, "too long"},
      {version, "version 9"},
      {"0 0\n", "not a .npy file"},
      {"", "is empty"}};
  for (const auto& [bytes, words] : cases) {
    Write("rows.npy", bytes);
    ExpectRefused({"solve", "scene.xml", "--qpos-file", "rows.npy"}, words);
  }
  Write("rows.npy", good);
  EXPECT_EQ(SolveJson({"scene.xml", "--qpos-file", "rows.npy"}).size(), 2u);
  Write("rows.npy", Npy(Dict("<f8", "False", "(2,)"), {0, 1}));
  EXPECT_EQ(SolveJson({"scene.xml", "--qpos-file", "rows.npy"}).size(), 1u);
}

TEST_F(CliInputTest, RefusesOutputsThatCannotBeWritten) {
  Write("rows.csv", "0 0\n");
  std::filesystem::create_symlink("scene.xml", cwd() / "link.xml");
  auto refused = [this](const Arguments& flags, const std::string& words) {
    Arguments arguments = {"solve", "scene.xml", "--qpos-file", "rows.csv"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    ExpectRefused(arguments, words);
  };
  for (const std::string flag : {"--json", "--out-qpos", "--out-mjcf"}) {
    const std::string ending = flag == "--out-qpos" ? ".csv" : ".xml";
    refused({flag, "none/out" + ending}, "no such folder");
    refused({flag, "/proc/out" + ending}, "cannot be written");
    refused({flag, ""}, "empty file name");
  }
  refused({"--json", "."}, "is a directory");
  refused({"--json", "rows.csv"}, "input");
  refused({"--out-qpos", "./rows.csv"}, "input");
  refused({"--out-mjcf", "scene.xml"}, "input");
  refused({"--out-mjcf", "link.xml"}, "input");
  refused({"--out-mjcf", "-"}, "not a file");
  refused({"--out-qpos", "out.json"}, ".npy, .csv, .txt or .jsonl");
  refused({"--json", "out.csv", "--out-qpos", "./out.csv"}, "--json already writes there");
  refused({"--json", "-", "--out-qpos", "-"}, "--json already writes there");
  EXPECT_EQ(Read("scene.xml"), kBallAndWall);
  EXPECT_EQ(Read("rows.csv"), "0 0\n");
}

TEST_F(CliInputTest, NoFileAppearsWhereAStreamCannotBeWritten) {
  const Outcome outcome = Run({"solve", "scene.xml", "--json", "/dev/full", "--out-qpos", "q.npy"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(cwd() / "q.npy"));
}

TEST_F(CliInputTest, AnOldOutputSurvivesAFailureAndALinkStaysALink) {
  Write("old.jsonl", "old");
  ExpectRefused({"solve", "scene.xml", "--key", "nope", "--json", "old.jsonl"}, "nope");
  EXPECT_EQ(Read("old.jsonl"), "old");
  std::filesystem::create_symlink("old.jsonl", cwd() / "link.jsonl");
  EXPECT_EQ(Run({"solve", "scene.xml", "--json", "link.jsonl"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(cwd() / "link.jsonl"));
  EXPECT_EQ(ParseLines(Read("old.jsonl")).size(), 2u);
}

}  // namespace
}  // namespace mjcf_pdg::test
