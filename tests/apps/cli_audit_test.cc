// mjcf-pdg audit: hand-made models whose findings are known.
#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <memory>

#include "tests/support/cli_test.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

// inner and outer turn about one axis: always in each other, two joints apart. The sliders overlap
// where they begin (by 2 cm) and by chance; the post is never reached.
constexpr char kModel[] = R"(<mujoco model="hand-made">
  <!-- <key name="begin" qpos="9 9 9 9"/> is not a keyframe -->
  <option gravity="0 0 -10"/>
  <worldbody>
    <geom name="post" type="sphere" size=".05" pos="0 0 9"/>
    <body name="inner"><joint name="a" axis="0 0 1"/><geom name="inner" size=".1"/>
      <body name="middle"><joint name="b" axis="0 0 1"/><geom name="arm" size=".01" pos="0 0 1"/>
        <body name="outer"><joint name="c" axis="0 0 1"/><geom name="outer" size=".08"/></body>
      </body>
    </body>
    <body name="slider" pos="5 0 0"><joint name="d" type="slide" axis="1 0 0" range="-1 1"/>
      <geom name="slider" type="box" size=".1 .1 .1" mass="1"/></body>
    <body name="block" pos="5.18 0 0"><geom name="block" type="box" size=".1 .1 .1"/></body>
  </worldbody>
  <keyframe>
    <key name="begin" qpos="0 0 0 0"/>
    <key name="apart" qpos="0 0 0 -.5"/>
    <key name="beyond" qpos='0 0 0 -1.5'/>
  </keyframe>
</mujoco>
)";

class CliAuditTest : public CliTest {
 protected:
  Json Audit(Arguments arguments, int exit_code) const {
    arguments.insert(arguments.begin(), "audit");
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    const std::vector<Json> lines = ParseLines(outcome.out);
    return lines.empty() ? Json() : lines[0];
  }
};

TEST_F(CliAuditTest, FindsWhatAHandMadeModelHas) {
  Write("model.xml", kModel);
  const Json audit = Audit({"model.xml", "--samples", "2000"}, 3);
  ASSERT_EQ(audit["pairs"].size(), 2u) << audit.dump(1);
  const Json& permanent = audit["pairs"][0];
  EXPECT_EQ(permanent["class"], "permanent");
  EXPECT_EQ(permanent["geom1"], "inner");
  EXPECT_EQ(permanent["geom2"], "outer");
  EXPECT_EQ(permanent["share"], 1.0);
  EXPECT_NEAR(permanent["depth"].get<double>(), -0.18, 1e-9);
  const Json& by_default = audit["pairs"][1];
  EXPECT_EQ(by_default["class"], "default");
  // The slider overlaps for d in (-.02, .38): a fifth of its range, within four standard
  // deviations.
  EXPECT_NEAR(by_default["share"].get<double>(), 0.2, 4.0 * std::sqrt(0.2 * 0.8 / 2000));
  EXPECT_EQ(audit["exclude"], Json::parse(R"([["inner", "outer"]])"));
  EXPECT_GT(audit["never"].get<int>(), 3);
  EXPECT_NEAR(audit["never_share_below"].get<double>(), 3.0 / 2000, 1e-4);  // the rule of three
  ASSERT_EQ(audit["keyframes"].size(), 4u);
  const Json &begin = audit["keyframes"][1], &apart = audit["keyframes"][2],
             &beyond = audit["keyframes"][3];
  EXPECT_EQ(audit["keyframes"][0]["name"], "qpos0");
  EXPECT_NEAR(begin["depth"].get<double>(), 0.18, 1e-9);
  EXPECT_EQ(apart["limit_excess"], 0.0);
  EXPECT_NEAR(beyond["limit_excess"].get<double>(), 0.5, 1e-9);
  EXPECT_GT(begin["force_over_weight"].get<double>(), 1.0);
}

TEST_F(CliAuditTest, SometimesIsNotWrongAndSeedsRepeat) {
  Write("model.xml", R"(<mujoco><worldbody><geom name="wall" type="box" size=".1 1 1"/>
      <body name="cart" pos="1 0 0"><joint type="slide" axis="1 0 0" range="-1 1"/>
      <geom name="cart" size=".1"/></body></worldbody></mujoco>)");
  const Json audit = Audit({"model.xml"}, 0);
  ASSERT_EQ(audit["pairs"].size(), 1u);
  EXPECT_EQ(audit["pairs"][0]["class"], "sometimes");
  EXPECT_EQ(Audit({"model.xml"}, 0), audit);
  EXPECT_NE(Audit({"model.xml", "--seed", "1"}, 0), audit);
}

