// Planning along equality constraints: couplings that hold along straight motions, and loops and
// curved couplings, which motions follow.
#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

#include "plan/configuration_space.h"
#include "plan/planners.h"
#include "tests/plan/plan_test_support.h"

namespace mjcf_pdg {
namespace {

class EveryPlannerFollows : public EveryPlanner {};
INSTANTIATE_TEST_SUITE_P(Three, EveryPlannerFollows,
                         testing::Values("birrt", "birrt-r", "birrt-pdg"), [](const auto& planner) {
                           std::string name = planner.param;
                           std::erase(name, '-');
                           return name;
                         });

// A hand whose fingers open together must close them to pass a gap; a dial turns as it goes.
std::string CoupledHand(const std::string& coupling = "0 -1 0 0 0") {
  return R"(<mujoco><worldbody>
    <geom type="box" size=".1 2 .5" pos="0 -2.24 0"/><geom type="box" size=".1 2 .5" pos="0 2.24 0"/>
    <body name="dial" pos="0 5 0"><joint name="dial" axis="0 0 1"/><geom size=".1"/></body>
    <body name="hand">
      <joint name="x" type="slide" axis="1 0 0" range="-2 2" limited="true"/>
      <joint name="y" type="slide" axis="0 1 0" range="-1 1" limited="true"/>
      <geom type="cylinder" size=".1 .1"/>
      <body pos="0 .1 0"><joint name="left" axis="0 0 1" range="-90 90" limited="true"/>
        <geom type="capsule" size=".03" fromto="0 0 0 0 .25 0"/></body>
      <body pos="0 -.1 0"><joint name="right" axis="0 0 1" range="-90 90" limited="true"/>
        <geom type="capsule" size=".03" fromto="0 0 0 0 -.25 0"/></body>
    </body></worldbody>
    <tendon><fixed name="turned"><joint joint="dial" coef="1"/><joint joint="x" coef="-1"/></fixed></tendon>
    <equality><joint name="fingers" joint1="right" joint2="left" polycoef=")" +
         coupling + R"("/><tendon tendon1="turned"/></equality></mujoco>)";
}

TEST_P(EveryPlannerFollows, CouplingsAllTheWay) {
  const Scene scene = Scene::FromString(CoupledHand());
  const std::vector<double> start = {-1, -1, 0.1, 0.2, -0.2}, goal = {1, 1, -0.1, -0.3, 0.3};
  PlanOptions options = With(GetParam());
  options.max_samples = 200000;  // birrt needs 20,000 in the median of 24 seeds, 83,000 at most
  const Path path = Plan(scene, start, goal, options);
  ExpectFree(scene, path, start, goal);  // the verifier's *free* is that equalities hold, too
  const auto closed = [](const std::vector<double>& q) { return std::abs(q[3]) > 0.8; };
  EXPECT_TRUE(std::any_of(path.q.begin(), path.q.end(), closed));
}

// A crank, a coupler and a rocker, on a carriage that must pass a gap: the rocker must lean for it.
constexpr char kFourBar[] = R"(<mujoco><compiler angle="radian"/>
  <default><geom type="capsule" size=".01"/><joint axis="0 1 0"/></default>
  <worldbody>
    <geom type="box" size=".1 .5 .5" pos="0 0 -.52"/><geom type="box" size=".1 .5 .5" pos="0 0 .72"/>
    <body name="carriage">
      <joint name="x" type="slide" axis="1 0 0" range="-1 1"/>
      <joint name="z" type="slide" axis="0 0 1" range="-.1 .1"/>
      <geom fromto="0 0 0 .3 0 0"/>
      <body name="crank"><joint name="crank" range="-2 2"/><geom fromto="0 .03 0 0 .03 .1"/>
        <body name="coupler" pos="0 0 .1"><joint name="coupler" range="-3 3"/><geom fromto="0 .06 0 .3 .06 0"/></body></body>
      <body name="rocker" pos=".25 0 -.1"><joint name="rocker" range="-3 3"/><geom fromto="0 .03 0 .05 .03 .2"/></body>
    </body></worldbody>
  <equality><connect name="pin" body1="coupler" body2="rocker" anchor=".3 0 0"/></equality></mujoco>)";

TEST_P(EveryPlannerFollows, ALoopAllTheWay) {
  const Scene scene = Scene::FromString(kFourBar);
  Solver solver(scene);
  const std::vector<double> start = solver.Solve({-.7, 0, 0.3, 0, -.6}).q,
                            goal = solver.Solve({.7, 0, 0.3, 0, -.6}).q;
  const Path path = Plan(scene, start, goal, With(GetParam()));
  ExpectFree(scene, path, start, goal);  // the verifier's *free* is that the loop is closed, too
  ASSERT_GE(path.corners.size(), 3u);    // round something
  EXPECT_EQ(path.corners.front(), 0);
  EXPECT_EQ(path.corners.back() + 1, static_cast<int>(path.q.size()));
  EXPECT_GT(path.q.size(), 2 * path.corners.size());  // and bent
}

