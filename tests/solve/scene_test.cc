#include "mjcf_pdg/scene.h"

#include <gmock/gmock.h>

#include <fstream>
#include <limits>
#include <utility>

#include "collide/contacts.h"
#include "mjcf_pdg/object_norm.h"
#include "mjcf_pdg/pdg.h"
#include "model/scene_tables.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class SceneTest : public MujocoTest {
 protected:
  std::string WriteFile(const std::string& name, const std::string& text) const {
    const std::string path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  const TemporaryFolder folder_;
};

std::vector<std::string> JointNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const JointEntry& joint : scene.tables().joints) names.push_back(scene.JointName(joint.id));
  return names;
}

TEST_F(SceneTest, FileStringBinaryAndModelGiveTheSameTables) {
  const std::string xml = ArmXml();
  const Scene text = Scene::FromString(xml);
  const Scene file = Scene::FromFile(WriteFile("scene.xml", xml));
  const std::string mjb = folder_ / "scene.mjb";
  mj_saveModel(text.model(), mjb.c_str(), nullptr, 0);
  const Scene binary = Scene::FromFile(mjb);
  const ModelPtr model = LoadModel(xml);
  const Scene host = Scene::FromModel(model.get());
  EXPECT_EQ(host.model(), model.get());
  for (const Scene* other : {&file, &binary, &host}) {
    EXPECT_EQ(other->dof(), text.dof());
    EXPECT_EQ(JointNames(*other), JointNames(text));
    ASSERT_EQ(other->num_kept_pairs(), text.num_kept_pairs());
    for (int k = 0; k < text.num_kept_pairs(); ++k) {
      EXPECT_EQ(other->tables().pairs[k].geom1, text.tables().pairs[k].geom1);
      EXPECT_EQ(other->tables().pairs[k].geom2, text.tables().pairs[k].geom2);
    }
    EXPECT_EQ(other->DefaultQpos(), text.DefaultQpos());
  }
}

TEST_F(SceneTest, AFileMayReferToMeshesBesideIt) {
  WriteFile("tetra.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string path = WriteFile(
      "mesh.xml",
      "<mujoco><asset><mesh name='t' file='tetra.obj'/></asset><worldbody><body><freejoint/>"
      "<geom type='mesh' mesh='t'/></body></worldbody></mujoco>");
  EXPECT_EQ(Scene::FromFile(path).dof(), 6);
}

TEST_F(SceneTest, TheUsersModelIsNeverWrittenTo) {
  Random rng(13);
  for (int trial = 0; trial < 5; ++trial) {
    const ModelPtr model = LoadModel(RandomRobotXml(rng));
    model->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_NATIVECCD;
    model->opt.enableflags |= mjENBL_SLEEP;
    const std::vector<char> before = ModelBytes(model.get());
    {
      const Scene scene = Scene::FromModel(model.get(), {.movable = {}, .root = "b2"});
      ContactFinder finder(scene.tables());
      const Eigen::VectorXd q = RandomConfiguration(scene, rng);
      finder.Pose(q);
      finder.Find(0.1);
      ObjectNorm norm(scene, Metric::kDisplacement, ToVector(q));
      norm.Sigma(scene.DefaultQpos());
    }
    EXPECT_EQ(ModelBytes(model.get()), before);
  }
}

TEST_F(SceneTest, MovableBodiesKeepTheirOwnJointsAndSubtrees) {
  const std::string xml = TwoTreesXml();
  EXPECT_THAT(JointNames(Scene::FromString(xml)), ElementsAre("fa", "ha", "fb", "bb"));
  const Scene below = Scene::FromString(xml, {.movable = {"a2", "b"}, .root = {}});
  EXPECT_THAT(JointNames(below), ElementsAre("ha", "fb", "bb"));
  EXPECT_EQ(below.dof(), 1 + 6 + 3);
  EXPECT_EQ(below.nq(), 7 + 1 + 7 + 4);
  const SceneTables& tables = below.tables();
  EXPECT_THAT(std::vector<int>(tables.column_of_dof.begin(), tables.column_of_dof.begin() + 8),
              ElementsAre(-1, -1, -1, -1, -1, -1, 0, 1));
  const int a = mj_name2id(below.model(), mjOBJ_BODY, "a");
  EXPECT_FALSE(tables.body_moves[a]);
  EXPECT_TRUE(tables.body_moves[mj_name2id(below.model(), mjOBJ_BODY, "a2")]);
  EXPECT_TRUE(tables.body_moves[mj_name2id(below.model(), mjOBJ_BODY, "b2")]);
}

TEST_F(SceneTest, ABodyBelowAMovableBodyIsMovableToo) {
  const Scene scene = Scene::FromString(ArmXml(), {.movable = {"upper"}, .root = {}});
  EXPECT_THAT(JointNames(scene), ElementsAre("shoulder", "reach", "wrist"));
}

