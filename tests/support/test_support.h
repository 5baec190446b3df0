// What the tests share: a fixture, seeded random numbers, scenes made on the fly, a slow oracle.
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

// Turns every MuJoCo warning or error into a failure of the running test.
class MujocoTest : public ::testing::Test {
 protected:
  MujocoTest();
  ~MujocoTest() override;
  void TearDown() override;

  // What MuJoCo said so far; forgets it, for tests that provoke a warning on purpose.
  std::vector<std::string> TakeMessages();

 private:
  mjfLogHandler previous_;
};

// Compiles MJCF text; adds a failure and returns null if that does not work.
ModelPtr LoadModel(const std::string& xml);
// Every byte of a model (struct sizes, options, arrays), to compare before and after.
std::vector<char> ModelBytes(const mjModel* m);

// Portable: the same numbers from any standard library (std's distributions are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double Uniform(double lo = 0.0, double hi = 1.0);
  int Index(int n);  // 0 .. n-1
  bool Chance(double p) { return Uniform() < p; }
  double Normal();
  Eigen::VectorXd Normals(int n);
  Eigen::Vector3d InBox(double half);
  Eigen::Vector3d UnitVector();
  Eigen::Quaterniond UnitQuat();  // uniform over rotations, either sign

 private:
  std::mt19937_64 engine_;
};

std::vector<double> ToVector(const Eigen::VectorXd& q);
Eigen::VectorXd ToEigen(const std::vector<double>& q);

// Movable joints at random inside their limits, the others as in `base` (empty: qpos0). Slides
// without limits and free positions stay within `spread` [m] of `base`, hinges within ±π.
Eigen::VectorXd RandomConfiguration(const Scene& scene, Random& rng, double spread = 0.5,
                                    const std::vector<double>& base = {});

// Numbers at 17 digits, blank in between: for XML attributes and failure messages.
std::string Join(const double* values, int n);
std::string Join(const Eigen::VectorXd& values);

// What the Error thrown by f says.
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
  Eigen::Vector3d size = Eigen::Vector3d::Constant(0.1);  // MuJoCo's meaning
  std::vector<Eigen::Vector3d> vertices = {};
  std::string attributes = {};  // more of the geom's XML, e.g. margin="0.01"
};

// Types of geoms with a signed distance: plane, sphere, capsule, ellipsoid, cylinder, box, mesh.
const std::vector<int>& ConvexTypes();
std::string TypeName(int type);
// Random sizes about 0.05 to 0.3 m; a mesh is the hull of points near an ellipsoid.
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

std::string ArmXml();                    // hinge, hinge, slide, hinge on a stand; wall, box
std::string BallChainXml(bool limited);  // three ball joints, off-centre masses
std::string TwoTreesXml();               // two free trees with a hinge and a ball below
std::string OffCentreXml();              // several joints per body, away from its centre
struct RobotOptions {
  int bodies = 8;
  bool free_base = false;
  int obstacles = 4;
  bool limits = true;
  bool meshes = true;
};
// A random tree of all joint kinds and geom types among static obstacles and a floor.
std::string RandomRobotXml(Random& rng, const RobotOptions& options = {});

// ---- A slow oracle that shares no code with MuJoCo or us ----

// Support function of a convex geom at a posed configuration: the largest n · p over its points.
double Support(const mjModel* m, const mjData* d, int geom, const Eigen::Vector3d& n_W);

struct BruteGap {
  double distance = 0.0;  // signed; never above the true one
  Eigen::Vector3d n_W = Eigen::Vector3d::UnitX();
};
// Maximizes the gap -(h_1(n) + h_2(-n)) between supporting planes over unit vectors n: that is the
// signed distance of two convex geoms, overlapping or not. Planes are half-spaces.
BruteGap BruteDistance(const mjModel* m, const mjData* d, int geom1, int geom2);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_TEST_SUPPORT_H_
