// Which geoms are exact, what is built for them, and what the program says about it.
#include "model/exact_mesh.h"

#include "bound/lower_bound.h"
#include "mesh/triangle_bvh.h"
#include "mjcf_pdg/pdg.h"
#include "tests/support/cli_test.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {
namespace {

class ExactMeshTest : public test::MujocoTest {};
using ExactMeshCliTest = test::CliTest;

// A ring that may slide across a post it hangs on, two more geoms of the same mesh, a box, a ball.
std::string RingXml(const std::string& text = {}, bool open = false) {
  test::MeshShape ring = test::Torus(0.1, 0.02, 24, 12);
  if (open) ring.faces.pop_back();
  return "<mujoco>" + text + "<asset>" + test::MeshXml("ring", ring) +
         "</asset><worldbody><geom name='post' type='capsule' size='0.05 0.3'/>"
         "<geom name='ring3' type='mesh' mesh='ring' pos='5 0 0'/>"
         "<geom name='box' type='box' size='.1 .1 .1' pos='6 0 0'/>"
         "<body name='b'><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/>"
         "<geom name='ring1' type='mesh' mesh='ring'/>"
         "<geom name='ring2' type='mesh' mesh='ring' contype='0' conaffinity='0'/></body>"
         "</worldbody><keyframe><key name='deep' qpos='.035 0'/><key name='free' qpos='0 0'/>"
         "</keyframe></mujoco>";
}

using test::Exact;

int Geom(const Scene& scene, const char* name) {
  return mj_name2id(scene.model(), mjOBJ_GEOM, name);
}

TEST_F(ExactMeshTest, WithoutTheOptionMeshesAreHulls) {
  const Scene scene = Scene::FromString(RingXml());
  EXPECT_FALSE(scene.HasExactMeshes());
  for (const auto& bvh : scene.tables().bvhs) EXPECT_EQ(bvh, nullptr);
  EXPECT_FALSE(Verify(scene, {0.0, 0.0}).free);
}

TEST_F(ExactMeshTest, WithoutATextAllMeshesAreExactAndShareTheirTriangles) {
  const Scene scene = Scene::FromString(RingXml(), Exact());
  EXPECT_TRUE(scene.HasExactMeshes());
  const auto& bvhs = scene.tables().bvhs;
  ASSERT_NE(bvhs[Geom(scene, "ring1")], nullptr);
  EXPECT_EQ(bvhs[Geom(scene, "ring1")], bvhs[Geom(scene, "ring3")]);
  EXPECT_EQ(bvhs[Geom(scene, "ring1")]->num_triangles(), 2 * 24 * 12);
  EXPECT_EQ(bvhs[Geom(scene, "ring2")], nullptr) << "it collides with nothing";
  EXPECT_TRUE(bvhs[Geom(scene, "box")]->closed());
  EXPECT_EQ(bvhs[Geom(scene, "box")]->num_triangles(), 12);
  EXPECT_TRUE(scene.Warnings().empty());
  EXPECT_TRUE(Verify(scene, {0.0, 0.0}).free);
}

TEST_F(ExactMeshTest, ATextNamesThoseThatAreExactAndTheOthersKeepTheirHulls) {
  const std::string text = "<custom><text name='mjcf_pdg.exact_mesh' data='ring1'/></custom>";
  const Scene scene = Scene::FromString(RingXml(text), Exact());
  EXPECT_TRUE(scene.tables().exact[Geom(scene, "ring1")]);
  EXPECT_FALSE(scene.tables().exact[Geom(scene, "ring3")]);
  const TriangleBvh& hull = *scene.tables().bvhs[Geom(scene, "ring3")];
  EXPECT_TRUE(hull.closed());
  EXPECT_LT(hull.num_triangles(), 2 * 24 * 12);
  for (int t = 0; t < hull.num_triangles(); ++t) {
    EXPECT_GT(hull.Normal(t).dot(hull.Corner(t, 0) - hull.center()), 0.0);
  }
  EXPECT_TRUE(scene.Warnings().empty());
  const Scene hulls = Scene::FromString(RingXml(text));
  EXPECT_FALSE(hulls.HasExactMeshes()) << "the text alone";
  ASSERT_EQ(hulls.Warnings().size(), 1u);
  EXPECT_NE(hulls.Warnings()[0].find("--exact-mesh"), std::string::npos);
}

TEST_F(ExactMeshTest, ATextThatNamesSomethingElseIsRefused) {
  auto error = [](const std::string& names) {
    return test::ErrorOf([&] {
      Scene::FromString(
          RingXml("<custom><text name='mjcf_pdg.exact_mesh' data='" + names + "'/></custom>"),
          Exact());
    });
  };
  EXPECT_EQ(error("ring1 nobody"), "text 'mjcf_pdg.exact_mesh': no geom named 'nobody'");
  EXPECT_EQ(error("post"), "text 'mjcf_pdg.exact_mesh': geom 'post' is not a mesh");
}

TEST_F(ExactMeshTest, AMeshOnAHeightFieldStaysAHull) {
  const std::string xml =
      "<mujoco><asset><hfield name='h' nrow='2' ncol='2' size='1 1 .1 .1'/>" +
      test::MeshXml("ring", test::Torus(0.1, 0.02, 24, 12)) +
      "</asset><worldbody><geom type='hfield' hfield='h'/><body pos='0 0 1'><freejoint/>"
      "<geom type='mesh' mesh='ring'/></body></worldbody></mujoco>";
  const Scene scene = Scene::FromString(xml, Exact());
  ASSERT_EQ(scene.num_kept_pairs(), 1);
  EXPECT_EQ(scene.tables().pairs[0].kind, PairKind::kTerrain);
  EXPECT_FALSE(scene.HasExactMeshes());
  EXPECT_TRUE(Verify(scene, scene.DefaultQpos()).certified);
}

// The bound's argument is about convex geoms; a ring around a post moves less than its hull.
TEST_F(ExactMeshTest, ExactPairsAddNothingToTheLowerBound) {
  const Scene scene = Scene::FromString(RingXml(), Exact());
  const Result result = Solver(scene).Solve({0.035, 0.0});
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_EQ(result.sigma_lower_bound, 0.0);
  const Result hull = Solver(Scene::FromString(RingXml())).Solve({0.035, 0.0});
  EXPECT_GT(hull.sigma_lower_bound, result.sigma);
}

TEST_F(ExactMeshCliTest, TheFlagChangesWhatIsFreeAndTheOutputSaysSo) {
  const std::string model = "ring.xml";
  Write(model, RingXml());
  const test::Outcome hull = Run({"check", model, "--json", "-"});
  EXPECT_EQ(hull.exit_code, 3);
  for (const auto& line : test::ParseLines(hull.out)) {
    EXPECT_EQ(line["geometry"], "hull");
    EXPECT_FALSE(line["free"]);
  }
  const auto checked = test::ParseLines(Run({"check", model, "--exact-mesh", "--json", "-"}).out);
  ASSERT_EQ(checked.size(), 2u);
  EXPECT_EQ(checked[1]["geometry"], "exact");
  EXPECT_FALSE(checked[0]["free"]);
  EXPECT_TRUE(checked[1]["free"]);
  const test::Outcome solved = Run({"solve", model, "--exact-mesh", "--json", "-"});
  EXPECT_EQ(solved.exit_code, 0) << solved.err;
  EXPECT_EQ(solved.err, "");
  const auto rows = test::ParseLines(solved.out);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["geometry"], "exact");
  EXPECT_EQ(rows[0]["status"], "solved");
  EXPECT_NEAR(rows[0]["rms"].get<double>(), 0.005, 5e-4);
  EXPECT_EQ(rows[1]["status"], "already_free");
  EXPECT_NE(Run({"solve", model, "--exact-mesh"}).out.find("(exact meshes)"), std::string::npos);
  EXPECT_EQ(Run({"solve", model}).out.find("(exact meshes)"), std::string::npos);
}

TEST_F(ExactMeshCliTest, AnOpenMeshIsAWarningAndAWrongTextAnError) {
  const std::string open = "open.xml";
  Write(open, RingXml({}, true));
  const test::Outcome warned = Run({"check", open, "--exact-mesh"});
  EXPECT_NE(warned.err.find("mjcf-pdg: warning: mesh geom 'ring1' is not closed (3 open edges)"),
            std::string::npos)
      << warned.err;
  EXPECT_EQ(Run({"check", open}).err, "");
  Write("wrong.xml", RingXml("<custom><text name='mjcf_pdg.exact_mesh' data='x'/></custom>"));
  ExpectRefused({"solve", "wrong.xml", "--exact-mesh"}, "no geom named 'x'");
}

}  // namespace
}  // namespace mjcf_pdg