TEST_F(SceneTest, BadNamesAreAnsweredWithKnownOnes) {
  const std::string arm = ArmXml();
  EXPECT_THAT(ErrorOf([&] { Scene::FromString(arm, {.movable = {"uper"}, .root = {}}); }),
              AllOf(HasSubstr("'uper'"), HasSubstr("turret, upper")));
  EXPECT_THAT(ErrorOf([&] { Scene::FromString(arm, {.movable = {}, .root = "palm"}); }),
              HasSubstr("'palm'"));
  EXPECT_THAT(ErrorOf([&] { Scene::FromString(arm, {.movable = {}, .root = "stand"}); }),
              HasSubstr("'stand'"));
  EXPECT_THAT(ErrorOf([&] { Scene::FromString(arm, {.movable = {"crate"}, .root = {}}); }),
              HasSubstr("no joint"));
}

TEST_F(SceneTest, UnusableModelsAreRefusedByName) {
  EXPECT_THAT(ErrorOf([] {
                Scene::FromString("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>");
              }),
              HasSubstr("no joints"));
  EXPECT_THAT(ErrorOf([] {
                Scene::FromString(
                    "<mujoco><worldbody><flexcomp name='cloth' type='grid' "
                    "count='3 3 1' spacing='.1 .1 .1' radius='.01' mass='1' "
                    "dim='2'/></worldbody></mujoco>");
              }),
              AllOf(HasSubstr("flex"), HasSubstr("'cloth'")));
  TakeMessages();  // MuJoCo warns about the cloth
  EXPECT_THAT(ErrorOf([] { Scene::FromModel(nullptr); }), HasSubstr("null"));
}

TEST_F(SceneTest, HeightFieldAgainstDistanceFieldIsRefusedSinceMujocoNeverSeesIt) {
  const std::string xml = R"(<mujoco><asset>
      <hfield name="h" nrow="2" ncol="2" size="1 1 .1 .1" elevation="0 1 1 0"/>
      <mesh name="t" vertex="-.5 -.5 -.1 .5 -.5 -.1 -.5 .5 -.1 .5 .5 -.1 -.5 -.5 .1 .5 -.5 .1
          -.5 .5 .1 .5 .5 .1"/></asset><worldbody>
      <geom name="hills" type="hfield" hfield="h" CONTACT/>
      <body><freejoint/><geom name="stone" type="sdf" mesh="t" density="1000"/></body>
      </worldbody></mujoco>)";
  auto with = [&xml](const std::string& contact) {
    std::string out = xml;
    return out.replace(out.find("CONTACT"), 7, contact);
  };
  EXPECT_THAT(ErrorOf([&] { Scene::FromString(with("")); }),
              AllOf(HasSubstr("'hills'"), HasSubstr("'stone'")));
  EXPECT_EQ(Scene::FromString(with("contype='0' conaffinity='0'")).num_kept_pairs(), 0);
}

// Taken for a known type, a geom of another would be called free where it overlaps.
TEST_F(SceneTest, GeomsOfATypeThatNobodyKnowsAreRefusedByNameWhereTheyCollide) {
  const ModelPtr model = LoadModel(R"(<mujoco><worldbody>
      <geom name="ground" type="plane" size="1 1 1"/>
      <body><freejoint/><geom name="crystal" size=".1"/><geom name="ball" size=".1"/></body>
      </worldbody></mujoco>)");
  const int crystal = mj_name2id(model.get(), mjOBJ_GEOM, "crystal");
  for (const int type : {static_cast<int>(mjNGEOMTYPES), static_cast<int>(mjGEOM_ARROW)}) {
    model->geom_type[crystal] = type;
    EXPECT_THAT(ErrorOf([&] { Scene::FromModel(model.get()); }),
                AllOf(HasSubstr("'crystal'"), HasSubstr("type " + std::to_string(type))));
  }
  // A geom that is only drawn may be of any type.
  model->geom_contype[crystal] = model->geom_conaffinity[crystal] = 0;
  EXPECT_EQ(Scene::FromModel(model.get()).num_kept_pairs(), 1);
}

TEST_F(SceneTest, BrokenXmlIsReportedOnOneLineWithItsPlace) {
  const std::string unknown =
      ErrorOf([] { Scene::FromString("<mujoco>\n<worldbody>\n<geomm/>\n</worldbody></mujoco>"); });
  EXPECT_THAT(unknown, AllOf(HasSubstr("geomm"), HasSubstr("line 3"), Not(HasSubstr("\n"))));
  const std::string syntax = ErrorOf([] { Scene::FromString("<mujoco><worldbody>"); });
  EXPECT_THAT(syntax, AllOf(Not(HasSubstr("no Error")), Not(HasSubstr("\n"))));
  const std::string path = WriteFile("bad.xml",
                                     "<mujoco><worldbody><body><joint/></body>"
                                     "</worldbody></mujoco>");  // no mass
  EXPECT_THAT(ErrorOf([&] { Scene::FromFile(path); }),
              AllOf(HasSubstr(path), HasSubstr("mass"), Not(HasSubstr("\n"))));
}

