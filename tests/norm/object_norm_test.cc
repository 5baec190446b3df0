// Bodies here are clouds of points with masses (tests/support/point_masses.h), so that σ can be
// checked as what it means.
#include "mjcf_pdg/object_norm.h"

#include <gmock/gmock.h>

#include <cmath>

#include "model/kinematics.h"
#include "tests/support/point_masses.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class ObjectNormTest : public MujocoTest {
 protected:
  Random rng_{31};
};

double Sigma(const Scene& scene, const VectorXd& q_in, const VectorXd& q,
             Metric metric = Metric::kSequential) {
  ObjectNorm norm(scene, metric, ToVector(q_in));
  return norm.Sigma(ToVector(q));
}

std::string Single(const std::string& joint) { return "<body @pose>" + joint + "@points</body>"; }

TEST_F(ObjectNormTest, SequentialNormIsTheSumOfDisplacementsJointByJoint) {
  for (int trial = 0; trial < 40; ++trial) {
    const Scene scene = Scene::FromString(PointMassXml(kForest, rng_));
    const VectorXd q_in = RandomConfiguration(scene, rng_), q = RandomConfiguration(scene, rng_);
    const double expected = SequentialByPoints(scene, q_in, q);
    EXPECT_NEAR(Sigma(scene, q_in, q), expected, 1e-8 * expected);
    // The same along the way from base to terminal, each joint after those above it.
    Points points(scene);
    VectorXd stage = q_in;
    double along = 0.0;
    for (const JointEntry& joint : scene.tables().joints) {
      const VectorXd next = OneJointMoved(joint, stage, q);
      along += points.MeanSquare(points.At(stage), points.At(next));
      stage = next;
    }
    EXPECT_NEAR(along, expected, 1e-8 * expected);
  }
}

TEST_F(ObjectNormTest, DisplacementNormIsTheMeanSquaredDisplacementOfAllMass) {
  for (int trial = 0; trial < 40; ++trial) {
    const Scene scene = Scene::FromString(PointMassXml(kForest, rng_));
    const VectorXd q_in = RandomConfiguration(scene, rng_), q = RandomConfiguration(scene, rng_);
    Points points(scene);
    const double expected = points.MeanSquare(points.At(q_in), points.At(q));
    EXPECT_NEAR(Sigma(scene, q_in, q, Metric::kDisplacement), expected, 1e-8 * expected);
  }
}

TEST_F(ObjectNormTest, AnotherRootCarriesItsWholeTreeAndTurnsPathJointsRound) {
  const std::string xml = PointMassXml(kForest, rng_);
  for (const auto& [root, top] :
       {std::pair("torso", "base"), std::pair("left", "base"), std::pair("hand", "base"),
        std::pair("plate", "base"), std::pair("right", "base"), std::pair("tip", "one"),
        std::pair("mast", "two")}) {
    const Scene scene = Scene::FromString(xml, {.movable = {}, .root = root});
    const int root_id = mj_name2id(scene.model(), mjOBJ_BODY, root);
    const int top_id = mj_name2id(scene.model(), mjOBJ_BODY, top);
    for (int trial = 0; trial < 10; ++trial) {
      const VectorXd q_in = RandomConfiguration(scene, rng_), q = RandomConfiguration(scene, rng_);
      const double expected = RootByPoints(scene, root_id, top_id, q_in, q);
      EXPECT_NEAR(Sigma(scene, q_in, q), expected, 1e-8 * expected) << root;
    }
  }
}

// Whatever else has a term of its own, the joints of the top body and their armature included.
TEST_F(ObjectNormTest, TheRootLinksPoseIsOnePart) {
  const Scene scene = Scene::FromString(
      "<mujoco><worldbody><body name='base'><joint name='slide' type='slide' axis='1 0 0'/>"
      "<joint name='turn' axis='0 0 1'/><geom size='.1'/>"
      "<body name='link' pos='.3 0 0'><joint name='elbow' axis='0 0 1'/><geom size='.1'/>"
      "</body></body></worldbody></mujoco>",
      {.root = "link", .armature = 0.5});
  ObjectNorm norm(scene, Metric::kSequential, {0.0, 0.0, 0.0});
  const std::vector<double> q = {0.1, 0.2, 0.3};
  std::vector<std::string> names;
  double sum = 0.0;
  for (const NormPart& part : norm.Parts(q)) {
    names.push_back(part.name);
    sum += part.sigma;
  }
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("root", "elbow"));
  EXPECT_NEAR(sum, norm.Sigma(q), 1e-14);
}

