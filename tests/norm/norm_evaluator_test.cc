#include "norm/norm_evaluator.h"

#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

struct Case {
  std::string xml, root;
  Metric metric = Metric::kSequential;
  double armature = 0.0;
};

std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const std::string& xml : {ArmXml(), BallChainXml(false), TwoTreesXml(), OffCentreXml()}) {
    cases.push_back({xml, ""});
    cases.push_back({xml, "", Metric::kDisplacement});
  }
  cases.push_back({ArmXml(), "tool"});
  cases.push_back({BallChainXml(false), "b"});
  cases.push_back({TwoTreesXml(), "a2"});
  cases.push_back({TwoTreesXml(), "b"});
  cases.push_back({OffCentreXml(), "tip"});
  cases.push_back({OffCentreXml(), "arm"});
  for (const std::string& xml : {BallChainXml(false), TwoTreesXml(), OffCentreXml()}) {
    cases.push_back({xml, "", Metric::kSequential, 0.3});
    cases.push_back({xml, "", Metric::kDisplacement, 0.3});
  }
  cases.push_back({TwoTreesXml(), "b", Metric::kSequential, 0.3});
  return cases;
}

class NormEvaluatorTest : public MujocoTest {
 protected:
  Scene MakeScene(const Case& c) {
    return Scene::FromString(c.xml, {.root = c.root, .armature = c.armature});
  }
  VectorXd Near(const Scene& scene, const VectorXd& q_in, double size) {
    VectorXd dq = rng_.Normals(scene.dof()), q;
    dq *= size / dq.lpNorm<Eigen::Infinity>();
    Integrate(scene.tables(), q_in, dq, q);
    return q;
  }
  Random rng_{41};
};

TEST_F(NormEvaluatorTest, SigmaIsTheSquaredLengthOfTheResidualAndTermsAddUp) {
  for (const Case& c : Cases()) {
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric);
    norm.SetReference(RandomConfiguration(scene, rng_));
    const VectorXd q = RandomConfiguration(scene, rng_);
    VectorXd r, r_linearized;
    MatrixXd J;
    norm.Residual(q, r);
    norm.Linearize(q, r_linearized, J);
    EXPECT_EQ(r, r_linearized);
    EXPECT_EQ(r.size(), norm.rows());
    EXPECT_EQ(J.cols(), scene.dof());
    EXPECT_DOUBLE_EQ(norm.Sigma(q), r.squaredNorm());
    double sum = 0.0;
    for (const NormTerm& term : norm.terms()) sum += norm.TermSigma(term, r);
    EXPECT_NEAR(sum, norm.Sigma(q), 1e-14);
  }
}

TEST_F(NormEvaluatorTest, JacobianIsTheFiniteDifferenceOfTheResidual) {
  for (const Case& c : Cases()) {
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric);
    for (int trial = 0; trial < 10; ++trial) {
      norm.SetReference(RandomConfiguration(scene, rng_));
      const VectorXd q = RandomConfiguration(scene, rng_);
      VectorXd r, r_plus, r_minus;
      MatrixXd J;
      norm.Linearize(q, r, J);
      constexpr double kStep = 1e-6;
      for (int i = 0; i < scene.dof(); ++i) {
        VectorXd plus, minus;
        Integrate(scene.tables(), q, kStep * VectorXd::Unit(scene.dof(), i), plus);
        Integrate(scene.tables(), q, -kStep * VectorXd::Unit(scene.dof(), i), minus);
        norm.Residual(plus, r_plus);
        norm.Residual(minus, r_minus);
        EXPECT_LT((J.col(i) - (r_plus - r_minus) / (2 * kStep)).norm(), 2e-9)
            << c.root << " dof " << i << " q_in " << Join(norm.q_in()) << " q " << Join(q);
      }
    }
  }
}