// The text stays as it was but for the lines that are asked for, and what it then says is free.
TEST_F(CliAuditTest, AFixedModelIsTheSameTextAndFree) {
  Write("model.xml", kModel);
  EXPECT_EQ(Run({"audit", "model.xml", "--fix", "fixed.xml"}).exit_code, 3);
  const std::string exclude = "<exclude body1=\"inner\" body2=\"outer\"/>";
  EXPECT_THAT(Read("fixed.xml"),
              HasSubstr("  <contact>\n    " + exclude + "\n  </contact>\n</muj"));
  EXPECT_THAT(Read("fixed.xml"), HasSubstr("<!-- <key name=\"begin\" qpos=\"9 9 9 9\"/>"));
  EXPECT_THAT(Read("fixed.xml"), HasSubstr("<key name=\"apart\" qpos=\"0 0 0 -.5\"/>"));
  EXPECT_THAT(Read("fixed.xml"), HasSubstr("<key name=\"beyond\" qpos='"));
  EXPECT_EQ(Run({"check", "fixed.xml"}).exit_code, 0);
  const Json audit = Audit({"fixed.xml"}, 0);
  EXPECT_EQ(audit["keyframes"].size(), 4u);
  EXPECT_EQ(Read("model.xml"), kModel);
}

// A ball that has sunk into a plate by `depth` in its keyframe "deep", which stands in `keyframe`.
std::string Sunk(const std::string& keyframe) {
  return R"(<mujoco><!-- kept --><worldbody><geom name="plate" type="box" size="1 1 .1"/>
    <body name="ball" pos="0 0 1"><joint type="slide" axis="0 0 1"/><geom name="ball" size=".1"/>
    </body></worldbody>)" +
         keyframe + "</mujoco>";
}

constexpr char kDeepKey[] = R"(<keyframe><key name="deep" qpos="-.85"/></keyframe>)";

