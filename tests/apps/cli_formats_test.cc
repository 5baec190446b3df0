// Models as URDF, in ROS packages, compiled by another MuJoCo; scenes that can be moved.
#include <mujoco/mujoco.h>

#include <cstring>
#include <string>

#include "tests/support/cli_test.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

namespace fs = std::filesystem;

constexpr char kTetrahedron[] =
    "v 0 0 0\nv .2 0 0\nv 0 .2 0\nv 0 0 .2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
constexpr char kLargerTetrahedron[] =
    "v 0 0 0\nv .3 0 0\nv 0 .3 0\nv 0 0 .3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

// Two links on a box; the second joint follows the first, with a factor 1.5 and 0.1 more. Its mesh
// is called `mesh`.
std::string ArmUrdf(const std::string& mesh) {
  const auto link = [](const std::string& name, const std::string& origin,
                       const std::string& shape) {
    return "<link name='" + name +
           "'><inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' "
           "iyz='0'/></inertial><collision><origin xyz='" +
           origin + "'/><geometry>" + shape + "</geometry></collision></link>";
  };
  const auto joint = [](const std::string& name, const std::string& links,
                        const std::string& more) {
    return "<joint name='" + name + "' type='revolute'>" + links +
           "<axis xyz='0 1 0'/><limit lower='-3' upper='3' effort='1' velocity='1'/>" + more +
           "</joint>";
  };
  return "<robot name='arm'>" + link("base", "0 0 0", "<box size='.2 .2 .2'/>") +
         link("upper", "0 0 .3", "<cylinder radius='.05' length='.4'/>") +
         link("lower", "0 0 .1", "<mesh filename='" + mesh + "'/>") +
         joint("shoulder", "<parent link='base'/><child link='upper'/><origin xyz='0 0 .1'/>", "") +
         joint("elbow", "<parent link='upper'/><child link='lower'/><origin xyz='0 0 .5'/>",
               "<mimic joint='shoulder' multiplier='1.5' offset='.1'/>") +
         "</robot>";
}

TEST_F(CliTest, AUrdfOfARosPackageIsSolvedAndItsMimicJointIsHeld) {
  Write("ws/arm_description/urdf/arm.urdf", ArmUrdf("package://arm_description/meshes/link.obj"));
  Write("ws/arm_description/meshes/link.obj", kTetrahedron);
  const std::vector<nlohmann::json> rows =
      SolveJson({"ws/arm_description/urdf/arm.urdf", "--qpos", "1.8 2.9", "--qpos", "0 0"});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_LT(rows[0]["depth_in"], -1e-3);
  for (const nlohmann::json& row : rows) {
    EXPECT_EQ(row["status"], "solved");
    const double shoulder = row["qpos"][0], elbow = row["qpos"][1];
    EXPECT_NEAR(elbow, 1.5 * shoulder + 0.1, 1e-6);
  }
}

TEST_F(CliTest, APackageThatIsNotThereIsNamed) {
  Write("arm.urdf", ArmUrdf("package://arm_description/meshes/link.obj"));
  ExpectRefused({"check", "arm.urdf"}, "no such file in a folder 'arm_description'");
}

TEST_F(CliTest, AUrdfIsWrittenAsMjcfButNotMendedInPlace) {
  Write("arm.urdf", ArmUrdf("link.obj"));
  Write("link.obj", kTetrahedron);
  ExpectRefused({"audit", "arm.urdf", "--fix", "mended.urdf"}, "is a URDF");
  ASSERT_EQ(Run({"solve", "arm.urdf", "--out-mjcf", "arm.xml"}).exit_code, 0);
  EXPECT_EQ(Run({"check", "arm.xml", "--key", "qpos0_pdg"}).exit_code, 0);
}

TEST_F(CliTest, ACompiledModelOfAnotherMujocoIsRefusedWithWhatToDo) {
  const ModelPtr m = LoadModel(kBallAndWall);
  const std::string path = cwd() / "scene.mjb";
  mj_saveModel(m.get(), path.c_str(), nullptr, 0);
  EXPECT_EQ(Run({"check", "scene.mjb"}).exit_code, 3);  // "deep" overlaps
  std::string bytes = Read("scene.mjb");
  const int version = mj_version();
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&version), 4));
  ASSERT_LT(at, 64u) << "the version is no longer in the header";
  ++bytes[at];
  Write("other.mjb", bytes);
  ExpectRefused({"check", "other.mjb"}, "pass the XML");
  ExpectRefused({"solve", "scene.mjb", "--out-mjcf", "out.xml"}, "pass the XML");
}

