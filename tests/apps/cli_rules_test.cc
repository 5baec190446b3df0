// The program's options that say what of a model counts: pairs, equality constraints, margins,
// flags and flexes.
#include <gtest/gtest.h>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

class CliRulesTest : public CliTest {};

constexpr char kTwoBalls[] = R"(<mujoco><worldbody>
  <body name="a"><joint name="ja" type="slide"/><geom size=".1"/></body>
  <body name="b" pos="1 0 0"><joint name="jb" type="slide"/><geom size=".1"/></body></worldbody>
  <equality><joint name="couple" joint1="ja" joint2="jb"/></equality></mujoco>)";

// A ball on a slide over a floor, which MuJoCo pushes on up to a centimetre.
constexpr char kMargin[] = R"(<mujoco><worldbody>
  <geom type="plane" size="1 1 1"/>
  <body name="ball"><joint type="slide" axis="0 0 1" range="0 1" limited="true"/>
    <geom name="ball" size=".1" margin=".01"/></body></worldbody></mujoco>)";

TEST_F(CliRulesTest, EqualitiesAreHeldOrIgnored) {
  Write("coupled.xml", kTwoBalls);
  const nlohmann::json held = SolveJson({"coupled.xml", "--qpos", "0 1"})[0];
  EXPECT_EQ(held["status"], "solved");
  EXPECT_EQ(held["equality_residual_in"], 1.0);
  EXPECT_LE(held["equality_residual"], 1e-6);
  EXPECT_NEAR(held["qpos"][0].get<double>(), held["qpos"][1].get<double>(), 1e-6);
  const nlohmann::json ignored =
      SolveJson({"coupled.xml", "--qpos", "0 1", "--equality", "ignore"})[0];
  EXPECT_EQ(ignored["status"], "already_free");
  EXPECT_FALSE(ignored.contains("equality_residual"));
  const Outcome check = Run({"check", "coupled.xml", "--qpos", "0 1"});
  EXPECT_EQ(check.exit_code, 3);
  EXPECT_NE(check.out.find("'couple' is violated by 1"), std::string::npos) << check.out;
  EXPECT_EQ(Run({"check", "coupled.xml", "--qpos", "0 1", "--equality", "ignore"}).exit_code, 0);
  ExpectRefused({"solve", "coupled.xml", "--equality", "some"}, "--equality");
  ExpectRefused({"solve", "coupled.xml", "--method", "paper"}, "couple");
  const Outcome motion = Run({"check", "coupled.xml", "--motion", "--from", "0 0", "--to", "-1 1"});
  EXPECT_EQ(motion.exit_code, 0);
  EXPECT_NE(motion.err.find("leaves the model's equality constraints aside"), std::string::npos);
  EXPECT_EQ(Run({"norm", "coupled.xml", "--from", "0 0", "--to", "0 1"}).exit_code, 0);
}

// A ball on a string of at most a metre.
TEST_F(CliRulesTest, TendonLimitsAreHeldWhenAsked) {
  Write("kite.xml", R"(<mujoco><worldbody><site name="a"/>
    <body><joint type="slide" axis="1 0 0"/><geom size=".1"/><site name="b"/></body></worldbody>
    <tendon><spatial name="string" limited="true" range="0 1"><site site="a"/><site site="b"/></spatial>
    </tendon></mujoco>)");
  const Arguments hold = {"--tendon-limits", "hold"};
  const auto with = [&](Arguments arguments) {
    arguments.insert(arguments.end(), hold.begin(), hold.end());
    return arguments;
  };
  const nlohmann::json usual = SolveJson({"kite.xml", "--qpos", "1.5"})[0];
  EXPECT_EQ(usual["status"], "already_free");
  EXPECT_FALSE(usual.contains("tendon_excess"));
  const nlohmann::json held = SolveJson(with({"kite.xml", "--qpos", "1.5"}))[0];
  EXPECT_EQ(held["status"], "solved");
  EXPECT_NEAR(held["qpos"][0].get<double>(), 1.0, 2e-6);
  EXPECT_NEAR(held["tendon_excess_in"].get<double>(), 0.5, 1e-9);
  EXPECT_LE(held["tendon_excess"].get<double>(), 1e-6);
  EXPECT_NE(Run(with({"solve", "kite.xml", "--qpos", "1.5"})).out.find("tendons"),
            std::string::npos);
  EXPECT_EQ(Run({"check", "kite.xml", "--qpos", "1.5"}).exit_code, 0);
  const Outcome check = Run(with({"check", "kite.xml", "--qpos", "1.5"}));
  EXPECT_EQ(check.exit_code, 3);
  EXPECT_NE(check.out.find("tendon 'string' has length 1.5"), std::string::npos) << check.out;
  EXPECT_EQ(Run(with({"audit", "kite.xml"})).exit_code, 0);
  const Outcome motion = Run(with({"check", "kite.xml", "--motion", "--from", "0", "--to", "3"}));
  EXPECT_EQ(motion.exit_code, 0);
  EXPECT_NE(motion.err.find("leaves tendon limits aside"), std::string::npos) << motion.err;
  ExpectRefused(with({"solve", "kite.xml", "--method", "paper"}), "tendon limits");
  ExpectRefused({"solve", "kite.xml", "--tendon-limits", "some"}, "--tendon-limits");
}

