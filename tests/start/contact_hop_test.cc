// Hops: starts at the best answer with one contact decided anew.
#include <algorithm>
#include <cmath>

#include "tests/start/selector.h"

namespace mjcf_pdg::test {
namespace {

class ContactHopTest : public MujocoTest {};

constexpr Hop kAllHops[] = {Hop::kFromBest, Hop::kFromInput, Hop::kMirrored};

// In `best`, two fingers touch each other and a ball the floor. The bob touches nothing.
const std::string kThreeThings = World(R"(<geom type="plane" size="0 0 1"/>
    <body pos="0 0 1"><freejoint/><geom size=".02"/>
      <body pos="-.1 0 0"><joint axis="0 1 0"/><geom size=".1" pos="0 0 .3"/></body>
      <body pos=".1 0 0"><joint axis="0 1 0" range="-30 5"/><geom size=".1" pos="0 0 .3"/></body>
    </body>
    <body pos="3 0 .1"><joint type="slide" axis="1 0 0" range="-.5 .5"/>
      <joint type="slide" axis="0 0 1"/><geom size=".1"/></body>
    <body pos="6 0 3"><joint type="ball"/><geom size=".1" pos=".3 0 0"/></body>)");
constexpr int kFinger = 6, kBall = 8, kBob = 10, kDofs = 13;  // first dofs

struct Hopper : Selector {
  Hopper() : Selector(kThreeThings), best(work.problem().q_in) {
    VectorXd q_in, dq = VectorXd::Zero(kDofs);
    dq << 0.1, 0.2, -0.1, 0.1, -0.2, 0.3, 0.4, -0.1, 0.25, -0.05, 0.1, 0.2, 0.3;
    Integrate(scene.tables(), best, dq, q_in);
    work.Begin(q_in);
    Difference(scene.tables(), work.problem().q_in, best, to_best);
  }
  // The hop as a tangent at q_in.
  VectorXd Hopped(Hop hop, double sigma, mjcf_pdg::Random& noise) {
    VectorXd dq;
    const VectorXd q = ContactHop(best, sigma, hop, noise);
    EXPECT_LE(LimitExcess(scene.tables(), q), 1e-12);
    Difference(scene.tables(), work.problem().q_in, q, dq);
    return dq;
  }

