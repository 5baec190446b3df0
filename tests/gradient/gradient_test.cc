// Gradients against closed forms and against central differences of converged optima.
#include "mjcf_pdg/gradient.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "gradient/converged_optimum.h"
#include "mjcf_pdg/pdg.h"
#include "tests/equality/equality_models.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Q = std::vector<double>;
using Ending = ConvergedOptimum::Ending;

class GradientTest : public MujocoTest {};

// That answers keep in scenes of this size: the tolerance less tuning::accuracy::kDistanceJitter
// times 0.1 m [m].
constexpr double kOverlap = 0.4e-6;

MatrixXd AsMatrix(const Gradient& gradient, int nv) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  if (gradient.q.empty()) return {};
  return Eigen::Map<const RowMajor>(gradient.q.data(), nv, nv);
}

Gradient GradientOf(const Scene& scene, const Q& q_in, const Options& options = {}) {
  Solver solver(scene, options);
  return Differentiator(scene, options).At(q_in, solver.Solve(std::span<const double>(q_in)));
}

// ---- Closed forms ----

constexpr const char* kBall = R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 1"><joint type="slide" axis="0 0 1"/><geom size="0.1"/></body>
</worldbody></mujoco>)";

TEST_F(GradientTest, ABallInAFloorStaysOnIt) {
  const Scene scene = Scene::FromString(kBall);
  const Gradient gradient = GradientOf(scene, {-0.95});
  ASSERT_EQ(gradient.sigma.size(), 1u);
  EXPECT_NEAR(gradient.sigma[0], -2.0 * (0.05 - kOverlap), 1e-9) << "σ = (-0.9 - overlap - q_in)²";
  ASSERT_EQ(gradient.q.size(), 1u);
  EXPECT_NEAR(gradient.q[0], 0.0, 1e-9);
  EXPECT_FALSE(gradient.active_set_changes);
}

// σ = (4/M) I sin²(Δ/2) with I about the hinge, and the free angle does not depend on q_in.
TEST_F(GradientTest, AHingedRodComesToTheSameAngle) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 0.3"><joint type="hinge" axis="0 1 0"/>
<inertial pos="0.5 0 0" mass="2" diaginertia="0.1 0.2 0.3"/>
<geom size="0.1" pos="0.5 0 0"/></body></worldbody></mujoco>)");
  const double free_angle = std::asin((0.2 + kOverlap) / 0.5), q_in = free_angle + 0.4;
  const Gradient gradient = GradientOf(scene, {q_in});
  const double inertia = 0.2 + 2.0 * 0.25;
  ASSERT_EQ(gradient.sigma.size(), 1u);
  EXPECT_NEAR(gradient.sigma[0], 4.0 / 2.0 * inertia * std::sin(0.2) * std::cos(0.2), 1e-8);
  EXPECT_NEAR(gradient.q.at(0), 0.0, 1e-8);
}

// A free ball in a floor keeps its place along the floor and its rotation.
TEST_F(GradientTest, AFreeBallMovesAlongAFloorAsItIsMoved) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body><freejoint/><geom size="0.1"/></body></worldbody></mujoco>)");
  const Gradient gradient = GradientOf(scene, {0.3, -0.2, 0.06, 0.8, 0.0, 0.6, 0.0});
  MatrixXd wanted = MatrixXd::Identity(6, 6);
  wanted(2, 2) = 0.0;
  EXPECT_LT((AsMatrix(gradient, 6) - wanted).lpNorm<Eigen::Infinity>(), 1e-7);
  EXPECT_NEAR(gradient.sigma[2], -2.0 * (0.04 - kOverlap), 1e-9);
  EXPECT_FALSE(gradient.active_set_changes);
}