TEST_F(CliRulesTest, MarginsAreCountedOrKept) {
  Write("margin.xml", kMargin);
  EXPECT_EQ(SolveJson({"margin.xml", "--qpos", ".05"})[0]["pushed_pairs"], 1);
  const nlohmann::json kept = SolveJson({"margin.xml", "--qpos", ".05", "--clearance", "model"})[0];
  EXPECT_EQ(kept["pushed_pairs"], 0);
  EXPECT_NEAR(kept["qpos"][0].get<double>(), .11, 1e-5);
  const nlohmann::json wide = SolveJson({"margin.xml", "--qpos", ".05", "--clearance", ".02"})[0];
  EXPECT_NEAR(wide["qpos"][0].get<double>(), .12, 1e-5);
  EXPECT_FALSE(SolveJson({"scene.xml"})[0].contains("pushed_pairs"));
  for (const char* verb : {"solve", "check"}) {
    const Outcome outcome = Run({verb, "margin.xml", "--qpos", ".105"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.out.find("still pushes on 1 pair within"), std::string::npos) << outcome.out;
  }
  EXPECT_EQ(Run({"check", "margin.xml", "--qpos", ".2"}).out.find("pushes"), std::string::npos);
  ExpectRefused({"solve", "margin.xml", "--clearance", "much"}, "--clearance");
  ExpectRefused({"solve", "margin.xml", "--clearance", "-1"}, "--clearance");
}

TEST_F(CliRulesTest, WhatTheModelDisablesIsSaidAndHonouredWhenAsked) {
  Write("flag.xml", R"(<mujoco><option><flag limit="disable"/></option><worldbody>
    <body><joint type="slide" range="0 1" limited="true"/><geom size=".1"/></body>
    </worldbody></mujoco>)");
  const Outcome counts = Run({"check", "flag.xml", "--qpos", "2"});
  EXPECT_EQ(counts.exit_code, 3);
  EXPECT_NE(counts.err.find("disables joint limits"), std::string::npos) << counts.err;
  EXPECT_EQ(Run({"check", "flag.xml", "--qpos", "2", "--flags", "model"}).exit_code, 0);
  const Outcome honours = Run({"solve", "flag.xml", "--qpos", "2", "--flags", "model"});
  EXPECT_NE(honours.out.find("already_free"), std::string::npos) << honours.out;
  EXPECT_NE(honours.err.find("do not count"), std::string::npos) << honours.err;
  ExpectRefused({"solve", "flag.xml", "--flags", "some"}, "--flags");
}

TEST_F(CliRulesTest, FlexesAreLeftOutWhenAsked) {
  Write("flex.xml", R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
    <body name="b"><joint type="slide" axis="0 0 1"/><geom size=".1"/></body>
    <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" dim="2" mass="1">
      <edge equality="true"/></flexcomp></worldbody></mujoco>)");
  ExpectRefused({"solve", "flex.xml"}, "'cloth' is not supported (--flex ignore");
  const Outcome ignored = Run({"solve", "flex.xml", "--flex", "ignore"});
  EXPECT_EQ(ignored.exit_code, 0);
  EXPECT_NE(ignored.err.find("'cloth' is left out"), std::string::npos) << ignored.err;
  EXPECT_EQ(Run({"audit", "flex.xml", "--flex", "ignore"}).exit_code, 3) << "qpos0 penetrates";
}

TEST_F(CliRulesTest, PairsAreExcludedAllowedAndCounted) {
  const nlohmann::json excluded =
      SolveJson({"scene.xml", "--key", "deep", "--exclude", "wall,ball"})[0];
  EXPECT_EQ(excluded["status"], "already_free");
  const nlohmann::json allowed =
      SolveJson({"scene.xml", "--key", "deep", "--allow", "wall,sphere=.02"})[0];
  EXPECT_NEAR(allowed["qpos"][1].get<double>(), 0.03, 1e-5);
  EXPECT_EQ(allowed["contacts_kept"], 1);
  EXPECT_FALSE(allowed.contains("ignored"));
  const nlohmann::json fixed = SolveJson({"scene.xml", "--key", "deep", "--ignore-permanent"})[0];
  EXPECT_FALSE(fixed.contains("ignored"));
  ExpectRefused({"solve", "scene.xml", "--exclude", "wall"}, "--exclude");
  ExpectRefused({"solve", "scene.xml", "--exclude", "wall,nobody"}, "'nobody'");
  ExpectRefused({"solve", "scene.xml", "--allow", "wall,ball"}, "DEPTH");
  ExpectRefused({"solve", "scene.xml", "--allow", "wall,ball=x"}, "--allow");
  ExpectRefused({"solve", "scene.xml", "--fixed", "ball"}, "no joint may move");
}

}  // namespace
}  // namespace mjcf_pdg::test