// What armature adds to σ, by hand: 4 a sin²(Δ/2)/M for a hinge or a ball turned by Δ, a Δ²/M for a
// slide, nothing for a free joint.
double ByArmature(const Scene& scene, const VectorXd& q_in, const VectorXd& q, double armature) {
  double sum = 0.0, mass = 0.0;
  for (const JointEntry& joint : scene.tables().joints) {
    if (joint.type == mjJNT_FREE) continue;
    const double delta = q[joint.qadr] - q_in[joint.qadr];
    if (joint.type == mjJNT_SLIDE) {
      sum += delta * delta;
    } else if (joint.type == mjJNT_HINGE) {
      sum += 4.0 * std::pow(std::sin(delta / 2), 2);
    } else {
      const double cosine = q_in.segment<4>(joint.qadr).dot(q.segment<4>(joint.qadr));  // of Δ/2
      sum += 4.0 * (1.0 - cosine * cosine);
    }
  }
  for (int b = 1; b < scene.model()->nbody; ++b) {
    if (scene.tables().body_moves[b]) mass += scene.model()->body_mass[b];
  }
  return armature * sum / mass;
}

TEST_F(ObjectNormTest, ArmatureIsAddedToEveryJointWhateverTheMetricAndRoot) {
  for (int trial = 0; trial < 20; ++trial) {
    const std::string xml = PointMassXml(kForest, rng_);
    const double armature = rng_.Uniform(0.01, 2.0);
    for (const char* root : {"", "hand", "tip", "mast"}) {
      for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
        const Scene plain = Scene::FromString(xml, {.root = root});
        const Scene heavy = Scene::FromString(xml, {.root = root, .armature = armature});
        const VectorXd q_in = RandomConfiguration(plain, rng_),
                       q = RandomConfiguration(plain, rng_);
        const double added = ByArmature(plain, q_in, q, armature);
        const double expected = Sigma(plain, q_in, q, metric) + added;
        EXPECT_GT(added, 0.0);
        EXPECT_NEAR(Sigma(heavy, q_in, q, metric), expected, 1e-8 * expected) << root;
      }
    }
  }
}

TEST_F(ObjectNormTest, TheModelsOwnArmatureIsTakenWhereItIsAskedFor) {
  const std::string xml = R"(<mujoco><worldbody><body><joint armature="0.4"/>
      <inertial mass="2" pos=".5 0 0" diaginertia=".1 .1 .1"/></body></worldbody></mujoco>)";
  const Scene plain = Scene::FromString(xml);
  const Scene own = Scene::FromString(xml, {.model_armature = true});
  const Scene both = Scene::FromString(xml, {.armature = 0.2, .model_armature = true});
  const VectorXd q_in = VectorXd::Zero(1), q = VectorXd::Constant(1, 0.7);
  const double s = 4.0 * std::pow(std::sin(0.35), 2) / 2.0;  // over the mass
  EXPECT_NEAR(Sigma(plain, q_in, q), 0.6 * s, 1e-12);
  EXPECT_NEAR(Sigma(own, q_in, q), 1.0 * s, 1e-12);
  EXPECT_NEAR(Sigma(both, q_in, q), 1.2 * s, 1e-12);
  for (const double bad : {-1e-9, 1001.0, std::nan("")})
    EXPECT_THROW(Scene::FromString(xml, {.armature = bad}), Error);
}