// A frozen joint that carries the obstacle enters through the contact alone.
TEST_F(GradientTest, AFrozenObstacleCarriesTheAnswerAlong) {
  SceneOptions options;
  options.movable = {"ball"};
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
<body name="lift"><joint type="slide" axis="0 0 1"/><geom type="box" size="1 1 0.1" pos="0 0 -0.1"/></body>
<body name="ball" pos="0 0 1"><joint type="slide" axis="0 0 1"/><geom size="0.1"/></body>
</worldbody></mujoco>)",
                                        options);
  const Gradient gradient = GradientOf(scene, {0.02, -0.93});
  const double gap = 0.05 - kOverlap;
  EXPECT_NEAR(gradient.sigma[0], 2.0 * gap, 1e-8);
  EXPECT_NEAR(gradient.sigma[1], -2.0 * gap, 1e-8);
  const MatrixXd wanted = (MatrixXd(2, 2) << 1.0, 0.0, 1.0, 0.0).finished();
  EXPECT_LT((AsMatrix(gradient, 2) - wanted).lpNorm<Eigen::Infinity>(), 1e-8);
}

// ---- What a gradient says where there is little to say ----

TEST_F(GradientTest, AFreeConfigurationStays) {
  const Scene scene = Scene::FromString(kBall);
  const Gradient far = GradientOf(scene, {0.0});
  EXPECT_EQ(far.sigma, Q{0.0});
  EXPECT_EQ(far.q, Q{1.0});
  EXPECT_FALSE(far.active_set_changes);
  EXPECT_TRUE(GradientOf(scene, {-0.9 + 1e-6}).active_set_changes) << "about to touch";
}

TEST_F(GradientTest, AnUnsolvedResultHasNone) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 1"><joint type="slide" axis="0 0 1" range="-2 -1"/><geom size="0.1"/></body>
</worldbody></mujoco>)");
  const Gradient gradient = GradientOf(scene, {-1.5});
  EXPECT_TRUE(gradient.sigma.empty() && gradient.q.empty());
}

TEST_F(GradientTest, ABallThatIsAboutToTouchAWallIsFlagged) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<geom type="plane" size="1 1 1" zaxis="-1 0 0" pos="0.5 0 0"/>
<body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><geom size="0.1"/></body>
</worldbody></mujoco>)");
  EXPECT_FALSE(GradientOf(scene, {0.2, 0.05}).active_set_changes);
  EXPECT_TRUE(GradientOf(scene, {0.4 - 2e-6, 0.05}).active_set_changes);
  EXPECT_TRUE(GradientOf(scene, {0.4 + 2e-6, 0.05}).active_set_changes) << "the wall hardly holds";
  EXPECT_FALSE(GradientOf(scene, {0.45, 0.05}).active_set_changes);
}

TEST_F(GradientTest, BadInputIsRefused) {
  const Scene scene = Scene::FromString(kBall);
  Options options;
  options.rest = 0.001;
  EXPECT_NE(ErrorOf([&] { Differentiator{scene, options}; }).find("rest"), std::string::npos);
  Differentiator differentiator(scene);
  Solver solver(scene);
  Result result = solver.Solve(std::span<const double>(Q{-1.0}));
  EXPECT_THROW(differentiator.At(Q{0.0, 1.0}, result), Error);
  result.q = {std::nan("")};
  EXPECT_THROW(differentiator.At(Q{-1.0}, result), Error);
}

// ---- Central differences ----

// What one kind of random problems came to.
struct Tally {
  int solved = 0, good = 0, flagged = 0, wrong_unflagged = 0, without_q = 0, unstable = 0;
  std::vector<double> sigma_errors, q_errors;

  void Add(const Tally& other) {
    for (int Tally::* count : {&Tally::solved, &Tally::good, &Tally::flagged,
                               &Tally::wrong_unflagged, &Tally::without_q, &Tally::unstable}) {
      this->*count += other.*count;
    }
    sigma_errors.insert(sigma_errors.end(), other.sigma_errors.begin(), other.sigma_errors.end());
    q_errors.insert(q_errors.end(), other.q_errors.begin(), other.q_errors.end());
  }
};

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * (static_cast<double>(values.size()) - 1))];
}