TEST_F(CliTest, ASceneInAFolderIsMovedWithItsAssets) {
  Write("parts/one/part.obj", kTetrahedron);
  Write("parts/two/part.obj", kLargerTetrahedron);
  Write("robots/robot.xml", R"(<mujoco><compiler meshdir="../parts"/>
    <asset><mesh name="a" file="one/part.obj"/><mesh name="b" file="two/part.obj"/></asset>
    <worldbody><geom type="mesh" mesh="a"/><body><joint type="slide" axis="1 0 0"/>
    <geom type="mesh" mesh="b"/></body></worldbody></mujoco>)");
  ASSERT_EQ(Run({"solve", "robots/robot.xml", "--out-mjcf", "out/"}).exit_code, 0);
  EXPECT_EQ(Read("out/assets/part.obj"), kTetrahedron);
  EXPECT_EQ(Read("out/assets/part_2.obj"), kLargerTetrahedron);
  fs::create_directory(cwd() / "away");
  fs::rename(cwd() / "out", cwd() / "away/moved");
  fs::remove_all(cwd() / "parts");
  EXPECT_EQ(Run({"check", "away/moved/robot.xml", "--key", "qpos0_pdg"}).exit_code, 0);
  // Again from there, into its own folder and into another: copies of copies.
  ExpectRefused({"solve", "away/moved/robot.xml", "--out-mjcf", "away/moved/"}, "is an input file");
  ASSERT_EQ(Run({"solve", "away/moved/robot.xml", "--out-mjcf", "again/"}).exit_code, 0);
  EXPECT_EQ(Read("again/assets/part_2.obj"), kLargerTetrahedron);
  EXPECT_EQ(Run({"check", "again/robot.xml", "--key", "qpos0_pdg"}).exit_code, 0);
}

TEST_F(CliTest, AFolderThatCannotBeFilledIsNotLeftBehind) {
  ExpectRefused({"solve", "scene.xml", "--key", "none", "--out-mjcf", "out/"}, "no keyframe");
  ExpectRefused({"solve", "scene.xml", "--out-mjcf", "no/out/"}, "no such folder");
  ExpectRefused({"solve", "scene.xml", "--out-mjcf", "scene.xml/"}, "not a folder");
}

// A servo with a filter and one that integrates its control pull to their activations.
TEST_F(CliTest, ActivationsThatServosPullToMoveWithTheJoint) {
  Write("servo.xml", R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
    <body><joint name="z" type="slide"/><geom size=".1"/></body></worldbody>
    <actuator><position joint="z" kp="10" timeconst=".1"/><intvelocity joint="z" kp="10"
      actrange="-1 1"/><general joint="z" dyntype="filter"/></actuator>
    <keyframe><key name="sunk" qpos=".02" act=".3 .2 .7" ctrl=".4 .5 .6"/></keyframe></mujoco>)");
  ASSERT_EQ(Run({"solve", "servo.xml", "--out-mjcf", "out.xml"}).exit_code, 0);
  char error[500] = "";
  const ModelPtr m(mj_loadXML((cwd() / "out.xml").c_str(), nullptr, error, 500));
  ASSERT_NE(m, nullptr) << error;
  const int key = mj_name2id(m.get(), mjOBJ_KEY, "sunk_pdg");
  ASSERT_EQ(key, 1);
  const double lift = m->key_qpos[1] - 0.02;
  EXPECT_NEAR(lift, 0.08, 1e-5);
  const double *act = m->key_act + 3 * key, *ctrl = m->key_ctrl + 3 * key;
  EXPECT_NEAR(act[0], 0.3 + lift, 1e-12);
  EXPECT_NEAR(act[1], 0.2 + lift, 1e-12);
  EXPECT_EQ(act[2], 0.7);  // a force
  EXPECT_NEAR(ctrl[0], 0.4 + lift, 1e-12);
  EXPECT_EQ(ctrl[1], 0.5);  // a velocity
  EXPECT_EQ(ctrl[2], 0.6);
}

}  // namespace
}  // namespace mjcf_pdg::test