TEST_F(NormEvaluatorTest, HessianAtTheReferenceIsTheCurvatureOfSigma) {
  for (const Case& c : Cases()) {
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric);
    const VectorXd q_in = RandomConfiguration(scene, rng_);
    norm.SetReference(q_in);
    VectorXd r;
    MatrixXd J;
    norm.Linearize(q_in, r, J);
    EXPECT_LT(r.norm(), 1e-14);
    const MatrixXd H = J.transpose() * J;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(H).eigenvalues()[0], 0.0) << "not definite";
    for (int trial = 0; trial < 10; ++trial) {
      const VectorXd dq = rng_.Normals(scene.dof()).normalized();
      constexpr double kStep = 1e-4;
      VectorXd plus, minus;
      Integrate(scene.tables(), q_in, kStep * dq, plus);
      Integrate(scene.tables(), q_in, -kStep * dq, minus);
      const double curvature = (norm.Sigma(plus) + norm.Sigma(minus)) / (2 * kStep * kStep);
      EXPECT_NEAR(curvature, dq.dot(H * dq), 1e-6 * curvature + 1e-10);
    }
  }
}

// Where joints move no mass at all, H is still positive: by the same for all that turn, and for all
// that slide.
TEST_F(NormEvaluatorTest, TheInnerProductAddsALittleToEveryDof) {
  for (const Case& c : Cases()) {
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric);
    norm.SetReference(RandomConfiguration(scene, rng_));
    const int n = scene.dof();
    MatrixXd H = MatrixXd::Zero(n, n);
    norm.InnerProduct(MatrixXd::Zero(norm.rows(), n), H);
    EXPECT_EQ(H, MatrixXd(H.diagonal().asDiagonal()));
    double added[2] = {};
    for (const JointEntry& joint : scene.tables().joints) {
      for (int k = 0; k < joint.ndof; ++k) {
        double& of_kind = added[joint.Slides(k)];
        if (of_kind == 0.0) of_kind = H(joint.col + k, joint.col + k);
        EXPECT_EQ(H(joint.col + k, joint.col + k), of_kind);
        EXPECT_GT(of_kind, 0.0);
      }
    }
  }
}

// Eq. 28 in MuJoCo's tangent: m_j, ωᵀ I_j ω, and I_j for 2 dQ.
TEST_F(NormEvaluatorTest, PlainHessianIsBlockDiagonalAndOtherRootsCoupleJoints) {
  const Scene scene = MakeScene({OffCentreXml(), ""});
  NormEvaluator norm(scene.tables(), Metric::kSequential);
  const VectorXd q_in = RandomConfiguration(scene, rng_);
  norm.SetReference(q_in);
  VectorXd r;
  MatrixXd J;
  norm.Linearize(q_in, r, J);
  MatrixXd H = norm.total_mass() * J.transpose() * J;
  for (const NormTerm& term : norm.terms()) {
    const JointEntry& joint = scene.tables().joints[term.joint];
    auto block = H.block(joint.col, joint.col, joint.ndof, joint.ndof);
    if (joint.type == mjJNT_BALL) {
      EXPECT_LT((block - term.R_in.transpose() * term.inertia_W * term.R_in).norm(), 1e-12);
    } else {
      const double expected = joint.type == mjJNT_SLIDE ? term.mass : term.inertia;
      EXPECT_NEAR(block(0, 0), expected, 1e-12);
    }
    block.setZero();
  }
  EXPECT_EQ(H.norm(), 0.0);
  const Scene other = MakeScene({OffCentreXml(), "tip"});
  NormEvaluator rooted(other.tables(), Metric::kSequential);
  rooted.SetReference(q_in);
  rooted.Linearize(q_in, r, J);
  H = J.transpose() * J;
  EXPECT_GT(std::abs(H(0, 8)), 1e-3) << "the cart's slide and the tip's lift both move the tip";
}