std::string Describe(const Tally& t) {
  const auto errors = [](const std::vector<double>& e) {
    char text[100];
    std::snprintf(text, sizeof text, "median %.1e p95 %.1e max %.1e", Quantile(e, 0.5),
                  Quantile(e, 0.95), Quantile(e, 1.0));
    return std::string(text);
  };
  return std::to_string(t.solved) + " solved, " + std::to_string(t.good) + " within 1e-4, " +
         std::to_string(t.flagged) + " flagged, " + std::to_string(t.wrong_unflagged) +
         " wrong and not flagged, " + std::to_string(t.without_q) + " without dq, " +
         std::to_string(t.unstable) + " where differences do not converge; sigma " +
         errors(t.sigma_errors) + "; q " + errors(t.q_errors);
}

// Optima of one scene at neighbouring q_in, by the same steps to full precision.
class Reference {
 public:
  Reference(const Scene& scene, const Options& options)
      : scene_(scene),
        options_(options),
        all_(WithAllJoints(scene.tables())),
        work_(scene_.tables(), options_),
        optimum_(work_, all_) {}

  int nv() const { return all_.n; }

  // Differences of re-solved answers about q_in; false where one of them does not converge.
  bool Differentiate(const VectorXd& q_in, const VectorXd& q, VectorXd& sigma, MatrixXd& by) {
    VectorXd start = q;
    if (!Converge(q_in, start)) return false;
    sigma.resize(all_.n);
    by.resize(all_.n, all_.n);
    for (const JointEntry& joint : all_.joints) {
      for (int k = 0; k < joint.ndof; ++k) {
        if (!Column(q_in, start, joint, k, sigma, by)) return false;
      }
    }
    return true;
  }

 private:
  bool Converge(const VectorXd& q_in, VectorXd& q) {
    work_.Begin(q_in);
    const bool converged = optimum_.Run(q) == Ending::kConverged;
    q = optimum_.q();
    return converged;
  }

  bool Column(const VectorXd& q_in, const VectorXd& start, const JointEntry& joint, int k,
              VectorXd& sigma, MatrixXd& by) {
    const int dof = joint.col + k;
    const bool frozen = scene_.tables().column_of_dof[dof] < 0;
    const double h = joint.Slides(k) ? 1e-5 * all_.size : 1e-6;
    VectorXd q[2], at, dq = VectorXd::Zero(all_.n);
    double s[2] = {};
    for (const int side : {0, 1}) {
      dq[dof] = side == 0 ? h : -h;
      Integrate(all_, q_in, dq, at);
      q[side] = start;
      if (frozen) Integrate(all_, start, dq, q[side]);
      if (!Converge(at, q[side])) return false;
      s[side] = work_.norm.Sigma(q[side]);
    }
    sigma[dof] = (s[0] - s[1]) / (2.0 * h);
    Difference(all_, q[1], q[0], dq);
    by.col(dof) = dq / (2.0 * h);
    return true;
  }

  Scene scene_;
  Options options_;
  SceneTables all_;
  Workspace work_;
  ConvergedOptimum optimum_;
};

// Strictly inside the limits: at a limit, where clamping would put it, σ has a kink.
VectorXd Inside(const SceneTables& tables, VectorXd q, Random& rng) {
  ClampToLimits(tables, q);
  for (const JointEntry& joint : tables.joints) {
    if (!joint.limited || joint.type == mjJNT_BALL) continue;
    const double least = rng.Uniform(0.001, 0.03) * (joint.hi - joint.lo);
    q[joint.qadr] = std::clamp(q[joint.qadr], joint.lo + least, joint.hi - least);
  }
  return q;
}

using Draw = VectorXd (*)(const Scene& scene, Random& rng);

// About a random keyframe: 0.15 rad and 0.045 m.
VectorXd NearKeyframe(const Scene& scene, Random& rng) {
  const SceneTables all = WithAllJoints(scene.tables());
  VectorXd dq = 0.15 * rng.Normals(all.n), q;
  for (const JointEntry& joint : all.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      if (joint.Slides(k)) dq[joint.col + k] *= 0.3;
    }
  }
  const int keys = static_cast<int>(scene.KeyNames().size());
  Integrate(all, ToEigen(scene.KeyQpos(rng.Index(keys))), dq, q);
  return Inside(all, q, rng);
}

