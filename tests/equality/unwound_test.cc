// Whole turns that bring a joint nearer to where it was cost nothing, unless a coupling of joints
// counts them.
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "equality/equality_constraints.h"
#include "mjcf_pdg/scene.h"
#include "problem/workspace.h"

namespace mjcf_pdg::test {
namespace {

VectorXd Unwound(const std::string& equality, const VectorXd& q) {
  const Scene scene = Scene::FromString(
      "<mujoco><worldbody><body><joint name='a'/><geom size='.1'/></body>"
      "<body pos='1 0 0'><joint name='b'/><geom size='.1'/></body></worldbody>" +
      equality + "</mujoco>");
  const Options options;
  Workspace work(scene.tables(), options);
  work.Begin(VectorXd::Zero(2));
  VectorXd unwound;
  work.Unwound(q, unwound);
  return unwound;
}

std::string Coupled(const std::string& polynomial) {
  return "<equality><joint joint1='a' joint2='b' polycoef='" + polynomial + "'/></equality>";
}

TEST(UnwoundTest, JointsComeBackByWholeTurns) {
  const double turn = 2.0 * std::numbers::pi;
  const VectorXd q{{3.5, 7.0}};
  for (const std::string& free : {std::string(), Coupled("0 1")}) {
    const VectorXd both = free.empty() ? q : VectorXd{{7.0, 7.0}};
    EXPECT_TRUE(Unwound(free, both).isApprox(VectorXd{{both[0] - turn, both[1] - turn}}, 1e-12));
  }
}

TEST(UnwoundTest, NotWhereACouplingCountsThem) {
  const VectorXd q{{3.5, 7.0}};  // a is half of b, which a whole turn of each breaks
  EXPECT_EQ(Unwound(Coupled("0 .5"), q), q);
}

}  // namespace
}  // namespace mjcf_pdg::test
