// mjcf-pdg check --motion: what it writes, its exit codes, what it refuses.
#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;

class CliMotionTest : public CliTest {
 protected:
  // With the ball at (x, z) in kBallAndWall: it touches the wall at z = 0.05.
  static Arguments From(const std::string& from, const std::string& to) {
    return {"check", "scene.xml", "--motion", "--from", from, "--to", to};
  }
  static Arguments With(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  Json JsonOf(const Arguments& arguments, int exit_code) const {
    const Outcome outcome = Run(With(arguments, {"--json", "-"}));
    EXPECT_EQ(outcome.exit_code, exit_code);
    EXPECT_EQ(outcome.err, "");
    const std::vector<Json> lines = ParseLines(outcome.out);
    return lines.size() == 1 ? lines[0] : Json::object();
  }
};

TEST_F(CliMotionTest, JsonTellsHowFarTheMotionIsFree) {
  const Json free = JsonOf(From("0 .2", "3 .2"), 0);
  EXPECT_EQ(free["outcome"], "free");
  EXPECT_EQ(free["t"], 1.0);
  EXPECT_EQ(free["certified"], true);
  EXPECT_EQ(free["pairs"], Json::array());
  EXPECT_EQ(free["qpos"], (Json{3.0, 0.2}));
  EXPECT_GT(free["poses"], 0);
  EXPECT_GE(free["distance_queries"], 0);

  const Json contact = JsonOf(From("0 .2", "0 -1"), 3);
  EXPECT_EQ(contact["outcome"], "contact");
  EXPECT_NEAR(contact["t"], 0.125, 1e-5);
  EXPECT_EQ(contact["pairs"], (Json{{{"geom1", "sphere"}, {"geom2", "wall"}}}));
  EXPECT_FALSE(contact.contains("joint"));

  EXPECT_EQ(JsonOf(From("0 0", "0 1"), 3)["outcome"], "start_in_collision");
}

TEST_F(CliMotionTest, AGeomWithoutANameIsANumberAndALimitNamesItsJoint) {
  Write("scene.xml", R"(<mujoco><worldbody><geom type="box" size="1 1 .1"/>
      <body pos="0 0 .5"><joint name="down" type="slide" axis="0 0 -1" range="-1 .7"/>
      <geom size=".1"/></body></worldbody></mujoco>)");
  EXPECT_EQ(JsonOf(From("0", "2"), 3)["pairs"], (Json{{{"geom1", 1}, {"geom2", 0}}}));
  const Json limit = JsonOf(From("0", "-2"), 3);
  EXPECT_EQ(limit["outcome"], "limit");
  EXPECT_EQ(limit["joint"], "down");
  EXPECT_NEAR(limit["t"], 0.5, 1e-9);
}

TEST_F(CliMotionTest, PeopleReadASentence) {
  const Outcome contact = Run(From("0 .2", "0 -1"));
  EXPECT_EQ(contact.exit_code, 3);
  for (const char* words :
       {"free up to t = 0.125", "wall", "sphere", "poses", "distance queries"}) {
    EXPECT_NE(contact.out.find(words), std::string::npos) << contact.out;
  }
  const Outcome free = Run(From("0 .2", "3 .2"));
  EXPECT_EQ(free.exit_code, 0);
  EXPECT_NE(free.out.find("free all the way"), std::string::npos);
  const Outcome start = Run(From("0 0", "0 1"));
  EXPECT_EQ(start.exit_code, 3);
  EXPECT_NE(start.out.find("not free where it starts"), std::string::npos);
}

TEST_F(CliMotionTest, OptionsOfCheckHold) {
  EXPECT_EQ(Run(With(From("0 0", "0 1"), {"--rest", ".06"})).exit_code, 0);
  EXPECT_EQ(Run(With(From("0 0", "0 1"), {"--tolerance", ".06"})).exit_code, 0);
  ASSERT_EQ(Run(With(From("0 .2", "3 .2"), {"--json", "motion.json"})).exit_code, 0);
  EXPECT_EQ(Json::parse(Read("motion.json"))["outcome"], "free");
}

TEST_F(CliMotionTest, WhatCannotBeIsRefused) {
  ExpectRefused({"check", "scene.xml", "--motion"}, "--from");
  ExpectRefused({"check", "scene.xml", "--motion", "--from", "0 0"}, "--to");
  ExpectRefused({"check", "scene.xml", "--from", "0 0", "--to", "0 0"}, "--motion");
  ExpectRefused(With(From("0 0", "0 0"), {"--key", "deep"}), "--key");
  ExpectRefused(From("0 0 0", "0 0"), "--from: qpos has 3 values");
  ExpectRefused(From("0 0", "0 x"), "--to");
  ExpectRefused(With(From("0 .2", "1 .2"), {"--json", "scene.xml"}), "scene.xml");
  Write("two.xml", R"(<mujoco><worldbody><body name="a"><joint/><geom size=".1"/></body>
      <body name="b" pos="1 0 0"><joint name="jb"/><geom size=".1"/></body></worldbody></mujoco>)");
  ExpectRefused({"check", "two.xml", "--movable", "a", "--motion", "--from", "0 0", "--to", "1 1"},
                "jb");
}

}  // namespace
}  // namespace mjcf_pdg::test
