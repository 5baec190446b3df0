// A hand of triangle meshes and a thin-walled cup: fingers that reach through the wall go back to
// their own side of it.
#include <cmath>

#include "mjcf_pdg/pdg.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/oracle_check.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;

constexpr double kCupRadius = 0.035, kCupHeight = 0.09, kWall = 0.002;

// A finger hangs from the palm at this place; it closes towards the axis.
struct Finger {
  double radius, azimuth;
  int side;                 // of the wall where its tip belongs: 1 outside, -1 inside
  double proximal, distal;  // angles that reach through the wall [rad]
};

// A bumpy link that hangs 50 mm down from its joint.
MeshShape Link() {
  MeshShape link = Globe(10, 10, [](const Vector3d& d) {
    return 1.0 + 0.1 * std::sin(9.0 * d.z()) * (1.0 - d.z() * d.z());
  });
  for (Vector3d& p : link.vertices) {
    p = Vector3d(0.007, 0.007, 0.026).cwiseProduct(p) - Vector3d(0.0, 0.0, 0.025);
  }
  return link;
}

std::string FingerXml(const Finger& finger, const std::string& name) {
  char place[200];
  std::snprintf(place, sizeof place, "pos='%.6f %.6f -.015' euler='0 0 %.6f'",
                finger.radius * std::cos(finger.azimuth), finger.radius * std::sin(finger.azimuth),
                finger.azimuth);
  return "<body " + std::string(place) +
         "><joint axis='0 1 0' range='-1 1.5'/><geom type='mesh' mesh='link'/>"
         "<body name='" +
         name +
         "' pos='0 0 -.05'><joint axis='0 1 0' range='-1 1.5'/><geom type='mesh' mesh='link'/>"
         "</body></body>";
}

class ExactMeshHandTest : public MujocoTest {
 protected:
  // The hand comes from above; its palm slides in three directions.
  static Scene Grasp(const std::vector<Finger>& fingers) {
    std::string xml =
        "<mujoco><compiler angle='radian' autolimits='true'/><asset>" +
        MeshXml("cup", Cup(kCupRadius, kCupHeight, kWall, 24), "inertia='exact'") +
        MeshXml("link", Link()) +
        MeshXml("palm",
                Revolution({{0.005, -0.01}, {0.06, -0.01}, {0.06, 0.01}, {0.005, 0.01}}, 20),
                "inertia='exact'") +
        "</asset><worldbody><geom type='mesh' mesh='cup'/><body pos='0 0 .14'>"
        "<joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/>"
        "<joint type='slide' axis='0 0 1'/><geom type='mesh' mesh='palm'/>";
    for (std::size_t k = 0; k < fingers.size(); ++k) {
      xml += FingerXml(fingers[k], "tip" + std::to_string(k));
    }
    return Scene::FromString(xml + "</body></worldbody></mujoco>", Exact());
  }

  // How far a tip's centre of mass is from the middle of the wall, outside positive.
  static double Outside(const Scene& scene, const std::vector<double>& q, std::size_t finger) {
    const mjModel* m = scene.model();
    const DataPtr d(mj_makeData(m));
    mju_copy(d->qpos, q.data(), m->nq);
    mj_kinematics(m, d.get());
    const int body = mj_name2id(m, mjOBJ_BODY, ("tip" + std::to_string(finger)).c_str());
    const double* p = d->xipos + 3 * body;
    return std::hypot(p[0], p[1]) - (kCupRadius - 0.5 * kWall);
  }

  // Poses at and around the given one: fingers overlap the wall, and end on their side of it.
  static void ExpectFingersOnTheirSides(const std::vector<Finger>& fingers,
                                        Effort effort = Effort::kDefault) {
    const Scene scene = Grasp(fingers);
    Options options;
    options.effort = effort;
    Solver solver(scene, options);
    Random rng(51);
    int through = 0;
    for (int i = 0; i < 5; ++i) {
      std::vector<double> q = {rng.Uniform(-1e-3, 1e-3), rng.Uniform(-1e-3, 1e-3),
                               rng.Uniform(-5e-3, 5e-3)};
      for (const Finger& finger : fingers) {
        q.push_back(finger.proximal + rng.Uniform(-0.02, 0.02));
        q.push_back(finger.distal + rng.Uniform(-0.02, 0.02));
      }
      through += static_cast<int>(Verify(scene, q).contacts.size());
      const Result result = solver.Solve(q);
      ASSERT_EQ(result.status, Status::kSolved) << i << ": " << result.reason;
      EXPECT_TRUE(FreeByBoth(scene, result.q)) << i;
      EXPECT_LT(std::sqrt(result.sigma), 0.0012) << i;
      for (std::size_t k = 0; k < fingers.size(); ++k) {
        ASSERT_GT(fingers[k].side * Outside(scene, q, k), 0.0) << "not what the test is about";
        EXPECT_GT(fingers[k].side * Outside(scene, result.q, k), 0.005) << i << " finger " << k;
      }
    }
    EXPECT_GE(through, 5 * static_cast<int>(fingers.size()));
  }
};

std::vector<Finger> ThreeOf(const Finger& finger) {
  std::vector<Finger> fingers(3, finger);
  for (int k = 0; k < 3; ++k) fingers[k].azimuth = 2.0 * M_PI * k / 3.0;
  return fingers;
}

constexpr Finger kOutside = {0.05, 0.0, 1, 0.1, 0.15}, kInside = {0.02, 0.0, -1, -0.1, -0.1};

TEST_F(ExactMeshHandTest, ThreeFingersAroundACupStayOutside) {
  ExpectFingersOnTheirSides(ThreeOf(kOutside));
}

// Translations of the whole hand take fingers out over the rim; their joints take them back inside.
TEST_F(ExactMeshHandTest, ThreeFingersInACupStayInside) {
  for (const Effort effort : {Effort::kFast, Effort::kDefault, Effort::kMax}) {
    ExpectFingersOnTheirSides(ThreeOf(kInside), effort);
  }
}

// They overlap each other, too, through the wall.
TEST_F(ExactMeshHandTest, TheWallIsBetweenTwoFingers) {
  ExpectFingersOnTheirSides({kOutside, kInside});
}

// What parts the hulls parts the triangles.
TEST_F(ExactMeshHandTest, AnswersAreNoFartherThanThoseOfTheHulls) {
  const char* const file = MJCF_PDG_MODEL_DIR "/hand/hand_bottle.xml";
  const Scene hulls = Scene::FromFile(file), exact = Scene::FromFile(file, Exact());
  Options without_hulls;
  without_hulls.without = {"hulls"};
  int farther_without = 0;
  for (std::size_t k = 0; k < exact.KeyNames().size(); ++k) {
    SCOPED_TRACE(exact.KeyNames()[k]);
    const std::vector<double> q_in = exact.KeyQpos(static_cast<int>(k));
    const Result of_hulls = Solver(hulls).Solve(q_in), result = Solver(exact).Solve(q_in);
    ASSERT_NE(result.status, Status::kUnsolved) << result.reason;
    EXPECT_TRUE(FreeByBoth(exact, result.q));
    EXPECT_LE(result.sigma, 1.02 * of_hulls.sigma);
    farther_without += Solver(exact, without_hulls).Solve(q_in).sigma > 1.02 * of_hulls.sigma;
  }
  EXPECT_GE(farther_without, 2);
}

}  // namespace
}  // namespace mjcf_pdg::test