  VectorXd best;
  VectorXd to_best;  // best ⊖ q_in
};

// A wrist may have turned by more than half a turn; what hops, turns back by twice as much as it
// has.
TEST_F(ContactHopTest, AHopLeavesFarTurnsOfOtherJointsAlone) {
  Selector p(World(R"(<geom type="box" size=".1 .1 .1"/>
      <body pos=".15 0 0"><joint type="slide" axis="1 0 0"/><joint axis="1 0 0"/>
        <geom size=".06"/></body>
      <body pos="2 0 0"><joint axis="0 0 1"/><geom size=".1"/></body>)"));
  VectorXd q_in = p.work.problem().q_in;
  q_in[2] = -3.0;
  p.work.Begin(q_in);
  VectorXd best = p.work.problem().q_in;
  best[0] = 0.01;
  best[1] = 2.0;
  best[2] = 2.5;
  mjcf_pdg::Random noise(3);
  int mirrored = 0;
  for (const Hop hop : kAllHops) {
    for (int k = 0; k < 20; ++k) {
      const VectorXd q = p.ContactHop(best, 0.01, hop, noise);
      EXPECT_NEAR(q[2], 2.5, 1e-12);
      if (hop != Hop::kMirrored) continue;
      EXPECT_NEAR(std::abs(q[1]), 2.0, 1e-12);
      mirrored += q[1] < 0.0;
    }
  }
  EXPECT_GT(mirrored, 5);
}

TEST_F(ContactHopTest, AHopMovesNothingButTheJointsBetweenTheBodiesOfOneContact) {
  Hopper p;
  VectorXd q_unchanged;
  Integrate(p.scene.tables(), p.work.problem().q_in, p.to_best, q_unchanged);
  EXPECT_LT((q_unchanged - p.best).norm(), 1e-12);
  mjcf_pdg::Random noise(8);
  for (const Hop hop : kAllHops) {
    int fingers = 0, ball = 0;
    for (int k = 0; k < 200; ++k) {
      const VectorXd q = p.ContactHop(p.best, 0.1, hop, noise);
      EXPECT_EQ(q.head<7>(), q_unchanged.head<7>()) << "the palm carries both fingers";
      EXPECT_EQ(q.tail<4>(), q_unchanged.tail<4>()) << "the bob touches nothing";
      const bool finger_moved = q.segment<2>(7) != q_unchanged.segment<2>(7);
      const bool ball_moved = q.segment<2>(9) != q_unchanged.segment<2>(9);
      EXPECT_FALSE(finger_moved && ball_moved) << "one contact at a time";
      fingers += finger_moved;
      ball += ball_moved;
    }
    EXPECT_GT(fingers, 50);
    EXPECT_GT(ball, 50);
  }
}

TEST_F(ContactHopTest, HopsStartFromTheBestFromTheInputOrFromItsOtherSide) {
  Hopper p;
  mjcf_pdg::Random noise(9);
  for (const Hop hop : kAllHops) {
    int moved = 0;
    for (int k = 0; k < 100; ++k) {
      const VectorXd dq = p.Hopped(hop, 1e-7, noise);
      for (int i = kFinger; i < kBob; ++i) {
        if (dq[i] == p.to_best[i]) continue;
        ++moved;
        const double from = hop == Hop::kFromBest    ? p.to_best[i]
                            : hop == Hop::kFromInput ? 0.0
                                                     : -p.to_best[i];
        // The right finger's limit is nearer than its mirrored place.
        const double limit = 5.0 * M_PI / 180.0 - p.work.problem().q_in[kFinger + 2];
        const double expected = i == kFinger + 1 ? std::min(from, limit) : from;
        EXPECT_NEAR(dq[i], expected, hop == Hop::kMirrored ? 1e-12 : 0.02) << i;
      }
    }
    EXPECT_GT(moved, 80);
  }
}

TEST_F(ContactHopTest, HopsStayInsideTheLimits) {
  Hopper p;
  mjcf_pdg::Random noise(10);
  int at_limit = 0;
  for (const Hop hop : kAllHops) {
    for (int k = 0; k < 100; ++k) {
      const VectorXd q = p.ContactHop(p.best, 10.0, hop, noise);
      EXPECT_LE(LimitExcess(p.scene.tables(), q), 1e-12);
      at_limit += std::abs(q[9]) == 0.5 || q[8] == p.scene.tables().joints[2].hi;
    }
  }
  EXPECT_GT(at_limit, 30);
}

TEST_F(ContactHopTest, WhereNothingTouchesAHopMayMoveEveryJoint) {
  Hopper p;
  p.best[7] = -0.3;  // the fingers part, the ball rises
  p.best[10] = 0.2;
  Difference(p.scene.tables(), p.work.problem().q_in, p.best, p.to_best);
  mjcf_pdg::Random noise(11);
  std::vector<int> moved(kDofs, 0);
  for (int k = 0; k < 100; ++k) {
    const VectorXd dq = p.Hopped(Hop::kFromBest, 0.01, noise);
    for (int i = 0; i < kDofs; ++i) moved[i] += std::abs(dq[i] - p.to_best[i]) > 1e-9;
  }
  for (int i = 0; i < kDofs; ++i) EXPECT_NEAR(moved[i], 75, 20) << i;  // half stay in half
}

TEST_F(ContactHopTest, TheSameSeedGivesTheSameHop) {
  Hopper p;
  for (const Hop hop : kAllHops) {
    auto draw = [&](std::uint64_t seed) {
      mjcf_pdg::Random noise(seed);
      VectorXd all(3 * kDofs);
      for (int k = 0; k < 3; ++k) all.segment(k * kDofs, kDofs) = p.Hopped(hop, 0.1, noise);
      return all;
    };
    EXPECT_EQ(draw(12), draw(12));
    EXPECT_NE(draw(12), draw(13));
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