TEST_F(NormEvaluatorTest, ATopBodyAsRootLeavesEverythingAsItIsWithoutRoot) {
  for (const char* root : {"a", "b"}) {
    const Scene plain_scene = MakeScene({TwoTreesXml(), ""});
    const Scene scene = MakeScene({TwoTreesXml(), root});
    NormEvaluator plain(plain_scene.tables(), Metric::kSequential);
    NormEvaluator rooted(scene.tables(), Metric::kSequential);
    const VectorXd q_in = RandomConfiguration(scene, rng_), q = Near(scene, q_in, 1.0);
    const VectorXd dq = 0.5 * rng_.Normals(scene.dof()).normalized();
    plain.SetReference(q_in);
    rooted.SetReference(q_in);
    EXPECT_EQ(rooted.Sigma(q), plain.Sigma(q));
    EXPECT_EQ(rooted.blocks().size(), plain.blocks().size()) << "H is block-diagonal";
    VectorXd out, expected;
    rooted.Retract(q, dq, out);
    plain.Retract(q, dq, expected);
    EXPECT_EQ(out, expected);
  }
}

TEST_F(NormEvaluatorTest, RetractMovesTheSequentialResidualExactlyAlongTheChart) {
  int moved = 0;
  for (const Case& c : Cases()) {
    if (!c.root.empty() || c.metric != Metric::kSequential) continue;
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric);
    for (int trial = 0; trial < 50; ++trial) {
      norm.SetReference(RandomConfiguration(scene, rng_));
      VectorXd q = Near(scene, norm.q_in(), 1.0), r, r_out, out;
      // Whole turns of a hinge do not matter.
      for (const JointEntry& joint : scene.tables().joints) {
        if (joint.type == mjJNT_HINGE) q[joint.qadr] += 2 * mjPI * (rng_.Index(3) - 1);
      }
      const VectorXd dq = 0.5 * rng_.Normals(scene.dof()).normalized();
      MatrixXd J;
      norm.Linearize(q, r, J);
      norm.Retract(q, dq, out);
      norm.Residual(out, r_out);
      EXPECT_LT((r_out - r - J * dq).norm(), 1e-12) << Join(norm.q_in()) << "\n" << Join(q);
      VectorXd way;
      Difference(scene.tables(), q, out, way);
      EXPECT_LT((way - dq).norm(), 0.5);  // no jump to another sheet
      ++moved;
    }
  }
  EXPECT_EQ(moved, 350);
}

TEST_F(NormEvaluatorTest, RetractIsIntegrateToFirstOrderForEveryMetric) {
  for (const Case& c : Cases()) {
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric);
    norm.SetReference(RandomConfiguration(scene, rng_));
    for (int trial = 0; trial < 10; ++trial) {
      const VectorXd q = RandomConfiguration(scene, rng_);
      const VectorXd dq = 1e-5 * rng_.Normals(scene.dof());
      VectorXd out, way;
      norm.Retract(q, dq, out);
      Difference(scene.tables(), q, out, way);
      EXPECT_LT((way - dq).norm(), 2e-8) << c.root;
    }
  }
}

TEST_F(NormEvaluatorTest, HugeStepsNeverLeaveTheSphereOfQuaternions) {
  for (const Case& c : Cases()) {
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric);
    for (int trial = 0; trial < 50; ++trial) {
      norm.SetReference(RandomConfiguration(scene, rng_));
      const VectorXd q = RandomConfiguration(scene, rng_);
      VectorXd out;
      norm.Retract(q, rng_.Uniform(0, 20) * rng_.Normals(scene.dof()), out);
      EXPECT_TRUE(out.allFinite());
      EXPECT_LT((Normalized(scene.tables(), out) - out).norm(), 1e-14);
      EXPECT_TRUE(std::isfinite(norm.Sigma(out)));
    }
  }
}

