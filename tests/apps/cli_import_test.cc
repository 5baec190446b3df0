// What `import` writes, says and refuses.
#include <mujoco/mujoco.h>

#include "tests/support/cli_test.h"
#include "tests/support/hand_made_meshes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;

class CliImportTest : public CliTest {
 protected:
  ModelPtr Load(const std::string& scene) const {
    char error[500] = "";
    ModelPtr model(mj_loadXML((cwd() / scene).c_str(), nullptr, error, sizeof error));
    EXPECT_NE(model, nullptr) << error;
    return model;
  }

  // Every scene under a name of its own: MuJoCo caches the meshes that it has loaded by theirs.
  nlohmann::json ImportJson(const TriangleMesh& mesh, const std::string& scene,
                            const std::string& density = "1000") const {
    Write("mesh.obj", ObjText(mesh));
    const Outcome outcome =
        Run({"import", "mesh.obj", "-o", scene, "--density", density, "--json", "-"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return ParseLines(outcome.out).at(0);
  }
};

// Far lighter than its hull.
TriangleMesh Ring() { return TorusMesh(0.5, 0.05, 24); }

TEST_F(CliImportTest, TwoMeshesBecomeAFreeAndAStaticBodyWhereTheirCoordinatesSay) {
  Write("a.obj", ObjText(Ring()));
  Write("b.obj", ObjText(CuboidMesh({0.1, 0.2, 0.3}, {1, 2, 3})));
  const Outcome outcome = Run({"import", "a.obj", "b.obj", "-o", "out.xml"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_NE(outcome.out.find("static"), std::string::npos) << outcome.out;
  const ModelPtr m = Load("out.xml");
  ASSERT_NE(m, nullptr);
  EXPECT_EQ(m->nbody, 3);
  EXPECT_EQ(m->nq, 7);
  EXPECT_EQ(m->nkey, 1);
  EXPECT_EQ(m->body_dofnum[mj_name2id(m.get(), mjOBJ_BODY, "a")], 6);
  const DataPtr d(mj_makeData(m.get()));
  mj_resetDataKeyframe(m.get(), d.get(), 0);
  mj_kinematics(m.get(), d.get());
  mj_comPos(m.get(), d.get());
  const int b = mj_name2id(m.get(), mjOBJ_BODY, "b");
  EXPECT_TRUE(Vector3d(d->xipos + 3 * b).isApprox(Vector3d(1.05, 2.1, 3.15), 1e-6));
  EXPECT_TRUE(Vector3d(d->xipos + 3).isZero(1e-6));
  ASSERT_EQ(m->ntext, 1);
  EXPECT_STREQ(mj_id2name(m.get(), mjOBJ_TEXT, 0), "mjcf_pdg.exact_mesh");
  EXPECT_STREQ(m->text_data, "a b");
}

TEST_F(CliImportTest, MassAndInertiaAreExactInMujocoAndInTheReport) {
  Random random(5);
  for (int i = 0; i < 5; ++i) {
    TriangleMesh mesh = Together(Ring(), CuboidMesh({0.3, 0.2, 0.1}, random.InBox(2.0)));
    mesh.vertices = (random.UnitQuat().toRotationMatrix() * mesh.vertices).eval();
    const std::string scene = "out" + std::to_string(i) + ".xml";
    const nlohmann::json json = ImportJson(mesh, scene, "700");
    const SolidProperties solid = FindSolidProperties(mesh);
    const ModelPtr m = Load(scene);
    ASSERT_NE(m, nullptr);
    EXPECT_NEAR(m->body_mass[1], 700 * solid.volume, 1e-5 * m->body_mass[1]);
    EXPECT_NEAR(json["mass"], 700 * solid.volume, 1e-5 * m->body_mass[1]);
    EXPECT_TRUE(Vector3d(m->body_ipos + 3).isApprox(solid.center, 1e-5));
    const Eigen::Quaterniond axes(m->body_iquat[4], m->body_iquat[5], m->body_iquat[6],
                                  m->body_iquat[7]);
    const Eigen::Matrix3d inertia = axes.toRotationMatrix() *
                                    Vector3d(m->body_inertia + 3).asDiagonal() *
                                    axes.toRotationMatrix().transpose();
    EXPECT_TRUE(inertia.isApprox(700 * solid.inertia, 1e-5)) << inertia;
    const std::vector<double> reported = json["inertia"];
    EXPECT_TRUE(Eigen::Map<const Eigen::Matrix3d>(reported.data()).isApprox(inertia, 1e-5));
  }
}

TEST_F(CliImportTest, EveryFlawIsSaidAndRepairedWhereThatIsUnambiguous) {
  const TriangleMesh cube = CubeMesh();
  TriangleMesh mixed = cube, repeated = cube, duplicate = cube;
  mixed.triangles.col(3) = mixed.triangles.col(3).reverse().eval();
  repeated.triangles.conservativeResize(3, 13);
  repeated.triangles.col(12) << 1, 1, 2;
  duplicate.triangles.conservativeResize(3, 13);
  duplicate.triangles.col(12) = cube.triangles.col(0);
  const struct {
    TriangleMesh mesh;
    double volume;
    const char* words;
  } cases[] = {
      {InsideOut(cube), 1.0, "inside out: turned over"},
      {mixed, 1.0, "1 triangle oriented against the neighbours: turned over"},
      {repeated, 1.0, "1 triangle with a corner twice: removed"},
      {duplicate, 1.0, "1 triangle there before: removed"},
      {Together(cube, CubeMesh({1, 1, 0})), 2.0, "1 edge of more than two triangles"},
      {Together(CuboidMesh({3, 3, 3}), CubeMesh({1, 1, 1})), 28.0, "1 closed part inside another"},
      {CuboidMesh({500, 500, 500}), 1.25e8, "500 m large: MuJoCo's unit is the metre"},
      {CubeMesh({5000, 0, 0}), 1.0, "5001 m from the origin"},
  };
  int i = 0;
  for (const auto& [mesh, volume, words] : cases) {
    SCOPED_TRACE(words);
    const std::string scene = "out" + std::to_string(++i) + ".xml";
    const nlohmann::json json = ImportJson(mesh, scene);
    ASSERT_EQ(json["warnings"].size(), 1u) << json;
    EXPECT_NE(json["warnings"][0].get<std::string>().find(words), std::string::npos) << json;
    EXPECT_EQ(json["inertia_from"], "exact");
    EXPECT_NEAR(json["volume"], volume, 1e-6 * volume);
    const ModelPtr m = Load(scene);
    ASSERT_NE(m, nullptr);
    EXPECT_NEAR(m->body_mass[1], 1000.0 * volume, 1e-5 * m->body_mass[1]);
  }
}

TEST_F(CliImportTest, AnOpenMeshFallsBackToItsHullWithAWarningAndIsNotMarkedExact) {
  Write("open.obj", ObjText(Without(CubeMesh(), 0)));
  const Outcome outcome = Run({"import", "open.obj", "-o", "out.xml"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err.rfind("mjcf-pdg: warning: open.obj: not closed (3 edges)", 0), 0u)
      << outcome.err;
  const ModelPtr m = Load("out.xml");
  ASSERT_NE(m, nullptr);
  EXPECT_NEAR(m->body_mass[1], 1000.0, 1e-3);
  EXPECT_EQ(m->ntext, 0);
}

TEST_F(CliImportTest, ATriangleWithoutAreaDoesNotHinderMujoco) {
  TriangleMesh mesh = CubeMesh();
  mesh.vertices.conservativeResize(3, 9);
  mesh.vertices.col(8) << 0.5, 0.0, 0.0;
  mesh.triangles.conservativeResize(3, 14);
  mesh.triangles.col(4) << 0, 8, 5;
  mesh.triangles.rightCols(2) << 8, 0, 1, 1, 5, 8;
  const nlohmann::json json = ImportJson(mesh, "out.xml");
  EXPECT_EQ(json["warnings"][0], "1 triangle without area: kept");
  EXPECT_NEAR(Load("out.xml")->body_mass[1], 1000.0, 1e-3);
}

TEST_F(CliImportTest, NamesAreMadeFitForMjcfAndUnique) {
  Write("x/my mesh&\".obj", ObjText(CubeMesh()));
  Write("y/my mesh&\".obj", ObjText(CubeMesh()));
  const Outcome outcome = Run({"import", "x/my mesh&\".obj", "y/my mesh&\".obj", "-o", "a<&b.xml"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const ModelPtr m = Load("a<&b.xml");
  ASSERT_NE(m, nullptr);
  EXPECT_GE(mj_name2id(m.get(), mjOBJ_GEOM, "my_mesh__"), 0);
  EXPECT_GE(mj_name2id(m.get(), mjOBJ_GEOM, "my_mesh___2"), 0);
  EXPECT_STREQ(m->text_data, "my_mesh__ my_mesh___2");
}

TEST_F(CliImportTest, AFileNamedAsMujocosOwnBodyIsRenamed) {
  Write("world.obj", ObjText(CubeMesh()));
  Write("x/world.obj", ObjText(CubeMesh()));
  const Outcome outcome = Run({"import", "world.obj", "x/world.obj", "-o", "out.xml"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const ModelPtr m = Load("out.xml");
  ASSERT_NE(m, nullptr);
  EXPECT_EQ(mj_name2id(m.get(), mjOBJ_BODY, "world_2"), 1);
  EXPECT_EQ(mj_name2id(m.get(), mjOBJ_BODY, "world_3"), 2);
}

TEST_F(CliImportTest, SolidsThatTouchHaveTheirExactMassAndAreReadAgainWithoutLoss) {
  const TriangleMesh cubes = Together(CubeMesh(), CubeMesh({1, 0, 0}));
  const nlohmann::json json = ImportJson(cubes, "out.xml");
  EXPECT_EQ(json["parts"], 2);
  EXPECT_NEAR(json["volume"], 2.0, 1e-9);
  EXPECT_NEAR(Load("out.xml")->body_mass[1], 2000.0, 1e-2);
  EXPECT_EQ(Run({"import", "out_meshes/mesh.obj", "-o", "again.xml"}).exit_code, 0);
  EXPECT_TRUE(Read("again_meshes/mesh.obj") == Read("out_meshes/mesh.obj"));
}

TEST_F(CliImportTest, TheSceneIsReadyForTheOtherVerbs) {
  Write("a.obj", ObjText(CubeMesh()));
  Write("b.obj", ObjText(CubeMesh({0.9, 0.1, 0.2})));
  std::filesystem::create_directory(cwd() / "sub");
  EXPECT_EQ(Run({"import", "a.obj", "b.obj", "-o", "sub/out.xml"}).exit_code, 0);
  EXPECT_EQ(Run({"check", "sub/out.xml"}).exit_code, 3);
  const std::vector<nlohmann::json> lines = SolveJson({"sub/out.xml", "--exact-mesh"});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(lines[0]["sigma"], 0.01, 1e-4);  // back by a tenth of its side
}

TEST_F(CliImportTest, TheSameInputGivesTheSameBytesAndMayBeWrittenOver) {
  Write("a.obj", ObjText(CuboidMesh({0.1, 0.7, 0.3}, {0.3, 0.6, 12.9})));
  EXPECT_EQ(Run({"import", "a.obj", "-o", "out.xml"}).exit_code, 0);
  const std::string scene = Read("out.xml"), mesh = Read("out_meshes/a.obj");
  EXPECT_EQ(Run({"import", "a.obj", "-o", "out.xml"}).exit_code, 0);
  EXPECT_EQ(Read("out.xml"), scene);
  EXPECT_TRUE(Read("out_meshes/a.obj") == mesh);
  // What was imported once is imported again without loss.
  EXPECT_EQ(Run({"import", "out_meshes/a.obj", "-o", "again.xml"}).exit_code, 0);
  EXPECT_TRUE(Read("again_meshes/a.obj") == mesh);
}

TEST_F(CliImportTest, BadInputIsRefusedAndNothingWritten) {
  Write("a.obj", ObjText(CubeMesh()));
  Write("flat.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  Write("line.obj", "v 0 0 0\nv 1 0 0\nf 1 2 1\n");
  Write("empty.obj", "");
  Write("out_meshes", "a file where the folder would be");
  Write("in_meshes/a.obj", ObjText(CubeMesh()));
  ExpectRefused({"import", "-o", "new.xml"}, "MESH");
  ExpectRefused({"import", "a.obj"}, "-o");
  ExpectRefused({"import", "nowhere.obj", "-o", "new.xml"}, "nowhere.obj: no such file");
  ExpectRefused({"import", "a.obj", "empty.obj", "-o", "new.xml"}, "empty.obj: the file is empty");
  ExpectRefused({"import", "a.obj", "flat.obj", "-o", "new.xml"},
                "error: flat.obj: MuJoCo refuses it: mesh 'flat' has coplanar vertices");
  ExpectRefused({"import", "line.obj", "-o", "new.xml"}, "line.obj");
  ExpectRefused({"import", "a.obj", "-o", "new.obj"}, "does not end in .xml");
  ExpectRefused({"import", "a.obj", "-o", "-"}, "does not end in .xml");
  ExpectRefused({"import", "a.obj", "-o", "nowhere/new.xml"}, "no such folder");
  ExpectRefused({"import", "a.obj", "-o", "out.xml"}, "out_meshes: is not a folder");
  ExpectRefused({"import", "in_meshes/a.obj", "-o", "in.xml"}, "is an input file");
  ExpectRefused({"import", "a.obj", "-o", "new.xml", "--json", "new.xml"}, "already writes there");
  ExpectRefused({"import", "a.obj", "-o", "new.xml", "--scale", "0"}, "--scale");
  ExpectRefused({"import", "a.obj", "-o", "new.xml", "--scale", "1e11"}, "beyond 1e10");
  ExpectRefused({"import", "a.obj", "-o", "new.xml", "--density", "nan"}, "--density");
}

}  // namespace
}  // namespace mjcf_pdg::test