TEST_F(ObjectNormTest, ATopBodyAsRootGivesThePlainFormula) {
  const std::string xml = PointMassXml(kForest, rng_);
  const Scene plain = Scene::FromString(xml);
  for (const char* root : {"base", "one", "two"}) {
    const Scene scene = Scene::FromString(xml, {.movable = {}, .root = root});
    const VectorXd q_in = RandomConfiguration(scene, rng_), q = RandomConfiguration(scene, rng_);
    EXPECT_NEAR(Sigma(scene, q_in, q), Sigma(plain, q_in, q), 1e-12) << root;
    ObjectNorm norm(scene, Metric::kSequential, ToVector(q_in));
    int roots = 0;
    for (const NormPart& part : norm.Parts(ToVector(q))) roots += part.name == "root";
    EXPECT_EQ(roots, 1) << root;
  }
}

TEST_F(ObjectNormTest, ASingleFreeBodyIsEquationOne) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><body><freejoint/>
      <inertial mass="2.5" pos="0 0 0" diaginertia=".3 .4 .6"/></body></worldbody></mujoco>)");
  const VectorXd q_in = ToEigen(scene.DefaultQpos());
  for (int trial = 0; trial < 20; ++trial) {
    const VectorXd q = RandomConfiguration(scene, rng_);
    const Vector3d Q = q.segment<3>(4), t = q.head<3>();
    const double eq1 =
        4 / 2.5 * (0.3 * Q[0] * Q[0] + 0.4 * Q[1] * Q[1] + 0.6 * Q[2] * Q[2]) + t.squaredNorm();
    EXPECT_NEAR(Sigma(scene, q_in, q), eq1, 1e-14);
    EXPECT_NEAR(Sigma(scene, q_in, q, Metric::kDisplacement), eq1, 1e-13);
  }
}

TEST_F(ObjectNormTest, JointFormulasHoldInClosedForm) {
  // One point of mass 3 at distance .5 from a hinge or ball, 2 of 5 kg on a slide.
  const char point[] = "<inertial mass='3' pos='.5 0 0' diaginertia='1e-9 1e-9 1e-9'/>";
  auto scene = [&](const std::string& joint) {
    return Scene::FromString("<mujoco><worldbody><body>" + joint + point +
                             "</body></worldbody></mujoco>");
  };
  const VectorXd zero = VectorXd::Zero(1), one = VectorXd::Ones(1);
  EXPECT_NEAR(Sigma(scene("<joint type='slide'/>"), zero, one), 1.0, 1e-12);
  const double chord = 2 * std::sin(0.5) * 0.5;
  EXPECT_NEAR(Sigma(scene("<joint/>"), zero, one), chord * chord, 1e-8);
  VectorXd from(4), turned(4), twisted(4);
  from << 1, 0, 0, 0;
  turned << std::cos(0.5), 0, std::sin(0.5), 0;
  twisted << std::cos(0.5), std::sin(0.5), 0, 0;  // about the point's own direction
  EXPECT_NEAR(Sigma(scene("<joint type='ball'/>"), from, turned), chord * chord, 1e-8);
  EXPECT_NEAR(Sigma(scene("<joint type='ball'/>"), from, twisted), 0.0, 1e-8);
  EXPECT_NEAR(Sigma(scene("<joint/>"), zero, 2 * mjPI * one), 0.0, 1e-15);
}

TEST_F(ObjectNormTest, ItIsZeroForEqualConfigurationsAndPositiveForOthers) {
  const std::string xml = PointMassXml(kForest, rng_);
  for (const char* root : {"", "hand"}) {
    const Scene scene = Scene::FromString(xml, {.movable = {}, .root = root});
    for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
      const VectorXd q_in = RandomConfiguration(scene, rng_);
      EXPECT_NEAR(Sigma(scene, q_in, q_in, metric), 0.0, 1e-28);
      for (int i = 0; i < scene.dof(); ++i) {
        VectorXd q;
        Integrate(scene.tables(), q_in, 1e-3 * VectorXd::Unit(scene.dof(), i), q);
        EXPECT_GT(Sigma(scene, q_in, q, metric), 1e-10) << "dof " << i;
      }
    }
  }
}

