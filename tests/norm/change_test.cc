// Change and NormEvaluator::AddPull: the quadratic form between two configurations of which neither
// is q_in.
#include "norm/change.h"

#include "norm/norm_evaluator.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class ChangeTest : public MujocoTest {};

std::vector<std::string> Scenes() {
  return {ArmXml(), BallChainXml(false), TwoTreesXml(), OffCentreXml()};
}

TEST_F(ChangeTest, ItIsAntisymmetricAndItsDerivativeThatOfDifferences) {
  Random rng(41);
  for (const std::string& xml : Scenes()) {
    const Scene scene = Scene::FromString(xml);
    const SceneTables& tables = scene.tables();
    for (int trial = 0; trial < 10; ++trial) {
      const VectorXd a = RandomConfiguration(scene, rng), b = RandomConfiguration(scene, rng);
      VectorXd X, back, low, high, moved;
      MatrixXd D;
      Change(tables, a, b, X, &D);
      Change(tables, b, a, back, nullptr);
      EXPECT_LT((X + back).cwiseAbs().maxCoeff(), 1e-12);
      for (int k = 0; k < tables.n; ++k) {
        constexpr double kStep = 1e-6;
        VectorXd dq = VectorXd::Zero(tables.n);
        dq[k] = kStep;
        Integrate(tables, b, dq, moved);
        Change(tables, a, moved, high, nullptr);
        dq[k] = -kStep;
        Integrate(tables, b, dq, moved);
        Change(tables, a, moved, low, nullptr);
        const VectorXd slope = (high - low) / (2.0 * kStep);
        EXPECT_LT((slope - D.col(k)).cwiseAbs().maxCoeff(), 1e-7) << xml << " " << k;
      }
    }
  }
}

// Where the first configuration is q_in itself, the form is σ exactly, but for how a free joint
// turns about its centre of mass.
TEST_F(ChangeTest, ItIsSigmaFromTheReference) {
  Random rng(42);
  for (const std::string& xml : {ArmXml(), BallChainXml(false)}) {
    const Scene scene = Scene::FromString(xml);
    NormEvaluator norm(scene.tables(), Metric::kSequential);
    for (int trial = 0; trial < 20; ++trial) {
      const VectorXd a = RandomConfiguration(scene, rng), b = RandomConfiguration(scene, rng);
      norm.SetReference(a);
      VectorXd X, r;
      MatrixXd J;
      norm.Linearize(a, r, J);
      Change(scene.tables(), a, b, X, nullptr);
      EXPECT_NEAR((J * X).squaredNorm(), norm.Sigma(b), 1e-9 * (1.0 + norm.Sigma(b))) << xml;
    }
  }
}

// σ, J and H with pulls: by a sum, by differences, and for both kinds of blocks.
TEST_F(ChangeTest, PullsAddToSigmaAndItsDerivatives) {
  Random rng(43);
  for (const std::string& xml : Scenes()) {
    const Scene scene = Scene::FromString(xml);
    const SceneTables& tables = scene.tables();
    for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
      NormEvaluator norm(tables, metric);
      const VectorXd q_in = RandomConfiguration(scene, rng), to = RandomConfiguration(scene, rng);
      const VectorXd q = RandomConfiguration(scene, rng);
      norm.SetReference(q_in);
      VectorXd r, X, high, low, moved;
      MatrixXd B, J, H;
      norm.Linearize(norm.q_in(), r, B);
      const double alone = norm.Sigma(q);
      Change(tables, to, q, X, nullptr);
      norm.AddPull(to, 2.0 * B);
      norm.AddPull(to, B);
      const double pulled = norm.Sigma(q);
      EXPECT_NEAR(pulled, alone + 5.0 * (B * X).squaredNorm(), 1e-9 * pulled);
      norm.Linearize(q, r, J);
      ASSERT_EQ(J.rows(), norm.rows());
      for (int k = 0; k < tables.n; ++k) {
        constexpr double kStep = 1e-6;
        VectorXd dq = VectorXd::Zero(tables.n);
        dq[k] = kStep;
        Integrate(tables, q, dq, moved);
        norm.Residual(moved, high);
        dq[k] = -kStep;
        Integrate(tables, q, dq, moved);
        norm.Residual(moved, low);
        EXPECT_LT(((high - low) / (2.0 * kStep) - J.col(k)).cwiseAbs().maxCoeff(), 1e-6) << xml;
      }
      norm.InnerProduct(J, H);
      const MatrixXd full = J.transpose() * J;
      for (const ColumnRange& block : norm.blocks()) {
        const auto part = [&](const MatrixXd& m) {
          return m.block(block.begin, block.begin, block.size, block.size);
        };
        EXPECT_LT((part(H) - part(full)).cwiseAbs().maxCoeff(), 1e-6 * (1.0 + full.norm())) << xml;
      }
      norm.SetReference(q_in);
      EXPECT_EQ(norm.Sigma(q), alone) << "SetReference removes pulls";
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