// Robots keep keyframes in the file that their scenes include.
TEST_F(CliAuditTest, KeyframesOfIncludedFilesAreMendedInTheirPlace) {
  Write("sub/robot.xml", Sunk("<include file=\"keys.xml\"/>"));
  Write("sub/keys.xml", std::string("<?xml version=\"1.0\"?>\n<!-- <mujoco> --><mujocoinclude>") +
                            kDeepKey + "<!-- <key --></mujocoinclude>\n");
  Write("light.xml", "<mujocoinclude><worldbody><light/></worldbody></mujocoinclude>");
  const std::string light = "<include file='light.xml' />",
                    robot = "<include file=\"sub/robot.xml\">";
  Write("scene.xml", "<mujoco>" + light + "\n" + robot + "\n</include>\n</mujoco>\n");
  ASSERT_EQ(Run({"check", "scene.xml"}).exit_code, 3);
  const Outcome outcome = Run({"audit", "scene.xml", "--fix", "fixed.xml"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(Run({"check", "fixed.xml"}).exit_code, 0);
  const std::string fixed = Read("fixed.xml");
  EXPECT_THAT(fixed, HasSubstr("<mujoco>" + light + "\n<!-- kept --><worldbody>"));
  EXPECT_THAT(fixed, testing::Not(HasSubstr("robot.xml")));
  EXPECT_THAT(fixed, HasSubstr("<keyframe><key name=\"deep\" qpos=\"-0.8"));
  EXPECT_THAT(fixed, testing::EndsWith("<!-- <key -->\n</mujoco>\n"));
  EXPECT_EQ(Audit({"fixed.xml"}, 0)["keyframes"][1]["name"], "deep");
}

// <size nkey> makes keyframes that do not stand in the text.
TEST_F(CliAuditTest, KeyframesThatAreOnlyCountedAreMended) {
  std::string xml = Sunk(std::string("<size nkey=\"3\"/>") + kDeepKey);
  xml.replace(xml.find("pos=\"0 0 1\""), 11, "pos=\"0 0 .15\"");
  Write("model.xml", xml);
  const Outcome outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_EQ(outcome.err, "");
  const Outcome check = Run({"check", "fixed.xml"});
  EXPECT_EQ(check.exit_code, 0);
  EXPECT_THAT(check.out, HasSubstr("3 configurations: 3 free"));
  EXPECT_EQ(Audit({"fixed.xml"}, 0)["keyframes"].size(), 4u);
}

// Angles in degrees, poses written in every way, a body without a name, joints of a class: what is
// deep in the floor at qpos0 begins outside, and all else stays.
constexpr char kSunkAtReset[] = R"(<mujoco>
  <default><default class="stiff"><joint damping="1" ref="10"/></default></default>
  <worldbody>
    <geom name="floor" type="plane" size="3 3 .1"/>
    <body name="mug" pos="1 0 .03" euler="10 0 30"><freejoint/>
      <geom name="mug" type="box" size=".05 .05 .05"/></body>
    <body pos="0 0 .1"><joint axis="0 0 1"/>
      <geom name="shoulder" type="cylinder" size=".05 .05"/>
      <body name="lower" pos="0 0 .1" axisangle="0 1 0 130">
        <joint class="stiff" axis="0 1 0" pos="0 0 .02" range="-120 120"/>
        <geom name="forearm" type="capsule" size=".03" fromto="0 0 .07 0 0 .4"/>
      </body>
    </body>
    <body name="lift" pos="-1 0 .05"><joint type="slide" axis="0 0 2" ref=".3"/>
      <geom name="lift" size=".1"/></body>
    <body name="wrist" pos="0 2 .1" euler="20 10 0"><joint axis="0 1 0" pos="0 .02 .1" ref="5"/>
      <joint type="slide" axis="1 0 1" range="-.1 .1" limited="true"/><joint axis="1 0 0"/>
      <joint axis="0 0 1" pos=".1 0 0"/>
      <geom name="wrist" type="box" size=".3 .1 .02" pos=".2 .1 0"/></body>
  </worldbody>
  <keyframe><key name="up" qpos="1 0 1 1 0 0 0 .2 -.8 .4 -.9 .05 0 0"/></keyframe>
</mujoco>
)";

TEST_F(CliAuditTest, AModelThatPenetratesAtResetBeginsFree) {
  Write("model.xml", kSunkAtReset);
  const Outcome outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(outcome.err, "");
  const Json audit = Audit({"fixed.xml"}, 0);
  EXPECT_EQ(audit["keyframes"].size(), 2u);
  const auto load = [&](const char* name) {
    return std::unique_ptr<mjModel, void (*)(mjModel*)>(
        mj_loadXML((cwd() / name).c_str(), nullptr, nullptr, 0), mj_deleteModel);
  };
  const auto before = load("model.xml"), after = load("fixed.xml");
  ASSERT_TRUE(before && after);
  // It begins at what solve makes of the old beginning,
  std::string q;
  for (int k = 0; k < before->nq; ++k) q += std::to_string(before->qpos0[k]) + " ";
  const Json solved = SolveJson({"model.xml", "--qpos", q}).at(0);
  for (int k = 0; k < before->nq; ++k) {
    EXPECT_NEAR(after->qpos0[k], solved["qpos"][static_cast<std::size_t>(k)], 1e-5) << k;
  }
  // and the joints mean what they meant.
  std::unique_ptr<mjData, void (*)(mjData*)> one(mj_makeData(before.get()), mj_deleteData),
      other(mj_makeData(after.get()), mj_deleteData);
  Random random(4);
  for (int sample = 0; sample < 20; ++sample) {
    for (int k = 0; k < before->nq; ++k) one->qpos[k] = other->qpos[k] = random.Uniform(-1.0, 1.0);
    mj_kinematics(before.get(), one.get());
    mj_kinematics(after.get(), other.get());
    for (int k = 0; k < 3 * before->ngeom; ++k) {
      EXPECT_NEAR(one->geom_xpos[k], other->geom_xpos[k], 1e-9);
    }
    for (int k = 0; k < 9 * before->ngeom; ++k) {
      EXPECT_NEAR(one->geom_xmat[k], other->geom_xmat[k], 1e-9);
    }
  }
}

// Servos hold what is repaired: their setpoints move with the joints, also of a model that begins
// elsewhere, whose controls begin at 0.
TEST_F(CliAuditTest, ServosDoNotPullWhatIsMendedBack) {
  const auto model = [](const std::string& place) {
    return R"(<mujoco><worldbody><geom name="plate" type="box" size="1 1 .1"/><body name="ball")" +
           (" pos=\"0 0 " + place + "\"") +
           R"(><joint name="z" type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody>
      <actuator><position joint="z" kp="100"/><motor joint="z"/></actuator>
      <keyframe><key name="deep" qpos="-.85" ctrl="-.9 .3"/></keyframe></mujoco>)";
  };
  const auto setpoint = [this](int key) {
    const std::unique_ptr<mjModel, void (*)(mjModel*)> m(
        mj_loadXML((cwd() / "fixed.xml").c_str(), nullptr, nullptr, 0), mj_deleteModel);
    EXPECT_NE(m, nullptr);
    EXPECT_LT(key, m->nkey);
    return std::array<double, 3>{m->key_qpos[key], m->key_ctrl[2 * key], m->key_ctrl[2 * key + 1]};
  };
  Write("model.xml", model("1"));
  Outcome outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("mended in fixed.xml: 1 keyframe\n"));
  EXPECT_NEAR(setpoint(0)[0], -0.8, 1e-5);
  EXPECT_NEAR(setpoint(0)[1], -0.85, 1e-5) << "as far below the joint as before";
  EXPECT_EQ(setpoint(0)[2], 0.3) << "a motor's control is no place";

  Write("model.xml", model(".15"));
  outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_THAT(outcome.err, HasSubstr("position actuators pull qpos0 back"));
  EXPECT_THAT(outcome.out, HasSubstr("mended in fixed.xml: qpos0\n"));
  EXPECT_NEAR(setpoint(1)[0], 0.05, 1e-5);
  EXPECT_NEAR(setpoint(1)[1], 0.05, 1e-5) << "qpos0_pdg";

  // So it is where an activation is the place that is pulled to.
  std::string integrated = model(".15");
  integrated.replace(integrated.find("<position"), 9, "<intvelocity actrange=\"-2 2\"");
  Write("model.xml", integrated);
  outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_THAT(outcome.err, HasSubstr("position actuators pull qpos0 back"));
  EXPECT_THAT(Read("fixed.xml"), HasSubstr(" act=\""));
  EXPECT_EQ(Run({"check", "fixed.xml"}).exit_code, 0);
}

