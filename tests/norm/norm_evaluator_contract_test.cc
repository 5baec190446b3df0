// What norm_evaluator.h promises of what is added to the diagonal of H.
#include "norm/norm_evaluator.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class NormEvaluatorContractTest : public MujocoTest {};

// A heavy slide and a light, short hinge: what is added to one says nothing of the other.
TEST_F(NormEvaluatorContractTest, WhatIsAddedToTheDiagonalIsSmallForEachKind) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body><joint type="slide"/><geom size=".1" mass="1e4"/></body>
    <body pos="2 0 0"><joint axis="0 1 0"/><geom size=".01" mass="1e3" pos=".01 0 0"/></body>
    </worldbody></mujoco>)");
  NormEvaluator norm(scene.tables(), Metric::kSequential);
  const VectorXd q = VectorXd::Zero(2);
  norm.SetReference(q);
  VectorXd r;
  MatrixXd J, H;
  norm.Linearize(q, r, J);
  norm.InnerProduct(J, H);
  for (int k = 0; k < 2; ++k) {
    const double square = J.col(k).squaredNorm();
    EXPECT_GT(H(k, k), square);
    EXPECT_LT(H(k, k), (1.0 + 3e-6) * square) << k;
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
