// SDF geoms: distances, verdicts and answers against closed forms and sampled points. MuJoCo's own
// search for contacts misses overlaps of centimetres, to which a minimiser walks straight.
#include <gtest/gtest.h>

#include <cmath>

#include "collide/contacts.h"
#include "mjcf_pdg/pdg.h"
#include "tests/support/sdf_scenes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Q = std::vector<double>;

class SdfTest : public MujocoTest {};

constexpr double kBall = 0.12;  // radius of the ball [m]

Scene RingAndBall() { return Scene::FromString(SdfXml("torus", "<geom name='ball' size='.12'/>")); }

// The signed distance of the torus and the ball at p_W, and the direction from the torus to it.
struct RingGap {
  RingGap(const Scene& scene, const Vector3d& p_W) {
    PosedModel posed(&scene.tables().query_model);
    posed.Pose(ToEigen(scene.DefaultQpos()));
    const Matrix3d R = AsMatrix(posed.data()->geom_xmat);
    const Vector3d p = R.transpose() * (p_W - AsVector(posed.data()->geom_xpos));
    const double around = std::hypot(p.x(), p.y());
    const Vector3d on_ring = Vector3d(p.x(), p.y(), 0) * (kRing / around);
    from_ring = (p - on_ring).norm();
    distance = from_ring - kTube - kBall;
    n_W = R * (p - on_ring).normalized();
  }
  // The nearest parts of the two are on one line, and no other part of the ring is as near.
  bool Usual() const { return from_ring > 0.06 && from_ring < 0.32; }

  double from_ring, distance;
  Vector3d n_W;
};

Q At(const Vector3d& p) { return {p.x(), p.y(), p.z(), 1, 0, 0, 0}; }

Vector3d Place(Random& random) {
  return {random.Uniform(-0.5, 0.7), random.Uniform(-0.6, 0.6), random.Uniform(-0.6, 0.3)};
}

TEST_F(SdfTest, FeaturesAreThoseOfTheClosedForm) {
  const Scene scene = RingAndBall();
  ContactFinder finder(scene.tables());
  Random random(3);
  int overlaps = 0, apart = 0;
  for (int k = 0; k < 200; ++k) {
    const Vector3d p = Place(random);
    const RingGap gap(scene, p);
    if (!gap.Usual()) continue;
    finder.Pose(ToEigen(At(p)));
    const std::vector<NearPair>& near = finder.Find(0.1);
    ASSERT_FALSE(near.empty()) << k;
    const NearPair* nearest = &near.front();  // the functions' answers come before MuJoCo's
    EXPECT_NEAR(nearest->distance, gap.distance, 1e-6);
    const Vector3d n_W =
        scene.tables().pairs[0].geom1 == 0 ? nearest->n_W : Vector3d(-nearest->n_W);
    EXPECT_GT(n_W.dot(gap.n_W), 1 - 1e-4);
    EXPECT_NEAR(nearest->n_W.dot(nearest->p2_W - nearest->p1_W), nearest->distance, 1e-9);
    (gap.distance < 0.0 ? overlaps : apart) += 1;
  }
  EXPECT_GT(overlaps, 30);
  EXPECT_GT(apart, 5);
}

// Two hundredths of a millimetre on either side of touching.
TEST_F(SdfTest, TheVerdictIsThatOfTheClosedForm) {
  const Scene scene = RingAndBall();
  Random random(4);
  int judged = 0;
  for (int k = 0; k < 60; ++k) {
    const Vector3d p = Place(random);
    const RingGap gap(scene, p);
    if (!gap.Usual()) continue;
    const Vector3d touching = p - gap.distance * gap.n_W;
    EXPECT_FALSE(Verify(scene, At(touching - 2e-5 * gap.n_W)).free) << k;
    EXPECT_TRUE(Verify(scene, At(touching + 2e-5 * gap.n_W)).free) << k;
    const Verdict deep = Verify(scene, At(touching - 0.02 * gap.n_W));
    EXPECT_NEAR(deep.min_distance, -0.02, 1e-4);
    EXPECT_FALSE(deep.certified);
    ++judged;
  }
  EXPECT_GT(judged, 20);
}

