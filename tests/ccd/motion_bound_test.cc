#include "ccd/motion_bound.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/ccd/line.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;

class MotionBoundTest : public MujocoTest {};

// A point of the geom's surface, or of its core if it is round, in its frame.
Vector3d SurfacePoint(const mjModel& m, int geom, const Vector3d& u) {
  const Vector3d size = AsVector(m.geom_size + 3 * geom);
  const double end = u.z() < 0.0 ? -size[1] : size[1];
  switch (m.geom_type[geom]) {
    case mjGEOM_SPHERE:
      return Vector3d::Zero();
    case mjGEOM_CAPSULE:
      return Vector3d(0, 0, end);
    case mjGEOM_ELLIPSOID:
      return size.cwiseProduct(size).cwiseProduct(u) / size.cwiseProduct(u).norm();
    case mjGEOM_CYLINDER:
      return Vector3d(size[0] * u.x(), size[0] * u.y(), 0.0) / u.head<2>().norm() +
             Vector3d(0, 0, end);
    case mjGEOM_BOX:
      return size.cwiseProduct(u.cwiseSign());
  }
  const int mesh = m.geom_dataid[geom];
  int best = m.mesh_vertadr[mesh];
  for (int v = best; v < m.mesh_vertadr[mesh] + m.mesh_vertnum[mesh]; ++v) {
    auto reach = [&](int k) {
      return u.dot(Eigen::Map<const Eigen::Vector3f>(m.mesh_vert + 3 * k).cast<double>());
    };
    if (reach(v) > reach(best)) best = v;
  }
  return Eigen::Map<const Eigen::Vector3f>(m.mesh_vert + 3 * best).cast<double>();
}

struct GeomPose {
  GeomPose(const PosedModel& posed, int geom)
      : R(AsMatrix(posed.data()->geom_xmat + 9 * geom)),
        p(AsVector(posed.data()->geom_xpos + 3 * geom)) {}
  Vector3d ToWorld(const Vector3d& x) const { return p + R * x; }
  Vector3d ToLocal(const Vector3d& x_W) const { return R.transpose() * (x_W - p); }
  Matrix3d R;
  Vector3d p;
};

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

TEST_F(MotionBoundTest, NoSignedDistanceChangesFasterThanTheBound) {
  Random rng(1);
  std::vector<double> tightness, tightness_short;
  for (const Scene& scene : Scenes(rng)) {
    Line line(scene);
    for (int trial = 0; trial < 60; ++trial) {
      line.Set(RandomConfiguration(scene, rng), RandomTangent(line, rng));
      const int pair = rng.Index(scene.num_kept_pairs()), bodies = line.BodyPairOf(pair);
      if (!line.bound.Moves(bodies)) continue;
      const double start = rng.Uniform(0.0, 0.8);
      const double horizon = rng.Chance(0.5) ? 0.02 : 1.0 - start;
      line.Pose(start);
      const double closing = line.bound.Geoms(line.finder.posed(), bodies, pair, horizon).closing;
      double spheres = 0.0;
      EXPECT_LE(closing,
                line.bound.BodiesClosing(line.finder.posed(), bodies, horizon, spheres) + 1e-12);
      constexpr int kSteps = 200;
      double before = 0.0, fastest = 0.0;
      NearPair near;
      for (int i = 0; i <= kSteps; ++i) {
        line.Pose(start + horizon * i / kSteps);
        ASSERT_TRUE(line.finder.Distance(pair, 100.0, near));
        const bool usable = i > 0 && near.distance > 0.0 && before > 0.0;
        const double change = usable ? std::abs(near.distance - before) : 0.0;
        EXPECT_LE(change, closing * horizon / kSteps + 1e-7)
            << scene.GeomName(line.tables.pairs[pair].geom1);
        fastest = std::max(fastest, change * kSteps / horizon);
        before = near.distance;
      }
      if (fastest > 0.0) (horizon < 0.1 ? tightness_short : tightness).push_back(fastest / closing);
    }
  }
  std::printf("  fastest change of distance / bound: median %.2f (long), %.2f (short), %zu lines\n",
              Median(tightness), Median(tightness_short),
              tightness.size() + tightness_short.size());
  EXPECT_GT(tightness.size(), 100u);
  EXPECT_GT(Median(tightness), 0.25);
  EXPECT_GT(Median(tightness_short), 0.2);
}