// A body with a ball joint stays, and the cart that carries it begins elsewhere. Bodies of an
// attached model, and those without a name, are told from the others.
TEST_F(CliAuditTest, WhatCanBePlacedMovesForWhatCannot) {
  Write("model.xml", R"(<mujoco><asset><model name="other" file="other.xml"/></asset><worldbody>
      <geom name="floor" type="plane" size="3 3 .1"/>
      <body name="cart" pos="0 0 .2"><joint type="slide" axis="0 0 1"/><geom size=".01" mass="1"/>
        <body name="wrist" pos=".5 0 0"><joint type="ball"/>
          <geom name="hand" type="box" size=".1 .1 .3" pos=".15 .1 0"/></body></body>
      <body pos="2 0 1"><joint/><geom size=".1"/></body>
      <frame pos="-2 0 1"><attach model="other" body="ball" prefix="other-"/></frame>
      </worldbody></mujoco>)");
  Write("other.xml", R"(<mujoco><worldbody><body name="ball"><freejoint/><geom size=".1"/></body>
      </worldbody></mujoco>)");
  const Outcome outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(Audit({"fixed.xml"}, 0)["keyframes"].size(), 1u);
  EXPECT_THAT(Read("fixed.xml"),
              HasSubstr("<body name=\"wrist\" pos=\".5 0 0\"><joint type=\"ball"));
}

// MJCF excludes bodies by name.
TEST_F(CliAuditTest, BodiesWithoutANameAreNamedToBeExcluded) {
  const std::string model = R"(<mujoco><worldbody>
      <body><joint/><geom size=".1"/><body><joint type="ball"/><geom size=".01" pos="0 0 .5"/>
        <body name="hand"><joint type="ball"/><geom size=".05"/></body></body></body>
      <body pos="2 0 0"><joint/><geom size=".1"/></body></worldbody></mujoco>)";
  Write("model.xml", model);
  const Outcome outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(Audit({"fixed.xml"}, 0)["warnings"].size(), 0u);
  std::string fixed = Read("fixed.xml");
  EXPECT_THAT(fixed, HasSubstr("<exclude body1=\"body_pdg_1\" body2=\"hand\"/>"));
  // Only the name and the line are new.
  fixed.erase(fixed.find(" name=\"body_pdg_1\""), 18);
  fixed.erase(fixed.find("  <contact>"), fixed.find("</mujoco>") - fixed.find("  <contact>"));
  EXPECT_EQ(fixed, model);
}