// The shortest way out of a tube is straight away from it.
TEST_F(SdfTest, AnswersAreAsNearAsTheClosedForm) {
  const Scene scene = RingAndBall();
  Solver solver(scene);
  Random random(5);
  int solved = 0;
  for (int k = 0; k < 40; ++k) {
    const Vector3d p = Place(random);
    const RingGap gap(scene, p);
    if (!gap.Usual() || gap.distance > -0.005) continue;
    const Result result = solver.Solve(At(p));
    ASSERT_EQ(result.status, Status::kSolved) << result.reason;
    EXPECT_LE(std::sqrt(result.sigma), 1.01 * -gap.distance + 1e-5) << k;
    EXPECT_GE(std::sqrt(result.sigma), -gap.distance - 2e-5) << k;
    const RingGap after(scene, {result.q[0], result.q[1], result.q[2]});
    EXPECT_GE(after.distance, -2e-5);
    EXPECT_FALSE(result.certified);
    ++solved;
  }
  EXPECT_GT(solved, 10);
}

// A ball that moves straight into the tube stops before it, if not certified.
TEST_F(SdfTest, MotionsEndBeforeContact) {
  const Scene scene = RingAndBall();
  Random random(7);
  int stopped = 0;
  for (int k = 0; k < 60; ++k) {
    const Vector3d p = Place(random);
    const RingGap gap(scene, p);
    if (!gap.Usual() || gap.distance < 0.02) continue;
    const Motion motion = CheckMotion(scene, At(p), At(p - (gap.distance + 0.05) * gap.n_W));
    ASSERT_EQ(motion.outcome, MotionOutcome::kContact) << k;
    EXPECT_FALSE(motion.certified);
    const RingGap end(scene, {motion.q[0], motion.q[1], motion.q[2]});
    EXPECT_GE(end.distance, -1e-6);
    EXPECT_LE(end.distance, 1e-3);
    ++stopped;
  }
  EXPECT_GT(stopped, 3);
}

// The deepest of many random points of the box "box" in the SDF, by the plugin's function.
double DeepestPoint(const Scene& scene, const Q& q, Random& random) {
  const mjModel& m = *scene.model();
  const DataPtr d(mj_makeData(&m));
  mju_copy(d->qpos, q.data(), static_cast<int>(m.nq));
  mj_kinematics(&m, d.get());
  const int sdf = mj_name2id(&m, mjOBJ_GEOM, "sdf"), box = mj_name2id(&m, mjOBJ_GEOM, "box");
  const int mesh = m.geom_dataid[sdf];
  const mjpPlugin* plugin = mjc_getSDF(&m, sdf);
  double deepest = 0.0;
  for (int k = 0; k < 40000; ++k) {
    Vector3d x;
    for (int i = 0; i < 3; ++i) x[i] = m.geom_size[3 * box + i] * random.Uniform(-1, 1);
    x = AsVector(d->geom_xpos + 3 * box) + AsMatrix(d->geom_xmat + 9 * box) * x;
    x = AsMatrix(d->geom_xmat + 9 * sdf).transpose() * (x - AsVector(d->geom_xpos + 3 * sdf));
    Vector3d y;
    mju_rotVecQuat(y.data(), x.data(), m.mesh_quat + 4 * mesh);
    y += AsVector(m.mesh_pos + 3 * mesh);
    deepest = std::min(deepest, plugin->sdf_distance(y.data(), d.get(), m.geom_plugin[sdf]));
  }
  return deepest;
}

// Without the geoms' own functions 20 to 60 % of such answers overlap by up to centimetres.
TEST_F(SdfTest, NoPointOfAnAnswerIsInsideTheOtherGeom) {
  Random random(6);
  int solved = 0, asked = 0;
  for (const char* kind : {"torus", "bolt", "nut", "gear"}) {
    const Scene scene =
        Scene::FromString(SdfXml(kind, "<geom name='box' type='box' size='.3 .2 .15'/>"));
    Solver solver(scene);
    for (int k = 0; k < 5; ++k) {
      Q q(7);
      for (int i = 0; i < 3; ++i) q[i] = random.Uniform(-0.3, 0.3);
      const Eigen::Quaterniond turn = random.UnitQuat();
      q[3] = turn.w(), q[4] = turn.x(), q[5] = turn.y(), q[6] = turn.z();
      const Result result = solver.Solve(q);
      ++asked;
      if (result.status == Status::kUnsolved) continue;
      ++solved;
      EXPECT_GT(DeepestPoint(scene, result.q, random), -1e-4) << kind << " " << k;
    }
  }
  EXPECT_GE(solved, asked - 3);
}

}  // namespace
}  // namespace mjcf_pdg::test
