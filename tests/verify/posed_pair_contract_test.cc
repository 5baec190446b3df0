// What posed_pair.h promises of pairs at poses, by corners of boxes, support functions of MuJoCo's
// own numbers, and the slow oracle.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include "tests/support/brute_distance.h"
#include "tests/support/test_support.h"
#include "verify/posed_pair.h"

namespace mjcf_pdg::test {
namespace {

using verify::Matrix3d;
using verify::PosedPair;
using verify::Proof;
using verify::Vector3d;

class PosedPairContractTest : public MujocoTest {};

// Every type against every other and a tilted plane, in bodies far from the origin whose geoms are
// off the bodies' frames.
struct Posed {
  explicit Posed(std::uint64_t seed) : rng(seed), scene(Scene::FromString(Xml(rng))) {
    d.reset(mj_makeData(m()));
  }
  static std::string Xml(Random& rng) {
    std::string assets, bodies;
    for (const int type : ConvexTypes()) {
      if (type == mjGEOM_PLANE) continue;
      const Shape shape = RandomShape(type, rng);
      const std::string name = "m" + std::to_string(type);
      std::string geom = "type='" + TypeName(type) + "' size='" + Join(shape.size) + "'";
      if (type == mjGEOM_MESH) {
        std::string vertices;
        for (const Vector3d& v : shape.vertices) vertices += Join(v) + " ";
        assets = "<mesh name='" + name + "' vertex='" + vertices + "'/>";
        geom = "type='mesh' mesh='" + name + "'";
      }
      for (int copy = 0; copy < 2; ++copy) {
        bodies += "<body><freejoint/><geom " + geom + " pos='" + Join(rng.InBox(0.1)) +
                  "' axisangle='" + Join(rng.UnitVector()) + " 1'/></body>";
      }
    }
    return "<mujoco><compiler angle='radian'/><asset>" + assets +
           "</asset><worldbody><geom size='.1' contype='0' conaffinity='0'/>" +
           "<geom type='plane' size='0 0 1' pos='2.5 1 3' euler='.4 .3 .2'/>" + bodies +
           "</worldbody></mujoco>";
  }
  const mjModel* m() const { return scene.model(); }
  const VerifierModel& model() const { return *scene.verifier_model(); }

  void Pose(double spread) {
    const Vector3d middle(3, 1, 3);
    for (int k = 0; k < scene.nq(); k += 7) {
      const Vector3d p = middle + rng.InBox(spread);
      const Eigen::Quaterniond turn = rng.UnitQuat();
      mju_copy(d->qpos + k, p.data(), 3);
      mju_copy(d->qpos + k + 3, Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z()).data(), 4);
    }
    mj_kinematics(m(), d.get());
  }
  double Gap(const PosedPair& posed, const Vector3d& n_W) const {
    return -Support(m(), d.get(), posed.pair.geom1, n_W) -
           Support(m(), d.get(), posed.pair.geom2, -n_W);
  }