// A robot that is driven by a weld to a mocap body counts from where it begins. If it begins
// outside its limits, that stays, and what it overlaps moves away all the same.
TEST_F(CliAuditTest, LimitsThatHaveToStayLeftKeepNoOverlap) {
  Write("model.xml", R"(<mujoco><worldbody>
      <body name="goal" mocap="true"/>
      <body name="arm"><joint type="slide" axis="0 0 1" range="1 2" limited="true"/>
        <geom name="arm" size=".1"/></body>
      <body name="cup" pos=".15 0 0"><freejoint/><geom name="cup" size=".1"/></body>
      </worldbody><equality><weld body1="goal" body2="arm"/></equality></mujoco>)");
  const Outcome outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_THAT(outcome.err, HasSubstr("nothing overlaps at qpos0, but joints"));
  const Json keys = Audit({"fixed.xml"}, 3)["keyframes"];
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[0]["depth"], 0.0);
  EXPECT_NEAR(keys[0]["limit_excess"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(keys[1]["name"], "qpos0_pdg");
  EXPECT_EQ(Run({"check", "fixed.xml", "--key", "qpos0_pdg"}).exit_code, 0);
}

// Where MJCF cannot say it, a keyframe does: a ball joint begins at the identity, and a coupling of
// joints counts from where they begin.
TEST_F(CliAuditTest, ABeginningThatHasToStayGetsAKeyframeBesideIt) {
  const auto model = [](const std::string& type, const std::string& equality) {
    return R"(<mujoco><worldbody><geom name="floor" type="plane" size="3 3 .1"/>
      <body pos="0 0 .2"><joint name="a" axis="0 1 0" type=")" +
           type + R"("/><geom type="capsule" size=".03" fromto=".1 0 0 .5 0 -.25"/></body>
      <body pos="0 3 1"><joint name="b"/><geom size=".01"/></body></worldbody>)" +
           equality + "</mujoco>";
  };
  const std::string coupled = R"(<equality><joint joint1="b" joint2="a"/></equality>)";
  for (const std::string& xml : {model("ball", ""), model("hinge", coupled)}) {
    Write("model.xml", xml);
    const Outcome outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
    EXPECT_THAT(outcome.err, HasSubstr("warning: --fix: qpos0 stays"));
    EXPECT_THAT(Read("fixed.xml"), HasSubstr("name=\"qpos0_pdg\""));
    EXPECT_EQ(Run({"check", "fixed.xml"}).exit_code, 0);
  }
}

// What cannot be mended is said, and the rest is mended all the same. A weld to a mocap body, by
// which people drive a robot, is nothing that the solver holds.
TEST_F(CliAuditTest, WhatStaysWrongIsSaid) {
  std::string xml = Sunk(
      "<keyframe><key name=\"torn\" qpos=\"-.5\"/><key name=\"deep\" qpos=\"-.85\"/></keyframe>"
      "<equality><weld body1=\"hand\" body2=\"ball\"/></equality>");
  xml.insert(xml.find("</worldbody>"), "<body name=\"hand\" mocap=\"true\" pos=\"0 0 1\"/>");
  Write("model.xml", xml);
  const Outcome outcome = Run({"audit", "model.xml", "--fix", "fixed.xml"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("warning: --fix: keyframe torn stays: an equality"));
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("deep")));
  EXPECT_THAT(Read("fixed.xml"), HasSubstr("<key name=\"torn\" qpos=\"-.5\"/>"));
  EXPECT_EQ(Run({"check", "fixed.xml"}).exit_code, 0);
}

// Quotes may hold what would end a tag, and attributes may be long.
TEST_F(CliAuditTest, OddTagsAreReadAsXmlReadsThem) {
  std::string zeros;
  for (int i = 0; i < 100000; ++i) zeros += " 0";
  Write("model.xml",
        Sunk("<custom><numeric name=\"long\" data=\"" + zeros +
             "\"/></custom><keyframe><key\tname='a>b&amp;' time=\"1\"\n qpos = '-.85'/>"
             "<key qpos=\"" +
             std::string(200000, ' ') + "-.9\"></key></keyframe>"));
  ASSERT_EQ(Run({"check", "model.xml"}).exit_code, 3);
  EXPECT_EQ(Run({"audit", "model.xml", "--fix", "fixed.xml"}).exit_code, 3);
  EXPECT_EQ(Run({"check", "fixed.xml"}).exit_code, 0);
  EXPECT_THAT(Read("fixed.xml"), HasSubstr("<key\tname='a>b&amp;' time=\"1\"\n qpos = '-0.8"));
}