TEST_F(MotionBoundTest, WithinAReachNoSignedDistanceChangesByMoreWhateverTheLine) {
  Random rng(3);
  std::vector<double> tightness;
  for (const Scene& scene : Scenes(rng)) {
    Line line(scene);
    VectorXd shares(line.tables.n);
    for (int trial = 0; trial < 60; ++trial) {
      line.Set(RandomConfiguration(scene, rng), RandomTangent(line, rng));
      const VectorXd reach = rng.Uniform(0.01, 1.0) * line.dq.cwiseAbs();
      const int pair = rng.Index(scene.num_kept_pairs()), bodies = line.BodyPairOf(pair);
      line.bound.SetReach(reach);
      line.Pose(0.0);
      if (!line.bound.Moves(bodies)) continue;
      const double most = line.bound.Geoms(line.finder.posed(), bodies, pair, 1.0).closing;
      line.bound.SharesOfLast(bodies, shares);
      EXPECT_GE(shares.minCoeff(), 0.0);
      EXPECT_LE(most, shares.sum() + 1e-9);  // a rotation's share counts by its three entries
      NearPair before, after;
      ASSERT_TRUE(line.finder.Distance(pair, 100.0, before));
      double largest = 0.0;
      for (int k = 0; k < 40; ++k) {
        for (int i = 0; i < line.dq.size(); ++i) line.dq[i] = rng.Uniform(-1.0, 1.0) * reach[i];
        line.Pose(1.0);
        ASSERT_TRUE(line.finder.Distance(pair, 100.0, after));
        if (before.distance < 0.0 && after.distance < 0.0) continue;  // depths may jump
        largest = std::max(largest, std::abs(after.distance - before.distance));
      }
      EXPECT_LE(largest, most + 1e-7);
      if (largest > 0.0) tightness.push_back(largest / most);
    }
  }
  EXPECT_GT(tightness.size(), 100u);
  EXPECT_GT(Median(tightness), 0.1);
}

// x(s + h) = x(s) + h x' + ½ h² x'' + at most j h³ / 6, for points of either geom seen from the
// other, and the same backwards.
TEST_F(MotionBoundTest, NoPointLeavesItsParabolaFasterThanTheJerkAllows) {
  Random rng(2);
  std::vector<double> tightness;
  for (const Scene& scene : Scenes(rng)) {
    Line line(scene);
    for (int trial = 0; trial < 100; ++trial) {
      line.Set(RandomConfiguration(scene, rng), RandomTangent(line, rng));
      const int pair = rng.Index(scene.num_kept_pairs()), bodies = line.BodyPairOf(pair);
      if (!line.bound.Moves(bodies)) continue;
      const bool first = rng.Chance(0.5);
      int seen = line.tables.pairs[pair].geom1, from = line.tables.pairs[pair].geom2;
      if (!first) std::swap(seen, from);
      if (line.tables.model->geom_type[seen] == mjGEOM_PLANE) continue;
      const double start = rng.Uniform(0.0, 1.0), direction = rng.Chance(0.5) ? 1.0 : -1.0;
      const double horizon = direction > 0.0 ? 1.0 - start : start;
      line.Pose(start);
      const RelativeMotion motion = line.bound.Geoms(line.finder.posed(), bodies, pair, horizon);
      const double jerk = first ? motion.jerk1 : motion.jerk2;
      Twist twist = first ? motion.twist : -motion.twist;
      if (direction < 0.0) twist = twist.Backwards();
      const GeomPose seen0(line.finder.posed(), seen), from0(line.finder.posed(), from);
      double worst = 0.0;
      for (int i = 0; i < 40; ++i) {
        const double h = i == 0 ? std::min(1e-3, horizon) : rng.Uniform(0.0, horizon);
        line.Pose(start + direction * h);
        const GeomPose seen1(line.finder.posed(), seen), from1(line.finder.posed(), from);
        const Vector3d x = SurfacePoint(*line.tables.model, seen, rng.UnitVector());
        const Vector3d x0 = seen0.ToWorld(x);
        const Vector3d v = twist.v_W + twist.omega_W.cross(x0);
        const Vector3d a = twist.v_rate_W + twist.omega_rate_W.cross(x0) + twist.omega_W.cross(v);
        const Vector3d moved = from0.ToWorld(from1.ToLocal(seen1.ToWorld(x)));
        const double error = (moved - x0 - h * v - 0.5 * h * h * a).norm();
        const double most = jerk * h * h * h / 6.0;
        EXPECT_LE(error, most + 1e-12);
        if (h > 0.01 && jerk > 0.0) worst = std::max(worst, error / most);
      }
      if (jerk > 0.0) tightness.push_back(worst);
    }
  }
  std::printf("  deviation from the parabola / bound: median %.2f, %zu lines\n", Median(tightness),
              tightness.size());
  EXPECT_GT(tightness.size(), 200u);
  EXPECT_GT(Median(tightness), 0.05);
}

