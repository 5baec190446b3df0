// Branch and bound over joint space: what it proves holds, is within 1 % of what is found, and
// finds what descents do not.
#include "bound/joint_boxes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "model/island.h"
#include "tests/bound/bound_check.h"
#include "tests/support/paper_support.h"

namespace mjcf_pdg::test {
namespace {

class JointBoxesTest : public MujocoTest {};

Options AtMost(std::vector<std::string> without = {}) {
  Options options;
  options.effort = Effort::kMax;
  options.without = std::move(without);
  return options;
}

bool Closed(const Result& result) {
  return result.status == Status::kSolved &&
         result.sigma <= JointBoxes::kClosed * result.sigma_lower_bound;
}

std::string Geom(Random& rng, double size, double spread) {
  const Vector3d p = rng.InBox(spread);
  const Eigen::Quaterniond turn = rng.UnitQuat();
  const auto number = [&] { return std::to_string(size * rng.Uniform(0.5, 1.5)) + " "; };
  const char* const types[] = {"sphere", "capsule", "box", "cylinder", "ellipsoid"};
  return std::string("<geom type='") + types[rng.Index(5)] + "' size='" + number() + number() +
         number() + "' pos='" + Join(Eigen::VectorXd(p)) + "' quat='" + std::to_string(turn.w()) +
         " " + Join(Eigen::VectorXd(turn.vec())) + "'/>";
}

// Of up to three degrees of freedom, by `kind`; what moves is two geoms a body, what stands eight.
std::string RandomModel(Random& rng, int kind) {
  const std::string x = "<joint type='slide' axis='1 0 0'/>",
                    y = "<joint type='slide' axis='0 1 0'/>",
                    z = "<joint type='slide' axis='0 0 1'/>",
                    turn = "<joint axis='" + Join(Eigen::VectorXd(rng.UnitVector())) + "'/>";
  const auto body = [&](const std::string& inside) {
    return "<body pos='" + Join(Eigen::VectorXd(rng.InBox(0.2))) + "'>" + inside +
           Geom(rng, 0.1, 0.1) + Geom(rng, 0.1, 0.1);
  };
  std::string moving;
  switch (kind) {
    case 0:
      moving = body(x + y + z) + "</body>";
      break;
    case 1:
      moving = body(x + y + turn) + "</body>";
      break;
    case 2:
      moving = body(turn) + body(turn) +
               body("<joint axis='0 0 1' range='-1.5 2' limited='true'/>") +
               "</body></body></body>";
      break;
    case 3:
      moving = body("<joint type='ball'/>") + "</body>";
      break;
    default:
      moving = body(turn + z) + "</body>";
  }
  std::string standing;
  for (int k = 0; k < 8; ++k) standing += Geom(rng, 0.1, 0.5);
  return InWorld(standing + moving);
}

TEST_F(JointBoxesTest, WhatIsProvenHoldsAndClosesTheBracket) {
  Random rng(7);
  int tried = 0;
  for (int k = 0; k < 60; ++k) {
    const Scene scene = Scene::FromString(RandomModel(rng, k % 5));
    AtStart at(scene, RandomConfiguration(scene, rng, 0.3));
    if (at.Free(at.q_in)) continue;
    const double sampled = SearchFree(at, rng);
    const Result result = Solver(scene, AtMost()).Solve(ToVector(at.q_in));
    if (result.status != Status::kSolved) continue;
    ++tried;
    EXPECT_LE(result.sigma_lower_bound, result.sigma) << k;
    EXPECT_GE(1.05 * result.sigma_lower_bound, result.sigma) << k;
    EXPECT_LE(result.sigma_lower_bound, sampled) << k;
    EXPECT_LE(result.sigma, sampled * JointBoxes::kClosed) << k;
  }
  EXPECT_GE(tried, 20);
}

// With one descent, and what the boxes lead to.
TEST_F(JointBoxesTest, FindsWhatNoDescentFromTheInputFinds) {
  Random rng(11);
  const std::vector<std::string> descents = {"mirror", "noise", "hop", "anywhere"};
  int nearer = 0;
  for (int k = 0; k < 40; ++k) {
    const Scene scene = Scene::FromString(RandomModel(rng, k % 5));
    const std::vector<double> q_in = ToVector(RandomConfiguration(scene, rng, 0.3));
    std::vector<std::string> nor_boxes = descents;
    nor_boxes.push_back("boxes");
    const Result direct = Solver(scene, AtMost(nor_boxes)).Solve(q_in);
    const Result boxes = Solver(scene, AtMost(descents)).Solve(q_in);
    if (direct.status != Status::kSolved) continue;
    EXPECT_LE(boxes.sigma, 1.0001 * direct.sigma);
    EXPECT_TRUE(Closed(boxes)) << k;
    if (boxes.sigma > 0.99 * direct.sigma) continue;
    EXPECT_EQ(boxes.start, "boxes");
    ++nearer;
  }
  EXPECT_GE(nearer, 2);
}

// From a σ that is far too large down to the least, whatever the number of boxes between.
TEST_F(JointBoxesTest, BoxesAloneFindTheNearestWithoutAnyDescent) {
  Random rng(13);
  int tried = 0;
  for (int k = 0; k < 40; ++k) {
    const Scene scene = Scene::FromString(RandomModel(rng, k % 2 == 0 ? 3 : k % 5));
    const VectorXd q_in = RandomConfiguration(scene, rng, 0.3);
    const Options options = AtMost();
    const Result result = Solver(scene, options).Solve(ToVector(q_in));
    if (result.status != Status::kSolved || !Closed(result)) continue;
    Workspace work(scene.tables(), options);
    work.Begin(q_in);
    JointBoxes boxes(work);
    double nearest = 4.0 * result.sigma;
    ASSERT_TRUE(boxes.Begin(work.OverlapsAtInput(), nearest, 200'000));
    while (boxes.Search(nearest)) {
      nearest = work.norm.Sigma(boxes.nearer());
      EXPECT_LE(boxes.sigma_lower_bound(), result.sigma) << k;
    }
    if (nearest > JointBoxes::kClosed * boxes.sigma_lower_bound()) continue;  // boxes are spent
    ++tried;
    EXPECT_LE(nearest, 1.02 * result.sigma) << k;
    EXPECT_LE(boxes.sigma_lower_bound(), result.sigma) << k;
  }
  EXPECT_GE(tried, 10);
}

// A slider in a wall, and one behind it that could make room: the island of the first says nothing
// beyond the wall.
TEST_F(JointBoxesTest, WhatCouldMakeRoomIsNoObstacle) {
  std::string bodies = "<geom type='box' size='.1 1 1'/>";
  for (const char* x : {".16", ".37"}) {
    bodies += "<body pos='" + std::string(x) +
              " 0 0'><joint type='slide' axis='1 0 0'/><geom type='box' size='.1 .1 .1'/></body>";
  }
  const Scene scene = Scene::FromString(InWorld(bodies));
  const double other_way = 0.36 * 0.36 / 2;  // with half of the mass [m²]
  const auto proven = [&](const SceneTables& tables) {
    const Options options;
    Workspace work(tables, options);
    work.Begin(VectorXd::Zero(2));
    JointBoxes boxes(work);
    EXPECT_TRUE(boxes.Begin(work.OverlapsAtInput(), other_way, 10'000));
    double nearest = other_way;
    while (boxes.Search(nearest)) nearest = work.norm.Sigma(boxes.nearer());
    return std::sqrt(boxes.sigma_lower_bound());
  };
  const Island first(scene.tables(), MovableTrees(scene.tables()), {0});
  EXPECT_NEAR(proven(first.tables), 0.04 / std::sqrt(2), 1e-3);
  EXPECT_NEAR(proven(scene.tables()), std::sqrt((0.04 * 0.04 + 0.03 * 0.03) / 2), 1e-3);
}

// A bar on a ball that may turn by 0.2, at 0.14 to one side, and a small ball in it at 0.1: it
// parts at 0.167 from there. Farther to that side it would be free soonest, but beyond the limit.
TEST_F(JointBoxesTest, ALimitedBallIsProvenWithinItsLimit) {
  const Scene scene = Scene::FromString(
      InWorld("<geom size='.02' pos='.2985 -.02995 0'/><body><joint type='ball' range='0 .2' "
              "limited='true'/>"
              "<geom type='capsule' size='.03 .15' pos='.15 0 0' euler='0 1.5708 0'/></body>"));
  const Result result =
      Solver(scene, AtMost()).Solve(std::vector<double>{std::cos(0.07), 0, 0, -std::sin(0.07)});
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_LE(result.sigma_lower_bound, result.sigma);
  EXPECT_GE(1.05 * result.sigma_lower_bound, result.sigma);
}

TEST_F(JointBoxesTest, NothingIsProvenOfMoreDegreesOfFreedomOrOtherMetrics) {
  const std::string ball = "<geom size='.2'/><body pos='.1 0 0'>", end = "<geom size='.1'/></body>";
  const auto begins = [](const std::string& model, const Options& options) {
    const Scene scene = Scene::FromString(InWorld(model));
    Workspace work(scene.tables(), options);
    work.Begin(ToEigen(scene.DefaultQpos()));
    return JointBoxes(work).Begin(work.OverlapsAtInput(), 1.0, 100);
  };
  Options displacement;
  displacement.metric = Metric::kDisplacement;
  const std::string slide = "<joint type='slide'/>";
  EXPECT_TRUE(begins(ball + slide + end, {}));
  EXPECT_FALSE(begins(ball + slide + end, displacement));
  EXPECT_FALSE(begins(ball + "<freejoint/>" + end, {}));
}

}  // namespace
}  // namespace mjcf_pdg::test