TEST_F(CliAuditTest, AKeyframeThatViolatesAnEqualityIsMended) {
  Write("model.xml", R"(<mujoco><worldbody>
      <body name="a"><joint name="a" type="slide"/><geom name="a" size=".1"/></body>
      <body name="b" pos="3 0 0"><joint name="b" type="slide"/><geom name="b" size=".1"/></body>
      </worldbody><equality><joint joint1="a" joint2="b"/></equality>
      <keyframe><key name="torn" qpos=".25 0"/></keyframe></mujoco>)");
  Audit({"model.xml", "--fix", "fixed.xml"}, 3);
  EXPECT_LE(Audit({"fixed.xml"}, 0)["keyframes"][1]["equality_residual"].get<double>(), 1e-6);
}

TEST_F(CliAuditTest, EqualitiesAndFlagsAreSeen) {
  Write("model.xml", R"(<mujoco><option><flag contact="disable"/></option><worldbody>
      <body name="a"><joint name="a" type="slide"/><geom name="a" size=".1"/></body>
      <body name="b" pos="3 0 0"><joint name="b" type="slide"/><geom name="b" size=".1"/></body>
      </worldbody><equality><joint joint1="a" joint2="b"/></equality>
      <keyframe><key name="torn" qpos=".25 0"/></keyframe></mujoco>)");
  const Json audit = Audit({"model.xml"}, 3);
  EXPECT_EQ(audit["keyframes"][0]["equality_residual"], 0.0);
  EXPECT_NEAR(audit["keyframes"][1]["equality_residual"].get<double>(), 0.25, 1e-9);
  EXPECT_THAT(audit["warnings"].dump(), HasSubstr("the model disables contacts"));
}

// The ball may sink 2 cm into the plate; in one keyframe it is 1 cm deep, in the other 3 cm.
TEST_F(CliAuditTest, OverlapsThatAMarginAllowsDoNotCount) {
  std::string xml = Sunk("<keyframe><key qpos=\"-.81\"/><key qpos=\"-.83\"/></keyframe>");
  xml.replace(xml.find("<geom name=\"ball\""), 5, "<geom margin=\"-.02\"");
  xml.replace(xml.find("<joint"), 6, "<joint range=\"-.819 1\" limited=\"true\"");
  Write("model.xml", xml);
  const Json audit = Audit({"model.xml"}, 3);
  EXPECT_EQ(audit["keyframes"][1]["depth"], 0.0);
  EXPECT_NEAR(audit["keyframes"][2]["depth"].get<double>(), 0.03, 1e-9);
  EXPECT_EQ(audit["pairs"][0]["class"], "default");
  EXPECT_EQ(audit["pairs"][0]["share"], 0.0) << "inside limits never deeper than allowed";
  EXPECT_THAT(audit["warnings"].dump(), HasSubstr("1 pair has a negative margin"));
}

TEST_F(CliAuditTest, SeveralModelsAndOneThatIsBroken) {
  Write("model.xml", kModel);
  Write("broken.xml", "<mujoco>");
  const Outcome outcome = Run({"audit", "model.xml", "broken.xml", "--junit", "out.xml"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("broken.xml\n  "));
  EXPECT_THAT(outcome.out, HasSubstr("<exclude body1=\"inner\" body2=\"outer\"/>"));
  EXPECT_THAT(Read("out.xml"),
              HasSubstr("<testsuite name=\"broken.xml\" tests=\"1\" failures=\"0\" errors=\"1\" "));
  EXPECT_THAT(Read("out.xml"), HasSubstr("inner and outer: permanent"));
}

TEST_F(CliAuditTest, RefusesWhatItCannotDo) {
  Write("model.xml", kModel);
  Write("broken.xml", "<mujoco>");
  Write("sub/other.xml", kModel);
  ExpectRefused({"audit"}, "MODEL");
  ExpectRefused({"audit", "broken.xml"}, "broken.xml");
  ExpectRefused({"audit", "none.xml"}, "none.xml");
  ExpectRefused({"audit", "model.xml", "--samples", "3"}, "--samples");
  ExpectRefused({"audit", "model.xml", "sub/other.xml", "--fix", "x.xml"}, "single model");
  ExpectRefused({"audit", "model.xml", "--fix", "sub/x.xml"}, "must be in the folder");
  ExpectRefused({"audit", "model.xml", "--fix", "model.xml"}, "input");
}

}  // namespace
}  // namespace mjcf_pdg::test