  Random rng;
  Scene scene;
  DataPtr d;
};

// The greatest distance of the two boxes of geom_aabb along an axis of either, by their corners.
double BoxGap(const mjModel& m, const mjData& d, int geom1, int geom2) {
  double gap = -std::numeric_limits<double>::infinity();
  std::vector<Vector3d> corners[2], axes;
  for (int k = 0; k < 2; ++k) {
    const int geom = k == 0 ? geom1 : geom2;
    const Matrix3d R = verify::GeomRotation(d, geom);
    for (int i = 0; i < 8; ++i) {
      const Vector3d sides(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      const mjtNum* box = m.geom_aabb + 6 * geom;
      const Vector3d corner = verify::VectorAt(box) + sides.cwiseProduct(verify::VectorAt(box + 3));
      corners[k].push_back(verify::VectorAt(d.geom_xpos + 3 * geom) + R * corner);
    }
    for (int i = 0; i < 3; ++i) axes.insert(axes.end(), {R.col(i), -R.col(i)});
  }
  for (const Vector3d& n : axes) {
    double ahead = std::numeric_limits<double>::infinity(), behind = -ahead;
    for (const Vector3d& p : corners[0]) behind = std::max(behind, n.dot(p));
    for (const Vector3d& p : corners[1]) ahead = std::min(ahead, n.dot(p));
    gap = std::max(gap, ahead - behind);
  }
  return gap;
}

TEST_F(PosedPairContractTest, BoundsAreThoseOfSpheresAndBoxesAndNeverTooGreat) {
  Posed posed(1);
  const mjModel& m = *posed.m();
  std::set<int> types;
  int close = 0;
  for (int trial = 0; trial < 4; ++trial) {
    posed.Pose(trial % 2 ? 0.3 : 1.0);
    for (const verify::CheckedPair& checked : posed.model().pairs) {
      const PosedPair pair{posed.model(), *posed.d, checked};
      const double distance =
          BruteDistance(&m, posed.d.get(), checked.geom1, checked.geom2).distance;
      types.insert(m.geom_type[checked.geom1]);
      const bool plane = m.geom_type[checked.geom1] == mjGEOM_PLANE;
      EXPECT_EQ(pair.HasPlane(), plane);
      EXPECT_LE(pair.SphereBound(), distance + 1e-9);
      EXPECT_LE(pair.BoxBound().gap, distance + 1e-9);
      // No geom is farther from its origin than its extent, and each is as far in some direction.
      double extents = 0.0;
      for (const int geom : {checked.geom1, checked.geom2}) {
        if (m.geom_type[geom] == mjGEOM_PLANE) continue;
        const double extent = posed.model().shapes[geom].extent;
        EXPECT_LE(extent,
                  1.001 * m.geom_rbound[geom] + verify::VectorAt(m.geom_aabb + 6 * geom).norm());
        extents += extent;
      }
      const Vector3d between = verify::VectorAt(posed.d->geom_xpos + 3 * checked.geom2) -
                               verify::VectorAt(posed.d->geom_xpos + 3 * checked.geom1);
      if (plane) {
        const Vector3d up = verify::GeomRotation(*posed.d, checked.geom1).col(2);
        EXPECT_NEAR(pair.SphereBound(), up.dot(between) - extents, 1e-12);
        EXPECT_EQ(pair.BoxBound().gap, -std::numeric_limits<double>::infinity());
        EXPECT_EQ(pair.BoxGap(0), -std::numeric_limits<double>::infinity());
        continue;
      }
      close += pair.BoxBound().gap > 0.8 * distance && distance > 0.0;
      EXPECT_NEAR(pair.size(), extents, 1e-12);
      EXPECT_NEAR(pair.SphereBound(), between.norm() - extents, 1e-12);
      const verify::AxisGap widest = pair.BoxBound();
      EXPECT_NEAR(widest.gap, BoxGap(m, *posed.d, checked.geom1, checked.geom2), 1e-12);
      EXPECT_NEAR(pair.BoxGap(widest.axis), widest.gap, 1e-12);
      for (int axis = 0; axis < 6; ++axis) EXPECT_LE(pair.BoxGap(axis), widest.gap + 1e-12);
    }
  }
  EXPECT_EQ(types.size(), 7u);
  EXPECT_GT(close, 20);
}

TEST_F(PosedPairContractTest, ShapesAndCertificatesAreInTheFrameOfGeom1) {
  Posed posed(2);
  posed.Pose(0.6);
  int pairs = 0;
  for (const verify::CheckedPair& checked : posed.model().pairs) {
    const PosedPair pair{posed.model(), *posed.d, checked};
    const Matrix3d R = verify::GeomRotation(*posed.d, checked.geom1);
    const Vector3d origin = verify::VectorAt(posed.d->geom_xpos + 3 * checked.geom1);
    verify::Certificate found;
    found.n = posed.rng.UnitVector();
    found.gap = posed.rng.Uniform();
    found.p1 = posed.rng.InBox(1.0);
    found.p2 = posed.rng.InBox(1.0);
    const verify::Reading reading = pair.ToWorld(found);
    EXPECT_EQ(reading.distance, found.gap);
    EXPECT_LT((R.transpose() * reading.n_W - found.n).norm(), 1e-14);
    EXPECT_LT((R.transpose() * (reading.p1_W - origin) - found.p1).norm(), 1e-14);
    EXPECT_LT((R.transpose() * (reading.p2_W - origin) - found.p2).norm(), 1e-14);
    if (pair.HasPlane()) continue;
    ++pairs;
    const verify::ConvexPair shapes = pair.Shapes();
    const verify::DifferencePoint point = shapes.Support(found.n);
    EXPECT_NEAR(found.n.dot(point.b - point.a) - shapes.radii(), posed.Gap(pair, R * found.n),
                1e-12);
    EXPECT_NEAR(shapes.CoreGap(found.n) - shapes.radii(), posed.Gap(pair, R * found.n), 1e-12);
  }
  EXPECT_GT(pairs, 60);
}

TEST_F(PosedPairContractTest, OfAPlaneTheLowestPointDecides) {
  Posed posed(3);
  const mjModel& m = *posed.m();
  int above = 0, below = 0;
  for (int trial = 0; trial < 20; ++trial) {
    posed.Pose(0.5);
    for (const verify::CheckedPair& checked : posed.model().pairs) {
      const PosedPair pair{posed.model(), *posed.d, checked};
      if (!pair.HasPlane()) continue;
      const Vector3d up = verify::GeomRotation(*posed.d, checked.geom1).col(2);
      const Vector3d origin = verify::VectorAt(posed.d->geom_xpos + 3 * checked.geom1);
      const double distance = -Support(&m, posed.d.get(), checked.geom2, -up) - up.dot(origin);
      const verify::Reading reading = pair.AgainstPlane();
      ++(distance > 0.0 ? above : below);
      EXPECT_NEAR(reading.distance, distance, 1e-12);
      EXPECT_LT((reading.n_W - up).norm(), 1e-15);
      EXPECT_NEAR(up.dot(reading.p1_W - origin), 0.0, 1e-12);
      EXPECT_LT((reading.p2_W - reading.p1_W - distance * up).norm(), 1e-12);
      for (int k = 0; k < 50; ++k) {  // p2 is a point of the geom
        const Vector3d n = posed.rng.UnitVector();
        EXPECT_LE(n.dot(reading.p2_W), Support(&m, posed.d.get(), checked.geom2, n) + 1e-12);
      }
    }
  }
  EXPECT_GT(above, 30);
  EXPECT_GT(below, 30);
}

// Certificates of what is needed, a little more and a little less: the plane parts the geoms by so
// much, the points are theirs.
TEST_F(PosedPairContractTest, DecisionsAreProvenInWorldAxes) {
  Posed posed(4);
  const mjModel& m = *posed.m();
  int apart = 0, overlapping = 0, planes = 0;
  for (int trial = 0; trial < 4; ++trial) {
    posed.Pose(trial % 2 ? 0.25 : 0.5);
    for (const verify::CheckedPair& checked : posed.model().pairs) {
      const PosedPair pair{posed.model(), *posed.d, checked};
      double distance = BruteDistance(&m, posed.d.get(), checked.geom1, checked.geom2).distance;
      if (pair.HasPlane()) distance = pair.AgainstPlane().distance;
      SCOPED_TRACE(std::to_string(m.geom_type[checked.geom1]) + " " +
                   std::to_string(m.geom_type[checked.geom2]) + " " + std::to_string(distance));
      const double width = 1e-3 * std::abs(distance) + 1e-6;
      const verify::Certificate yes = pair.Decide(distance - width);
      EXPECT_EQ(yes.proof, Proof::kPlane);
      EXPECT_NEAR(yes.n.norm(), 1.0, 1e-12);
      EXPECT_GE(yes.gap, distance - width - 1e-12);
      if (!pair.HasPlane()) {
        EXPECT_NEAR(posed.Gap(pair, yes.n), yes.gap, 1e-9);
      }
      const verify::Certificate no = pair.Decide(distance + width);
      EXPECT_EQ(no.proof, Proof::kPoints);
      ++(distance > 0.0 ? apart : overlapping);
      planes += pair.HasPlane();
      EXPECT_LT((no.p2 - no.p1).norm(), std::max(distance, 0.0) + width + 1e-9);
      for (int k = 0; k < 50; ++k) {
        const Vector3d n = posed.rng.UnitVector();
        EXPECT_LE(n.dot(no.p2), Support(&m, posed.d.get(), checked.geom2, n) + 1e-9);
        if (pair.HasPlane()) continue;
        EXPECT_LE(n.dot(no.p1), Support(&m, posed.d.get(), checked.geom1, n) + 1e-9);
      }
      if (!pair.HasPlane()) continue;
      const Vector3d up = verify::GeomRotation(*posed.d, checked.geom1).col(2);
      const Vector3d origin = verify::VectorAt(posed.d->geom_xpos + 3 * checked.geom1);
      EXPECT_LE(up.dot(no.p1 - origin), 1e-12) << "a point of the half-space";
    }
  }
  EXPECT_GT(apart, 50);
  EXPECT_GT(overlapping, 50);
  EXPECT_GT(planes, 20);
}

}  // namespace
}  // namespace mjcf_pdg::test