TEST_F(ObjectNormTest, ItIsSymmetricForASingleJointButNotForTwo) {
  for (const char* joint : {"<joint type='slide' @axis/>", "<joint @axis/>",
                            "<joint type='ball' @axis/>", "<freejoint/>"}) {
    const Scene scene = Scene::FromString(PointMassXml(Single(joint), rng_));
    for (int trial = 0; trial < 10; ++trial) {
      const VectorXd a = RandomConfiguration(scene, rng_), b = RandomConfiguration(scene, rng_);
      EXPECT_NEAR(Sigma(scene, a, b), Sigma(scene, b, a), 1e-12) << joint;
    }
  }
  const Scene forest = Scene::FromString(PointMassXml(kForest, rng_));
  const VectorXd a = RandomConfiguration(forest, rng_), b = RandomConfiguration(forest, rng_);
  EXPECT_GT(std::abs(Sigma(forest, a, b) - Sigma(forest, b, a)), 1e-3);
  EXPECT_NEAR(Sigma(forest, a, b, Metric::kDisplacement),
              Sigma(forest, b, a, Metric::kDisplacement), 1e-12);
}

TEST_F(ObjectNormTest, ARigidMotionOfTheWholeWorldChangesNothing) {
  const std::string inner = Single("<joint @axis/><joint type='ball' @axis/>") +
                            Single("<joint type='slide' @axis/><joint type='slide' @axis/>");
  Random again(77), once_more(77);
  const Scene here = Scene::FromString(PointMassXml("<body>" + inner + "</body>", again));
  const Scene there = Scene::FromString(
      PointMassXml("<body pos='3 -2 1' quat='.4 .1 -.8 .5'>" + inner + "</body>", once_more));
  const VectorXd a = RandomConfiguration(here, rng_), b = RandomConfiguration(here, rng_);
  for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
    EXPECT_NEAR(Sigma(here, a, b, metric), Sigma(there, a, b, metric), 1e-12);
  }
  const Scene free = Scene::FromString(PointMassXml(
      "<body><freejoint/>@points<body @pose><joint @axis/>@points</body></body>", rng_));
  const Eigen::Quaterniond turn = rng_.UnitQuat();
  const Vector3d shift = rng_.InBox(2);
  auto moved = [&](VectorXd q) {
    q.head<3>() = turn * q.head<3>() + shift;
    const Eigen::Quaterniond quat = turn * Eigen::Quaterniond(q[3], q[4], q[5], q[6]);
    q.segment<4>(3) << quat.w(), quat.x(), quat.y(), quat.z();
    return q;
  };
  const VectorXd c = RandomConfiguration(free, rng_), d = RandomConfiguration(free, rng_);
  for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
    EXPECT_NEAR(Sigma(free, c, d, metric), Sigma(free, moved(c), moved(d), metric), 1e-12);
  }
}

TEST_F(ObjectNormTest, PartsAddUpAndAreNamed) {
  const std::string xml = PointMassXml(kForest, rng_);
  for (const char* root : {"", "hand", "base", "two"}) {
    const Scene scene = Scene::FromString(xml, {.movable = {}, .root = root});
    for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
      const VectorXd q_in = RandomConfiguration(scene, rng_), q = RandomConfiguration(scene, rng_);
      ObjectNorm norm(scene, metric, ToVector(q_in));
      double sum = 0.0;
      for (const NormPart& part : norm.Parts(ToVector(q))) sum += part.sigma;
      EXPECT_NEAR(sum, norm.Sigma(ToVector(q)), 1e-12);
    }
  }
  const Scene arm = Scene::FromString(ArmXml(), {.movable = {}, .root = "fore"});
  ObjectNorm norm(arm, Metric::kSequential, arm.DefaultQpos());
  std::vector<std::string> names;
  for (const NormPart& part : norm.Parts(arm.DefaultQpos())) names.push_back(part.name);
  EXPECT_THAT(names, ::testing::ElementsAre("root", "shoulder", "reach", "wrist"));
}