TEST_F(NormEvaluatorTest, HalfTurnsGiveFiniteResidualsJacobiansAndSteps) {
  for (const Case& c : Cases()) {
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric);
    for (const double offset : {-1e-12, 0.0, 1e-12, 1e-6}) {
      const VectorXd q_in = RandomConfiguration(scene, rng_);
      norm.SetReference(q_in);
      VectorXd turn = VectorXd::Zero(scene.dof()), q, r, out;
      for (const JointEntry& joint : scene.tables().joints) {
        if (joint.type != mjJNT_SLIDE) turn[joint.col + joint.ndof - 1] = mjPI + offset;
      }
      Integrate(scene.tables(), q_in, turn, q);
      MatrixXd J;
      norm.Linearize(q, r, J);
      EXPECT_TRUE(r.allFinite() && J.allFinite());
      for (const double size : {0.0, 1e-9, 0.1, 4.0}) {
        norm.Retract(q, size * rng_.Normals(scene.dof()), out);
        EXPECT_TRUE(out.allFinite());
        EXPECT_TRUE(std::isfinite(norm.Sigma(out)));
      }
    }
  }
}

// Sec. 3.2: q* = w dq* + q_c.
TEST_F(NormEvaluatorTest, ARotationTooFarIsCutShortAndTheTranslationWithIt) {
  const Scene body = Scene::FromString(R"(<mujoco><worldbody><body><freejoint/>
      <geom type="box" size=".3 .2 .1"/></body></worldbody></mujoco>)");
  NormEvaluator norm(body.tables(), Metric::kSequential);
  VectorXd q(7), dq(6), out, r, r_out;
  q << 0, 0, 0, 1, 0, 0, 0;
  norm.SetReference(q);
  MatrixXd J;
  norm.Linearize(q, r, J);
  int cut = 0;
  for (const double turn : {0.1, 1.0, 1.8, 2.0, 6.0, 100.0}) {
    dq << 0.3, 0, 0, 0, turn, 0;
    norm.Retract(q, dq, out);
    norm.Residual(out, r_out);
    const double w = out[0] / 0.3;
    EXPECT_GT(w, 0.0);
    EXPECT_LE(w, 1.0 + 1e-12);
    EXPECT_LT((r_out - (r + w * J * dq)).norm(), 1e-12) << turn;
    EXPECT_LE(out.tail<3>().norm(), 1.0);
    cut += w < 1.0;
  }
  EXPECT_EQ(cut, 3);
}

TEST_F(NormEvaluatorTest, AHalfTurnIsTheFarthestAHingeOrBallCanBe) {
  const Scene arm = MakeScene({ArmXml(), ""});
  NormEvaluator norm(arm.tables(), Metric::kSequential);
  norm.SetReference(VectorXd::Zero(4));
  VectorXd q = VectorXd::Zero(4);
  q[0] = mjPI;
  const double farthest = norm.Sigma(q);
  for (const double angle : {1.0, 3.0, 3.3, 5.0, 6.2, 9.0}) {
    q[0] = angle;
    EXPECT_LT(norm.Sigma(q), farthest);
    q[0] = angle + 2 * mjPI;
    const double a_turn_on = norm.Sigma(q);
    q[0] = angle;
    EXPECT_NEAR(norm.Sigma(q), a_turn_on, 1e-14);
  }
}

TEST_F(NormEvaluatorTest, AReferenceLeavesNothingOfTheOneBefore) {
  for (const Case& c : Cases()) {
    const Scene scene = MakeScene(c);
    NormEvaluator norm(scene.tables(), c.metric), fresh(scene.tables(), c.metric);
    const VectorXd q_in = RandomConfiguration(scene, rng_), q = RandomConfiguration(scene, rng_);
    norm.SetReference(RandomConfiguration(scene, rng_));
    norm.Sigma(q_in);
    norm.SetReference(q_in);
    fresh.SetReference(q_in);
    EXPECT_EQ(norm.Sigma(q), fresh.Sigma(q));
    EXPECT_EQ(norm.rows(), fresh.rows());
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