// What is known of a pair is kept for the next question, and not for one about another.
TEST_F(MotionBoundTest, AnswersDoNotHangOnWhatWasAskedBefore) {
  Random rng(6);
  int asked = 0;
  for (const Scene& scene : Scenes(rng)) {
    Line line(scene), fresh(scene);
    line.Set(RandomConfiguration(scene, rng), RandomTangent(line, rng));
    double t = 0.0;
    line.Pose(t);
    for (int k = 0; k < 200; ++k) {
      const int pair = rng.Index(scene.num_kept_pairs()), bodies = line.BodyPairOf(pair);
      if (!line.bound.Moves(bodies)) continue;
      if (rng.Chance(0.2)) line.Pose(t = rng.Uniform(0.0, 1.0));
      const PosedModel& posed = line.finder.posed();
      const double horizon = rng.Chance(0.5) ? 0.1 : 0.2;
      double distance = 0.0;
      line.bound.Closing(posed, bodies, pair, horizon);
      if (rng.Chance(0.5)) line.bound.BodiesClosing(posed, bodies, 2.0 * horizon, distance);
      const RelativeMotion motion = line.bound.Geoms(posed, bodies, pair, horizon);
      fresh.Set(line.q0, line.dq);
      fresh.Pose(t);
      const RelativeMotion expected =
          fresh.bound.Geoms(fresh.finder.posed(), bodies, pair, horizon);
      EXPECT_EQ(motion.closing, expected.closing);
      EXPECT_EQ(motion.jerk1, expected.jerk1);
      EXPECT_EQ(motion.jerk2, expected.jerk2);
      EXPECT_EQ(motion.twist.v_rate_W, expected.twist.v_rate_W);
      ++asked;
    }
  }
  EXPECT_GT(asked, 1000);
}

struct Rates {
  double geoms = 0.0, bodies = 0.0;
};

// λ of the first kept pair over the whole line from qpos0.
Rates RatesOf(const std::string& world, const VectorXd& dq, const SceneOptions& options = {}) {
  Line line(Scene::FromString("<mujoco><compiler boundmass='1' boundinertia='1'/><worldbody>" +
                                  world + "</worldbody></mujoco>",
                              options));
  line.Set(ToEigen(line.scene.DefaultQpos()), dq);
  line.Pose(0.0);
  double distance = 0.0;
  Rates rates;
  if (!line.bound.Moves(0)) return rates;
  rates.geoms = line.bound.Geoms(line.finder.posed(), 0, 0, 1.0).closing;
  rates.bodies = line.bound.BodiesClosing(line.finder.posed(), 0, 1.0, distance);
  return rates;
}

constexpr const char* kPlane = "<geom type='plane' size='0 0 1'/>";

TEST_F(MotionBoundTest, AHingeCountsItsAngleTimesTheFarEnd) {
  const Rates rates = RatesOf(std::string(kPlane) + R"(<body pos="0 0 2"><joint axis="0 1 0"/>
      <geom type="box" size=".5 .01 .01" pos=".5 0 0"/></body>)",
                              VectorXd::Constant(1, 0.5));
  EXPECT_NEAR(rates.geoms, 0.5 * 1.0, 0.01);
  EXPECT_GE(rates.geoms, 0.5 * std::hypot(1.0, 0.01));
}

TEST_F(MotionBoundTest, ARoundThingThatSpinsAboutItsOwnAxisDoesNotCount) {
  const Rates rates = RatesOf(std::string(kPlane) + R"(<body pos="0 0 2"><joint axis="0 0 1"/>
      <geom type="capsule" size=".01 .5"/></body>)",
                              VectorXd::Constant(1, 3.0));
  EXPECT_NEAR(rates.geoms, 0.0, 1e-12);
}