TEST_F(SceneTest, MissingFilesAndFoldersAreReportedWithTheirPath) {
  EXPECT_THAT(ErrorOf([] { Scene::FromFile("/nowhere/robot.xml"); }),
              AllOf(HasSubstr("/nowhere/robot.xml"), HasSubstr("no such file")));
  EXPECT_THAT(ErrorOf([] { Scene::FromFile(::testing::TempDir()); }), HasSubstr("directory"));
  const std::string path = WriteFile("nomesh.xml", R"(<mujoco><asset><mesh name="t"
      file="pdg_not_there.obj"/></asset><worldbody><body><freejoint/><geom type="mesh" mesh="t"/>
      </body></worldbody></mujoco>)");
  EXPECT_THAT(ErrorOf([&] { Scene::FromFile(path); }), HasSubstr("pdg_not_there.obj"));
}

TEST_F(SceneTest, MocapBodiesAreObstaclesThatCanBePlaced) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <body name="m" mocap="true" pos="1 0 0"><geom size=".1"/></body>
      <body name="a"><freejoint/><geom size=".1"/></body></worldbody></mujoco>)");
  ASSERT_EQ(scene.num_kept_pairs(), 1);
  EXPECT_EQ(scene.dof(), 6);
  ContactFinder finder(scene.tables());
  finder.Pose(ToEigen(scene.DefaultQpos()));
  ASSERT_EQ(finder.Find(2).size(), 1u);
  EXPECT_NEAR(finder.Find(2)[0].distance, 0.8, 1e-12);
  finder.SetMocap({.pos = {0, 0.15, 0}, .quat = {1, 0, 0, 0}});
  finder.Pose(ToEigen(scene.DefaultQpos()));
  ASSERT_EQ(finder.Find(2).size(), 1u);
  EXPECT_NEAR(finder.Find(2)[0].distance, -0.05, 1e-12);
}

TEST_F(SceneTest, HeldEqualitiesAreListedByKindAndName) {
  const std::string xml = R"(<mujoco><worldbody>
      <body name="a"><joint name="x"/><geom size=".1"/></body>
      <body name="b"><joint name="y"/><geom size=".1"/></body></worldbody><equality>
      <connect name="loop" body1="a" body2="b" anchor="0 0 0"/><weld body1="a" body2="b"/>
      <joint name="off" joint1="x" joint2="y" active="false"/>
      <joint name="gear" joint1="x" joint2="y"/></equality></mujoco>)";
  EXPECT_THAT(Scene::FromString(xml).HeldEqualities(),
              ElementsAre("connect 'loop'", "weld #1", "joint 'gear'"));
  const ModelPtr model = LoadModel(xml);
  model->opt.disableflags |= mjDSBL_EQUALITY;
  EXPECT_TRUE(Scene::FromModel(model.get()).HeldEqualities().empty());
}

TEST_F(SceneTest, ConfigurationsAreCheckedForSizeNumbersAndQuaternions) {
  const Scene scene = Scene::FromString(TwoTreesXml());
  const std::vector<double> good = scene.DefaultQpos();
  scene.CheckConfiguration(good);
  std::vector<double> bad = good;
  bad.pop_back();
  EXPECT_THAT(ErrorOf([&] { scene.CheckConfiguration(bad); }),
              AllOf(HasSubstr("18"), HasSubstr("19")));
  for (const double value : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), -1e200}) {
    bad = good;
    bad[7] = value;
    EXPECT_THAT(ErrorOf([&] { scene.CheckConfiguration(bad); }), HasSubstr("qpos[7]"));
  }
  for (const auto& [name, address] : {std::pair("fa", 3), std::pair("bb", 15)}) {
    bad = good;
    std::fill(bad.begin() + address, bad.begin() + address + 4, 0.0);
    EXPECT_THAT(ErrorOf([&] { scene.CheckConfiguration(bad); }),
                HasSubstr("'" + std::string(name) + "'"));
  }
}

TEST_F(SceneTest, AModelThatHoldsNoNumberIsRefusedByFieldAndElement) {
  const ModelPtr model = LoadModel(R"(<mujoco><worldbody><body><joint name="turn"/>
      <geom name="a" size=".1"/><geom name="b" size=".1"/></body></worldbody></mujoco>)");
  const auto message = [&] { return ErrorOf([&] { Scene::FromModel(model.get()); }); };
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    for (const auto& [value, words] :
         {std::pair(model->body_mass + 1, "the mass of body #1 is not usable"),
          std::pair(model->jnt_axis + 2, "the axis of joint 'turn' is not usable"),
          std::pair(model->geom_size + 5, "the size of geom 'b' is not usable")}) {
      const mjtNum good = std::exchange(*value, bad);
      EXPECT_EQ(message(), words);
      *value = good;
    }
  }
  Scene::FromModel(model.get());  // the model is as it was: no Error
}