TEST(PlanFollowsTest, ACurvedCoupling) {
  const Scene scene = Scene::FromString(CoupledHand("0 -1 .1 0 0"));
  Solver solver(scene);
  const std::vector<double> start = solver.Solve({-1, -1, 0.1, 0.2, -0.2}).q,
                            goal = solver.Solve({1, 1, -0.1, -0.3, 0.3}).q;
  for (const char* planner : {"birrt-r", "birrt-pdg"}) {
    const Path path = Plan(scene, start, goal, With(planner));
    ExpectFree(scene, path, start, goal);
    EXPECT_GT(path.q.size(), path.corners.size());
  }
}

TEST(PlanFollowsTest, EveryNamedPlannerHoldsCouplings) {
  const Scene scene = Scene::FromString(CoupledHand());
  const std::vector<double> open = {-1, -1, 0, 0.2, -0.2}, moved = {-0.5, -0.5, 0.3, -0.3, 0.3};
  int planned = 0;
  for (const std::string& name : PlannerNames()) {
    SCOPED_TRACE(name);
    ExpectFree(scene, Plan(scene, open, moved, With(name)), open, moved);
    ++planned;
  }
  EXPECT_GE(planned, 23);
}

// Motions lead as far as the loop can be followed, and not from one way to close it to the other.
TEST(PlanFollowsTest, MotionsAlongALoop) {
  const Scene scene = Scene::FromString(kFourBar);
  Solver solver(scene);
  const auto at = [&](const std::vector<double>& q) {
    const Result result = solver.Solve(q);
    EXPECT_NE(result.status, Status::kUnsolved);
    return ToEigen(result.q);
  };
  const VectorXd open = at({-.7, 0, -.5, .5, -.4}), leaning = at({-.6, 0, 1.2, -1.2, .3});
  const ConfigurationSpace space(scene, {}, open, leaning);
  EXPECT_FALSE(space.straight());
  std::vector<ConfigurationSpace::Piece> pieces;
  const auto append = [&pieces](const ConfigurationSpace::Piece& piece) {
    pieces.push_back(piece);
    return true;
  };
  ASSERT_TRUE(space.Follow(open, leaning, append));
  EXPECT_EQ(pieces.back().q, leaning);
  EXPECT_EQ(pieces.back().t, 1.0);
  VectorXd before = open, q;
  double t = 0.0;
  for (const ConfigurationSpace::Piece& piece : pieces) {
    EXPECT_GT(piece.t, t);
    for (int k = 0; k <= 100; ++k) {
      q = before + 0.01 * k * (piece.q - before);  // slides and hinges
      EXPECT_TRUE(space.HoldsEqualities(q));
    }
    space.Interpolate(open, leaning, 0.5 * (t + piece.t), q);  // of the same curve
    EXPECT_LT((q - 0.5 * (before + piece.q)).norm(), 1e-4);
    before = piece.q;
    t = piece.t;
  }
  EXPECT_GT(pieces.size(), 50u);

  // The same crank with the rocker folded under the coupler: the other way to close the loop.
  VectorXd folded = ToEigen({-.7, 0, -.5, 1.69, -2.27});
  ASSERT_TRUE(space.Project(folded));
  ASSERT_LT(folded[4], -2.0);
  EXPECT_FALSE(space.Follow(open, folded, append));
}

// A bend that is odd about the middle of the motion holds there whether it is followed or not.
TEST(PlanFollowsTest, ACouplingThatIsOdd) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body><joint name="a"/><geom size=".1"/></body><body pos="1 0 0"><joint name="b"/><geom size=".1"/></body>
    </worldbody><equality><joint joint1="b" joint2="a" polycoef="0 0 0 1 0"/></equality></mujoco>)");
  const VectorXd from = ToEigen({-.5, -.125}), to = ToEigen({.5, .125});
  const ConfigurationSpace space(scene, {}, from, to);
  int pieces = 0;
  EXPECT_TRUE(space.Follow(from, to, [&](const ConfigurationSpace::Piece& piece) {
    ++pieces;
    return space.HoldsEqualities(piece.q);
  }));
  EXPECT_GT(pieces, 100);
}

TEST(PlanFollowsTest, EndsOffTheCouplingsAreRepaired) {
  const Scene scene = Scene::FromString(CoupledHand());
  const Path path = Plan(scene, {-1, -1, 0, 0.4, 0}, {1, 0.9, 0, 0, 0}, With("birrt-pdg"));
  EXPECT_EQ(path.start.status, Status::kSolved);
  EXPECT_EQ(path.goal.status, Status::kSolved);
  ExpectFree(scene, path, path.start.q, path.goal.q);
}

}  // namespace
}  // namespace mjcf_pdg
