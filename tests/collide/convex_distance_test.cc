// Our own distances of convex geoms, against MuJoCo's and by their definition.
#include "collide/convex/convex_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ccd/motion_bound.h"
#include "ccd/separation.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
using Answer = ConvexDistance::Answer;

// ---- The simplex ----

// The least norm over a fine grid of barycentric coordinates of the corners.
double LeastNorm(const std::vector<Vector3d>& x) {
  constexpr int kCells = 60;
  const std::size_t corners = x.size();
  double least = kFar;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= (corners > 1 ? kCells - i : 0); ++j) {
      for (int k = 0; k <= (corners > 2 ? kCells - i - j : 0); ++k) {
        const double weights[] = {1.0 * i / kCells, 1.0 * j / kCells, 1.0 * k / kCells,
                                  1.0 - 1.0 * (i + j + k) / kCells};
        if (corners < 4 && weights[3] > 1e-9) continue;
        Vector3d mean = Vector3d::Zero();
        for (std::size_t c = 0; c < corners; ++c) mean += weights[c] * x[c];
        least = std::min(least, mean.norm());
      }
    }
  }
  return least;
}

TEST(SimplexTest, FindsTheNearestPointOfAnyHull) {
  Random rng(1);
  int of_size[5] = {};
  for (int trial = 0; trial < 400; ++trial) {
    Simplex simplex;
    std::vector<Vector3d> x;
    const int corners = 1 + trial % 4;
    const Vector3d middle = rng.InBox(0.3);
    double diameter = 0.0;
    for (int k = 0; k < corners; ++k) {
      const Vector3d p2 = rng.InBox(3.0);
      x.push_back(middle + rng.InBox(1.0));
      simplex.Add({x.back(), x.back() + p2, p2});
      diameter = std::max(diameter, 2.0 * (x.back() - middle).norm());
    }
    simplex.KeepClosestSubSimplex();
    ++of_size[simplex.size()];
    const double least = LeastNorm(x);
    if (simplex.size() == 4) {
      EXPECT_LT(least, diameter / 60.0);
      continue;
    }
    const Vector3d nearest = simplex.Nearest().x;
    EXPECT_LE(nearest.norm(), least + 1e-12);
    EXPECT_GT(nearest.norm(), least - diameter / 60.0);
    for (const Vector3d& corner : x) {  // by definition: no corner is on the near side
      EXPECT_GE(corner.dot(nearest), nearest.squaredNorm() - 1e-9);
    }
    EXPECT_NEAR((simplex.Nearest().p1 - simplex.Nearest().p2 - nearest).norm(), 0.0, 1e-12);
  }
  for (int size = 1; size <= 4; ++size) EXPECT_GT(of_size[size], 10) << size;
}

TEST(SimplexTest, SurvivesCornersWithoutExtent) {
  const Vector3d a(0.3, -0.2, 0.5), along(1.0, 2.0, -1.0);
  for (int corners = 2; corners <= 4; ++corners) {
    Simplex point, line;
    for (int k = 0; k < corners; ++k) {
      point.Add({a, a, Vector3d::Zero()});
      line.Add({a + k * along, a + k * along, Vector3d::Zero()});
    }
    point.KeepClosestSubSimplex();
    line.KeepClosestSubSimplex();
    EXPECT_NEAR((point.Nearest().x - a).norm(), 0.0, 1e-12);
    const double t = std::clamp(-a.dot(along) / along.squaredNorm(), 0.0, corners - 1.0);
    EXPECT_NEAR(line.Nearest().x.norm(), (a + t * along).norm(), 1e-9);
  }
}

// ---- Distances ----

class ConvexDistanceTest : public MujocoTest {
 protected:
  struct Pair {
    explicit Pair(const std::string& xml)
        : scene(Scene::FromString(xml)),
          model(scene.tables().query_model),
          posed(&model),
          convex(scene.tables()) {}

    Answer Ask(double cutoff) { return convex.Ask(posed, 0, cutoff, gap); }
    double MuJoCo(double cutoff) {
      const KeptPair& pair = scene.tables().pairs[0];
      return mj_geomDistance(&model, posed.data(), pair.geom1, pair.geom2, cutoff, nullptr);
    }

    // By its last answer. A plane has no core that it could be deep in.
    bool CoresAreApart() const {
      const KeptPair& pair = scene.tables().pairs[0];
      return model.geom_type[pair.geom1] == mjGEOM_PLANE ||
             gap.distance > -CoreRadius(model, pair.geom1) - CoreRadius(model, pair.geom2);
    }

    Scene scene;
    mjModel model;
    PosedModel posed;
    ConvexDistance convex;
    SignedGap gap;
  };