TEST_F(SceneTest, KeyframesAndNamesComeFromTheModel) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><body><joint type="slide"/>
      <joint name="t"/><geom size=".1"/><geom name="g" size=".1"/></body></worldbody><keyframe>
      <key name="home" qpos="1 2"/><key qpos="3 4"/></keyframe></mujoco>)");
  EXPECT_THAT(scene.KeyNames(), ElementsAre("home", ""));
  EXPECT_THAT(scene.KeyQpos(1), ElementsAre(3, 4));
  EXPECT_THAT(ErrorOf([&] { scene.KeyQpos(2); }), HasSubstr("2"));
  EXPECT_EQ(scene.JointName(0) + scene.JointName(1) + scene.GeomName(0) + scene.GeomName(1),
            "#0tworld/body0/geom0g");
}

TEST_F(SceneTest, GeomsWithoutNameAreToldByTheirPlaceInTheXml) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <geom type="plane" size="1 1 1"/><geom name="named" size=".1"/>
      <body name="torso"><freejoint/><geom name="chest" size=".1"/><geom size=".1"/>
        <body><geom size=".1"/>
          <body><geom name="hand" size=".1"/><geom size=".1"/></body></body>
        <body name="leg"><geom size=".1"/></body>
        <body><geom size=".1"/></body></body>
      <body><geom size=".1"/></body></worldbody></mujoco>)");
  std::vector<std::string> names;
  for (int g = 0; g < scene.model()->ngeom; ++g) names.push_back(scene.GeomName(g));
  EXPECT_THAT(names, ElementsAre("world/geom0", "named", "chest", "torso/geom1",
                                 "torso/body0/geom0", "hand", "torso/body0/body0/geom1",
                                 "leg/geom0", "torso/body2/geom0", "world/body1/geom0"));
  const Scene sunk = Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
      <body name="ball" pos="0 0 .05"><freejoint/><geom size=".1"/></body></worldbody></mujoco>)");
  EXPECT_THAT(Verify(sunk, sunk.DefaultQpos()).reason,
              HasSubstr("geom world/geom0 and geom ball/geom0 overlap"));
}

TEST_F(SceneTest, AModelThatIsBuiltByCodeIsAModel) {
  const std::unique_ptr<mjSpec, void (*)(mjSpec*)> spec(mj_makeSpec(), mj_deleteSpec);
  mjsBody* world = mjs_findBody(spec.get(), "world");
  mjsGeom* floor = mjs_addGeom(world, nullptr);
  floor->type = mjGEOM_PLANE;
  std::fill(floor->size, floor->size + 3, 1.0);
  mjsBody* ball = mjs_addBody(world, nullptr);
  ball->pos[2] = 0.06;
  mjs_addFreeJoint(ball);
  mjs_addGeom(ball, nullptr)->size[0] = 0.1;
  const ModelPtr m(mj_compile(spec.get(), nullptr));
  ASSERT_NE(m, nullptr);
  const Scene scene = Scene::FromModel(m.get());
  const Result result = Solver(scene).Solve(scene.DefaultQpos());
  EXPECT_EQ(result.status, Status::kSolved);
  EXPECT_NEAR(result.sigma, 0.04 * 0.04, 1e-6);
}

// MuJoCo compiles all of them.
TEST_F(SceneTest, InfiniteSizesAreRefusedByNameAndInfiniteRangesAreNoLimits) {
  const auto scene = [](const std::string& size, const std::string& range) {
    return Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
        <body name="ball" pos="0 0 .06"><joint type="slide" range=")" +
                             range + R"("/><geom size=')" + size +
                             R"('/></body></worldbody></mujoco>)");
  };
  EXPECT_EQ(ErrorOf([&] { scene("inf", "-1 1"); }), "the size of geom ball/geom0 is not usable");
  EXPECT_EQ(ErrorOf([&] { scene(".1' quat='1e308 0 0 1", "-1 1"); }),
            "the orientation of geom ball/geom0 is not usable");
  for (const Method method : {Method::kAuto, Method::kPaper}) {
    for (const char* range : {"-inf inf", "-.1 inf"}) {
      const Scene half_open = scene(".1", range);
      Options options;
      options.method = method;
      const Result result = Solver(half_open, options).Solve(half_open.DefaultQpos());
      EXPECT_EQ(result.status, Status::kSolved) << range;
      EXPECT_NEAR(result.sigma, 0.04 * 0.04, 1e-6) << range;
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
