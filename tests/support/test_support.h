// What the tests share: a fixture, seeded random numbers, and scenes made on the fly.
#ifndef MJCF_PDG_TESTS_SUPPORT_TEST_SUPPORT_H_
#define MJCF_PDG_TESTS_SUPPORT_TEST_SUPPORT_H_

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::test {

struct ModelDeleter {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};
struct DataDeleter {
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using ModelPtr = std::unique_ptr<mjModel, ModelDeleter>;
using DataPtr = std::unique_ptr<mjData, DataDeleter>;

// A fixture that turns every MuJoCo warning into a failure of the test, and aborts at an error.
class MujocoTest : public ::testing::Test {
 protected:
  MujocoTest();
  ~MujocoTest() override;
  void TearDown() override;

  // Returns MuJoCo's messages so far and forgets them, for tests that provoke a warning on purpose.
  std::vector<std::string> TakeMessages();

 private:
  mjfLogHandler previous_;
};

// Compiles MJCF text; adds a failure and returns null if that does not work.
ModelPtr LoadModel(const std::string& xml);
// Every byte of a model (sizes, options, arrays, the struct itself), to show that it is unchanged.
std::vector<char> ModelBytes(const mjModel* m);

// Random numbers that are the same with any standard library, unlike those of std's distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double Uniform(double lo = 0.0, double hi = 1.0);
  int Index(int n);  // 0 .. n-1
  bool Chance(double p) { return Uniform() < p; }
  double Normal();  // standard normal
  Eigen::VectorXd Normals(int n);
  Eigen::Vector3d InBox(double half);  // each coordinate in ± half
  Eigen::Vector3d UnitVector();
  Eigen::Quaterniond UnitQuat();  // uniform over rotations, either sign

 private:
  std::mt19937_64 engine_;
};

std::vector<double> ToVector(const Eigen::VectorXd& q);
Eigen::VectorXd ToEigen(const std::vector<double>& q);

// A configuration with movable joints at random inside their limits, the others as in `base`
// (empty: qpos0). Slides without limits and free positions are within `spread` [m] of `base`,
// hinges without limits within ±π.
Eigen::VectorXd RandomConfiguration(const Scene& scene, Random& rng, double spread = 0.5,
                                    const std::vector<double>& base = {});

// The numbers with 17 digits, separated by blanks, for XML attributes and failure messages.
std::string Join(const double* values, int n);
std::string Join(const Eigen::VectorXd& values);

// The message of the Error that f throws.
template <typename Function>
std::string ErrorOf(Function&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "(no Error was thrown)";
}

// ---- Scenes ----

struct Shape {
  int type = mjGEOM_SPHERE;  // mjtGeom; mjGEOM_MESH: the convex hull of `vertices`
  Eigen::Vector3d size = Eigen::Vector3d::Constant(0.1);  // as in geom_size [m]
  std::vector<Eigen::Vector3d> vertices = {};
  std::string attributes = {};  // more of the geom's XML, e.g. margin="0.01"
};

// Types of geoms with a signed distance: plane, sphere, capsule, ellipsoid, cylinder, box, mesh.
const std::vector<int>& ConvexTypes();
std::string TypeName(int type);
// A shape with random sizes of 0.05 to 0.25 m; a mesh is the hull of points near an ellipsoid.
Shape RandomShape(int type, Random& rng);

struct TwoGeoms {
  Shape first = {}, second = {};
  std::string joint1 = "<freejoint name='j1'/>";
  std::string joint2 = {};             // empty: a static body
  std::string pose1 = {}, pose2 = {};  // XML attributes of the bodies: pos, quat
  std::string extra = {};              // top-level XML: <option>, <contact>, ...
};
// Bodies "b1", "b2" under the world with geoms "g1", "g2". A plane must not move.
std::string TwoGeomXml(const TwoGeoms& scene);

std::string ArmXml();                    // hinge, hinge, slide, hinge on a stand; a wall, a crate
std::string BallChainXml(bool limited);  // three ball joints in a row, masses off their anchors
std::string TwoTreesXml();               // two free bodies, one carries a hinge, one a ball joint
std::string OffCentreXml();              // several joints per body, away from its centre of mass
struct RobotOptions {
  int bodies = 8;
  bool free_base = false;
  int obstacles = 4;
  bool limits = true;
  bool meshes = true;
};
// A random tree of all joint kinds and geom types among static obstacles and a floor.
std::string RandomRobotXml(Random& rng, const RobotOptions& options = {});

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_TEST_SUPPORT_H_