TEST_F(MotionBoundTest, ABarThatSpinsAboutItsOwnAxisCountsItsThicknessOnly) {
  const Rates rates = RatesOf(std::string(kPlane) + R"(<body pos="0 0 2"><joint axis="0 0 1"/>
      <geom type="box" size=".01 .01 .5"/></body>)",
                              VectorXd::Constant(1, 3.0));
  EXPECT_GE(rates.geoms, 3.0 * 0.01 * std::sqrt(2.0));
  EXPECT_LE(rates.geoms, 3.0 * 0.0201);
}

TEST_F(MotionBoundTest, ASlideCountsItsLengthWhateverTheGeom) {
  const Rates rates = RatesOf(std::string(kPlane) + R"(<body pos="0 0 2">
      <joint type="slide" axis="1 1 0"/><geom type="box" size="1 1 1"/></body>)",
                              VectorXd::Constant(1, -0.7));
  EXPECT_NEAR(rates.geoms, 0.7, 1e-15);
  EXPECT_NEAR(rates.bodies, 0.7, 1e-15);
}

TEST_F(MotionBoundTest, AFreeJointTurnsItsGeomsAboutTheBodyOrigin) {
  VectorXd dq = VectorXd::Zero(6);
  dq << 0.3, 0.0, 0.4, 0.0, 2.0, 0.0;
  const Rates rates = RatesOf(std::string(kPlane) + R"(<body pos="0 0 9"><freejoint/>
      <geom type="sphere" size=".1" pos="3 0 0"/></body>)",
                              dq);
  EXPECT_NEAR(rates.geoms, 0.5 + 2.0 * 3.0, 1e-12);
}

TEST_F(MotionBoundTest, ASlideInBetweenLengthensTheMomentArmByItsTravel) {
  const std::string world = std::string(kPlane) + R"(<body pos="0 0 9"><joint axis="0 1 0"/>
      <body><joint type="slide" axis="1 0 0"/><geom type="sphere" size=".1" pos="1 0 0"/></body>
      </body>)";
  VectorXd dq(2);
  dq << 1.0, 0.5;
  EXPECT_NEAR(RatesOf(world, dq).geoms, (1.0 + 0.5) * 1.0 + 0.5, 1e-12);
}

// The far anchor bounds the moment arm of the near joint: it moves away with the slide in between.
TEST_F(MotionBoundTest, ASlideBetweenTwoHingesStretchesTheChainOfAnchors) {
  const std::string world = std::string(kPlane) + R"(<body pos="0 0 9"><joint axis="0 1 0"/>
      <body><joint type="slide" axis="1 0 0"/><body pos="1 0 0"><joint axis="0 1 0"/>
      <geom type="sphere" size=".1" pos=".2 0 0"/></body></body></body>)";
  const Vector3d dq(1.0, 0.5, 2.0);
  // Outer hinge: 0.2. Slide: 0.5. Inner: |1| + 0.5 + 0.2, less than 1.2 + 0.5 + 0.4 by travels.
  EXPECT_NEAR(RatesOf(world, dq).geoms, 2.0 * 0.2 + 0.5 + 1.0 * (1.0 + 0.5 + 0.2), 1e-12);
}

TEST_F(MotionBoundTest, JointsAboveBothGeomsDoNotCount) {
  const std::string world = R"(<body><joint axis="0 0 1"/>
      <body pos="1 0 0"><joint axis="0 1 0"/><geom type="sphere" size=".1" pos=".2 0 0"/></body>
      <body pos="2 0 0"><joint axis="0 1 0"/><geom type="sphere" size=".1" pos="0 0 .3"/></body>
      </body>)";
  EXPECT_EQ(RatesOf(world, Vector3d(5.0, 0.0, 0.0)).geoms, 0.0);
  EXPECT_NEAR(RatesOf(world, Vector3d(5.0, 1.0, 0.5)).geoms, 0.2 * 1.0 + 0.3 * 0.5, 1e-12);
}

TEST_F(MotionBoundTest, FrozenJointsDoNotCount) {
  const std::string world = std::string(kPlane) + R"(<body name="a" pos="0 0 9">
      <joint axis="0 1 0"/><body name="b" pos="1 0 0"><joint axis="0 1 0"/>
      <geom type="sphere" size=".1" pos="1 0 0"/></body></body>)";
  SceneOptions options;
  options.movable = {"b"};
  EXPECT_NEAR(RatesOf(world, VectorXd::Constant(1, 1.0), options).geoms, 1.0, 1e-12);
}

}  // namespace
}  // namespace mjcf_pdg::test