VectorXd Anywhere(const Scene& scene, Random& rng) {
  return Inside(scene.tables(), RandomConfiguration(scene, rng, 0.15), rng);
}

// Solves random problems and holds their gradients against differences: an error is the norm of the
// difference over that of the reference, in metres and radians; a dq/dq_in below 0.01 counts as
// such.
Tally Compare(const Scene& scene, const Options& options, int count, Random& rng, Draw draw) {
  Tally tally;
  Options plain = options;
  plain.report_lower_bound = false;
  Solver solver(scene, plain);
  Differentiator differentiator(scene, plain);
  Reference reference(scene, plain);
  VectorXd sigma;
  MatrixXd by;
  for (int k = 0; k < count; ++k) {
    const VectorXd q_in = draw(scene, rng);
    const Q given = ToVector(q_in);
    const Result result = solver.Solve(std::span<const double>(given));
    if (result.status != Status::kSolved) continue;
    ++tally.solved;
    const Gradient gradient = differentiator.At(given, result);
    tally.flagged += gradient.active_set_changes;
    tally.without_q += gradient.q.empty();
    bool good = false;
    const bool converged = reference.Differentiate(q_in, ToEigen(result.q), sigma, by);
    if (converged) {
      const double off = (ToEigen(gradient.sigma) - sigma).norm() / sigma.norm();
      tally.sigma_errors.push_back(off);
      if (!gradient.q.empty()) {
        const double q_off =
            (AsMatrix(gradient, reference.nv()) - by).norm() / std::max(by.norm(), 0.01);
        tally.q_errors.push_back(q_off);
        good = off <= 1e-4 && q_off <= 1e-4;
      }
    } else {
      ++tally.unstable;
    }
    tally.good += good;
    tally.wrong_unflagged += converged && !good && !gradient.active_set_changes;
  }
  return tally;
}

void ExpectGood(const Tally& tally, int least_solved, const std::string& what) {
  std::printf("%s: %s\n", what.c_str(), Describe(tally).c_str());
  EXPECT_GE(tally.solved, least_solved) << what;
  EXPECT_GE(tally.good, 0.95 * tally.solved) << what << ": " << Describe(tally);
  EXPECT_LE(tally.wrong_unflagged, 0.01 * tally.solved) << what << ": " << Describe(tally);
}

// long_tests asks for more.
int Many(int count) { return std::getenv("MJCF_PDG_LONG_TESTS") ? 20 * count : count; }

const std::string kModels = MJCF_PDG_MODEL_DIR;

TEST_F(GradientTest, AgreesWithDifferencesOnOurRobots) {
  Random rng(24);
  Tally all;
  for (const char* name : {"puma/puma_car", "hand/hand_bottle", "figure/figure_bench"}) {
    const Scene scene = Scene::FromFile(kModels + "/" + name + ".xml");
    const Tally tally = Compare(scene, {}, Many(16), rng, NearKeyframe);
    std::printf("%s: %s\n", name, Describe(tally).c_str());
    all.Add(tally);
  }
  ExpectGood(all, 30, "robots");
}

TEST_F(GradientTest, AgreesWithDifferencesOnPairsOfPrimitives) {
  Random rng(25);
  Tally all;
  for (const int first : ConvexTypes()) {
    for (const int second : ConvexTypes()) {
      if (first == mjGEOM_PLANE) continue;  // may not move
      Tally of_pair;
      for (int k = 0; k < Many(5); ++k) {
        const Scene scene = Scene::FromString(
            TwoGeomXml({.first = RandomShape(first, rng), .second = RandomShape(second, rng)}));
        of_pair.Add(Compare(scene, {}, 2, rng, Anywhere));
      }
      all.Add(of_pair);
    }
  }
  ExpectGood(all, 100, "primitives");
}

TEST_F(GradientTest, AgreesWithDifferencesOnRandomRobots) {
  Random rng(26);
  Tally all;
  for (int k = 0; k < Many(80); ++k) {
    const Scene scene =
        Scene::FromString(RandomRobotXml(rng, {.bodies = 5, .free_base = k % 2 == 0}));
    all.Add(Compare(scene, {}, 3, rng, Anywhere));
  }
  ExpectGood(all, 60, "random robots");
}