TEST_F(ObjectNormTest, OnlyBodiesThatCanMoveWeigh) {
  const std::string xml = PointMassXml(kForest, rng_);
  const VectorXd base = RandomConfiguration(Scene::FromString(xml), rng_);
  for (const char* root : {"", "torso", "plate"}) {  // frozen roots: nothing more to carry
    const Scene scene = Scene::FromString(xml, {.movable = {"left", "two"}, .root = root});
    const VectorXd q_in = RandomConfiguration(scene, rng_, 0.5, ToVector(base));
    const VectorXd q = RandomConfiguration(scene, rng_, 0.5, ToVector(base));
    const double expected = SequentialByPoints(scene, q_in, q);
    EXPECT_NEAR(Sigma(scene, q_in, q), expected, 1e-8 * expected) << root;
  }
  const Scene hand = Scene::FromString(xml, {.movable = {"left"}, .root = "hand"});
  const VectorXd q_in = RandomConfiguration(hand, rng_), q = RandomConfiguration(hand, rng_);
  const double expected = RootByPoints(hand, mj_name2id(hand.model(), mjOBJ_BODY, "hand"),
                                       mj_name2id(hand.model(), mjOBJ_BODY, "base"), q_in, q);
  EXPECT_NEAR(Sigma(hand, q_in, q), expected, 1e-8 * expected);
}

TEST_F(ObjectNormTest, QuaternionsOfAnyLengthAndSignMeanTheirRotation) {
  const Scene scene = Scene::FromString(PointMassXml(kForest, rng_));
  const VectorXd q_in = RandomConfiguration(scene, rng_), q = RandomConfiguration(scene, rng_);
  VectorXd q_in_scaled = q_in, q_scaled = q;
  q_in_scaled.segment<4>(3) *= 3.0;
  q_scaled.segment<4>(3) *= -0.2;
  q_in_scaled.segment<4>(8) *= -1.0;
  q_scaled.segment<4>(8) *= 7.0;
  for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
    EXPECT_NEAR(Sigma(scene, q_in_scaled, q_scaled, metric), Sigma(scene, q_in, q, metric), 1e-12);
  }
}

// Appendix B: six special points ±√(λ_i/2) d_i about the centre, with D's eigenvalues λ_i, see the
// same squared distance as a set of six vertices, S²/6 = σ.
TEST_F(ObjectNormTest, MetricSOfAppendixBIsTheNormOfAVertexSet) {
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::Matrix<double, 3, 6> vertices;
    std::string geoms;
    for (int i = 0; i < 6; ++i) {
      vertices.col(i) = rng_.InBox(0.5);
      geoms += "<geom size='2e-5' mass='1' pos='" + Join(vertices.col(i).data(), 3) + "'/>";
    }
    const Scene scene = Scene::FromString("<mujoco><worldbody><body><freejoint/>" + geoms +
                                          "</body></worldbody></mujoco>");
    const VectorXd q_in = ToEigen(scene.DefaultQpos()), q = RandomConfiguration(scene, rng_);
    const Vector3d center = vertices.rowwise().mean();
    const Eigen::Matrix<double, 3, 6> spread = vertices.colwise() - center;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> D(spread * spread.transpose());
    const Eigen::Quaterniond turn(q[3], q[4], q[5], q[6]);
    double S_squared = 0.0;
    for (int i = 0; i < 6; ++i) {
      const double reach = std::sqrt(D.eigenvalues()[i % 3] / 2);
      const Vector3d s = center + (i < 3 ? reach : -reach) * D.eigenvectors().col(i % 3);
      S_squared += (turn * s + q.head<3>() - s).squaredNorm();
    }
    EXPECT_NEAR(Sigma(scene, q_in, q), S_squared / 6, 1e-8);
  }
}

TEST_F(ObjectNormTest, BadConfigurationsAreRefused) {
  const Scene scene = Scene::FromString(ArmXml());
  EXPECT_THROW(ObjectNorm(scene, Metric::kSequential, {1, 2}), Error);
  ObjectNorm norm(scene, Metric::kSequential, scene.DefaultQpos());
  EXPECT_THROW(norm.Sigma({0, 0, 0, NAN}), Error);
  EXPECT_THROW(norm.Parts({}), Error);
}

}  // namespace
}  // namespace mjcf_pdg::test