  // Poses of a free geom near one that rests, of every two types: several, one after the other.
  template <typename Visit>
  void AlongMotions(int poses, const Visit& visit) {
    for (const int type1 : ConvexTypes()) {
      for (const int type2 : ConvexTypes()) {
        if (type1 == mjGEOM_PLANE) continue;
        SCOPED_TRACE(TypeName(type1) + " on " + TypeName(type2));
        for (int motion = 0; motion < 6; ++motion) {
          Pair pair(
              TwoGeomXml({.first = RandomShape(type1, rng_), .second = RandomShape(type2, rng_)}));
          VectorXd q = RandomConfiguration(pair.scene, rng_, 0.4);
          for (int k = 0; k < poses; ++k) {
            Integrate(pair.scene.tables(), q, 0.03 * rng_.Normals(6), q);
            pair.posed.Pose(q);
            visit(pair);
          }
        }
      }
    }
  }
  Random rng_{7};
};

TEST_F(ConvexDistanceTest, IsMuJoCosWhereCoresAreApart) {
  int near = 0, apart = 0, overlapping = 0;
  AlongMotions(20, [&](Pair& pair) {
    const double truth = pair.MuJoCo(10.0);
    const Answer answer = pair.Ask(kFar);
    apart += truth > 1e-6;
    ASSERT_NE(answer, Answer::kBeyond);
    if (answer != Answer::kNear) return;
    near += truth > 1e-6;
    const SignedGap& gap = pair.gap;
    if (pair.CoresAreApart()) {
      EXPECT_NEAR(gap.distance, truth, 1e-6);
      overlapping += truth < -1e-6;
    }
    EXPECT_NEAR(gap.n.norm(), 1.0, 1e-12);
    EXPECT_NEAR(gap.n.dot(gap.p2 - gap.p1), gap.distance, 1e-9);
    EXPECT_NEAR((gap.p2 - gap.p1).norm(), std::abs(gap.distance), 1e-9);
  });
  EXPECT_GT(apart, 2000);
  EXPECT_GT(near, 0.99 * apart) << "hardly any are left to MuJoCo";
  EXPECT_GT(overlapping, 30) << "planes, and round cores";
}

// What it remembers of the poses before changes nothing but the time.
TEST_F(ConvexDistanceTest, DoesNotDependOnThePosesBefore) {
  int compared = 0;
  AlongMotions(15, [&](Pair& pair) {
    const Answer answer = pair.Ask(kFar);
    const double distance = pair.gap.distance;
    ConvexDistance fresh(pair.scene.tables());
    SignedGap gap;
    if (fresh.Ask(pair.posed, 0, kFar, gap) != Answer::kNear || answer != Answer::kNear) return;
    ++compared;
    EXPECT_NEAR(distance, gap.distance, 2e-9 + 2e-6 * std::abs(distance));
  });
  EXPECT_GT(compared, 2000);
}

TEST_F(ConvexDistanceTest, TellsWhetherGeomsAreBeyondACutoff) {
  int beyond = 0, near = 0;
  AlongMotions(15, [&](Pair& pair) {
    const double truth = pair.MuJoCo(10.0);
    for (const double cutoff : {0.0, 0.9 * truth, 1.1 * truth, 0.05}) {
      if (std::abs(truth - cutoff) < 1e-6 || truth < 1e-6) continue;
      const Answer answer = pair.Ask(cutoff);
      if (answer == Answer::kUnknown) continue;
      EXPECT_EQ(answer, truth < cutoff ? Answer::kNear : Answer::kBeyond) << truth << " " << cutoff;
      ++(answer == Answer::kNear ? near : beyond);
    }
  });
  EXPECT_GT(beyond, 1000);
  EXPECT_GT(near, 1000);
}

// By definition: moved apart by the depth along the normal the geoms touch, and along no other
// direction do they part sooner.
TEST_F(ConvexDistanceTest, OverlapsAreTheLeastThatParts) {
  int overlapping = 0, met = 0;
  AlongMotions(15, [&](Pair& pair) {
    const KeptPair& kept = pair.scene.tables().pairs[0];
    if (pair.MuJoCo(10.0) > -1e-6) return;
    ++overlapping;
    ASSERT_EQ(pair.Ask(kFar), Answer::kNear);
    const SignedGap& gap = pair.gap;
    EXPECT_NEAR((gap.p1 - gap.p2 + gap.distance * gap.n).norm(), 0.0, 1e-9);
    auto parts_at = [&](const Vector3d& n) {
      return -Separation(pair.scene.tables()).Distance(pair.posed, kept.geom1, kept.geom2, n);
    };
    const double depth = -gap.distance;
    EXPECT_NEAR(parts_at(gap.n), depth, 1e-9 + 1e-4 * depth);
    met += std::abs(parts_at(gap.n) - depth) <= 1e-9 + 2e-6 * depth;
    for (int k = 0; k < 300; ++k) {
      const Vector3d beside = k % 2 == 0 ? Vector3d(0, 0, 0) : gap.n;
      const Vector3d n = (beside + rng_.InBox(std::pow(0.1, k % 7))).normalized();
      EXPECT_GE(parts_at(n), depth - 1e-9) << n.transpose();
    }
  });
  EXPECT_GT(overlapping, 300);
  EXPECT_GT(met, 0.995 * overlapping) << "of hardly any the two bounds of the depth differ";
}

}  // namespace
}  // namespace mjcf_pdg::test