TEST_F(GradientTest, AgreesWithDifferencesUnderEveryOption) {
  Random rng(27);
  Options displacement, clearance;
  displacement.metric = Metric::kDisplacement;
  clearance.clearance = 0.01;
  SceneOptions armature, frozen;
  armature.armature = 0.05;
  armature.model_armature = true;
  frozen.fixed = {"b1"};
  struct Case {
    const char* what;
    SceneOptions scene;
    Options options;
  };
  const Case cases[] = {{"displacement", {}, displacement},
                        {"clearance", {}, clearance},
                        {"armature", armature, {}},
                        {"armature, displacement", armature, displacement},
                        {"frozen", frozen, {}},
                        {"frozen, displacement", frozen, displacement}};
  for (const Case& one : cases) {
    Tally tally;
    for (int k = 0; k < 60; ++k) {
      const std::string xml = RandomRobotXml(rng, {.bodies = 5, .free_base = k % 2 == 0});
      try {
        const Scene scene = Scene::FromString(xml, one.scene);
        tally.Add(Compare(scene, one.options, 2, rng, Anywhere));
      } catch (const Error& error) {
        ADD_FAILURE() << error.what();
      }
    }
    ExpectGood(tally, 20, one.what);
  }
}

TEST_F(GradientTest, AgreesWithDifferencesFromAnotherRoot) {
  Random rng(28);
  SceneOptions options;
  options.root = "palm";
  const Scene scene = Scene::FromFile(kModels + "/hand/hand_bottle.xml", options);
  ExpectGood(Compare(scene, {}, 6, rng, NearKeyframe), 4, "palm as root");
}

// Closed loops and couplings; q_in is near where they hold.
TEST_F(GradientTest, AgreesWithDifferencesWhereEqualitiesHold) {
  Random rng(29);
  const Draw four_bar = [](const Scene&, Random& random) {
    const double a = random.Uniform(-1.2, 1.2);
    return VectorXd(Eigen::Vector3d(a, -a, a) + 0.05 * random.Normals(3));
  };
  ExpectGood(Compare(Scene::FromString(kFourBar), {}, 60, rng, four_bar), 10, "four-bar linkage");
  ExpectGood(Compare(Scene::FromString(kParallelJaw), {}, 60, rng, Anywhere), 10, "parallel jaws");
}

// Triangle meshes have no smooth distance here: σ's derivative is that at the answer as it is.
TEST_F(GradientTest, ExactMeshesHaveTheDerivativeOfSigmaAlone) {
  SceneOptions options;
  options.exact_mesh = true;
  const Scene scene = Scene::FromFile(kModels + "/rigid/ring_on_post.xml", options);
  int solved = 0;
  for (int key = 0; key < 5 && key < static_cast<int>(scene.KeyNames().size()); ++key) {
    const Q q_in = scene.KeyQpos(key);
    Solver solver(scene);
    const Result result = solver.Solve(std::span<const double>(q_in));
    if (result.status != Status::kSolved) continue;
    ++solved;
    const Gradient gradient = Differentiator(scene).At(q_in, result);
    EXPECT_EQ(gradient.sigma.size(), 6u);
    EXPECT_TRUE(gradient.q.empty() && gradient.active_set_changes);
    // The envelope theorem by hand: σ of the answer, with the other end moved.
    const SceneTables& tables = scene.tables();
    for (int dof = 0; dof < 6; ++dof) {
      double s[2];
      for (const int side : {0, 1}) {
        VectorXd at;
        Integrate(tables, ToEigen(q_in), (side == 0 ? 1e-6 : -1e-6) * VectorXd::Unit(6, dof), at);
        s[side] = ObjectNorm(scene, Metric::kSequential, ToVector(at)).Sigma(result.q);
      }
      EXPECT_NEAR(gradient.sigma[dof], (s[0] - s[1]) / 2e-6, 1e-7);
    }
  }
  EXPECT_GE(solved, 1);
}

}  // namespace
}  // namespace mjcf_pdg::test
