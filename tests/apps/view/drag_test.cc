// A body that is dragged comes where the hand is, and what must not move with it does not.
#include "apps/view/drag.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using app::Drag;
using Vector = std::array<double, 3>;

// Two links of 1 m in the plane, one behind the other along x. The second may turn by a right
// angle.
constexpr char kArm[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <geom name="post" size=".05" pos="0 0 -1"/>
  <body name="upper"><joint axis="0 0 1"/><geom type="capsule" fromto="0 0 0 1 0 0" size=".05"/>
    <body name="lower" pos="1 0 0"><joint axis="0 0 1" range="-1.6 1.6" limited="true"/>
      <geom type="capsule" fromto="0 0 0 1 0 0" size=".05"/></body></body>
  </worldbody></mujoco>)";

// A box that flies, with a lid on a hinge, and a mocap body.
constexpr char kBox[] = R"(<mujoco><worldbody>
  <body name="box" pos="0 0 1"><freejoint/><geom type="box" size=".2 .1 .1"/>
    <body name="lid" pos=".2 0 .1"><joint axis="0 1 0"/><geom type="box" size=".1 .1 .01"/></body>
  </body>
  <body name="hand" mocap="true" pos="1 0 0"><geom size=".1"/></body></worldbody></mujoco>)";

class ViewDragTest : public MujocoTest {
 protected:
  void Load(const std::string& xml) {
    model_ = LoadModel(xml);
    data_.reset(mj_makeData(model_.get()));
    mj_forward(model_.get(), data_.get());
  }
  int Body(const char* name) const { return mj_name2id(model_.get(), mjOBJ_BODY, name); }
  // A point in the frame of the body.
  Vector Point(int body, const Vector& in_body) const {
    Vector point;
    mju_mulMatVec3(point.data(), data_->xmat + 9 * body, in_body.data());
    mju_addTo3(point.data(), data_->xpos + 3 * body);
    return point;
  }
  double DistanceTo(int body, const Vector& in_body, const Vector& goal) const {
    return mju_dist3(Point(body, in_body).data(), goal.data());
  }

  ModelPtr model_;
  DataPtr data_;
};

TEST_F(ViewDragTest, AnArmReachesWhatIsInReach) {
  Load(kArm);
  const int lower = Body("lower");
  const Vector tip = {1, 0, 0};
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    mj_resetData(model_.get(), data_.get());
    data_->qpos[0] = random.Uniform(-3, 3);
    data_->qpos[1] = random.Uniform(0.3, 1.5);
    mj_forward(model_.get(), data_.get());
    const Vector from = Point(lower, tip);
    const Drag drag(*model_, *data_, lower, from);
    // Small motions of the hand, as frames bring them, on a circle about the shoulder and inwards.
    Vector goal = from;
    for (int frame = 1; frame <= 20; ++frame) {
      const double angle = 0.03 * frame, share = 1 - 0.003 * frame;
      goal = {share * (std::cos(angle) * from[0] - std::sin(angle) * from[1]),
              share * (std::sin(angle) * from[0] + std::cos(angle) * from[1]), 0};
      // From sqrt(2) on the elbow would have to bend by more than it may.
      if (std::hypot(goal[0], goal[1]) < 1.45) break;
      drag.MoveTo(*data_, {goal[0] - from[0], goal[1] - from[1], 0});
      EXPECT_LT(DistanceTo(lower, tip, goal), 2e-4 * model_->stat.extent);
      EXPECT_LE(std::abs(data_->qpos[1]), 1.6);
    }
  }
}

TEST_F(ViewDragTest, AnArmPointsAtWhatIsOutOfReach) {
  Load(kArm);
  data_->qpos[1] = 1.0;
  mj_forward(model_.get(), data_.get());
  const int lower = Body("lower");
  const Vector from = Point(lower, {1, 0, 0});
  const Drag drag(*model_, *data_, lower, from);
  for (int frame = 1; frame <= 60; ++frame) {
    drag.MoveTo(*data_, {0.1 * frame, 0, 0});
  }
  const Vector goal = {from[0] + 6, from[1], 0};
  const double nearest = std::hypot(goal[0], goal[1]) - 2;  // both links in one line
  EXPECT_LT(DistanceTo(lower, {1, 0, 0}, goal), nearest + 0.01);
}

TEST_F(ViewDragTest, TurningAnArmsEndTurnsItsJoints) {
  Load(kArm);
  const int lower = Body("lower");
  const Drag drag(*model_, *data_, lower, Point(lower, {0.5, 0, 0}));
  const double half = 0.2;  // of the angle [rad]
  drag.TurnTo(*data_, {std::cos(half), 0, 0, std::sin(half)});
  EXPECT_NEAR(data_->qpos[0] + data_->qpos[1], 2 * half, 1e-3);
}

TEST_F(ViewDragTest, AFreeBodyIsCarriedAsItIs) {
  Load(kBox);
  data_->qpos[7] = 0.3;  // the lid
  mj_forward(model_.get(), data_.get());
  const int box = Body("box");
  const Vector grabbed = {0.2, 0.1, 0.1}, from = Point(box, grabbed);
  const Drag drag(*model_, *data_, box, from);
  drag.MoveTo(*data_, {0.1, -0.2, 0.3});
  EXPECT_LT(DistanceTo(box, grabbed, {from[0] + 0.1, from[1] - 0.2, from[2] + 0.3}), 1e-12);
  EXPECT_THAT(std::vector(data_->qpos + 3, data_->qpos + 8), testing::ElementsAre(1, 0, 0, 0, 0.3));

  // A turn leaves the grabbed point where it was grabbed.
  drag.TurnTo(*data_, {std::sqrt(0.5), std::sqrt(0.5), 0, 0});
  EXPECT_LT(DistanceTo(box, grabbed, from), 1e-12);
  EXPECT_NEAR(data_->xmat[9 * box + 5], -1, 1e-12);  // its y axis points up
}

TEST_F(ViewDragTest, APartOfAFreeBodyPullsItsOwnJointsOnly) {
  Load(kBox);
  const int lid = Body("lid");
  const Drag drag(*model_, *data_, lid, Point(lid, {0.1, 0, 0}));
  drag.MoveTo(*data_, {0, 0, 0.05});
  EXPECT_THAT(std::vector(data_->qpos, data_->qpos + 7), testing::ElementsAre(0, 0, 1, 1, 0, 0, 0));
  EXPECT_LT(data_->qpos[7], -0.2);
}

TEST_F(ViewDragTest, AMocapBodyIsCarriedAndWhatIsFixedIsStuck) {
  Load(kBox);
  const int hand = Body("hand");
  const Drag drag(*model_, *data_, hand, Point(hand, {0, 0, 0}));
  drag.MoveTo(*data_, {0, 0.5, 0});
  EXPECT_THAT(std::vector(data_->mocap_pos, data_->mocap_pos + 3), testing::ElementsAre(1, 0.5, 0));
  EXPECT_THAT(std::vector(data_->qpos, data_->qpos + 3), testing::ElementsAre(0, 0, 1));

  Load(kArm);
  Drag stuck(*model_, *data_, 0, {0, 0, -1});
  EXPECT_TRUE(stuck.stuck());
  stuck.MoveTo(*data_, {1, 1, 1});
  EXPECT_THAT(std::vector(data_->qpos, data_->qpos + 2), testing::ElementsAre(0, 0));
}

TEST_F(ViewDragTest, AFiguresJointsStayWithinTheirLimits) {
  model_.reset(mj_loadXML(MJCF_PDG_MODEL_DIR "/figure/figure_bench.xml", nullptr, nullptr, 0));
  ASSERT_TRUE(model_);
  data_.reset(mj_makeData(model_.get()));
  Random random(2);
  int limited = 0;
  for (int trial = 0; trial < 20; ++trial) {
    mj_resetData(model_.get(), data_.get());
    mj_forward(model_.get(), data_.get());
    const std::vector<double> before(data_->qpos, data_->qpos + 7);
    const int body = 2 + random.Index(static_cast<int>(model_->nbody) - 2);
    if (Drag(*model_, *data_, body, {0, 0, 0}).stuck()) continue;
    const double* const centre = data_->xipos + 3 * body;
    const Drag drag(*model_, *data_, body, {centre[0], centre[1], centre[2]});
    const Eigen::Vector3d way = random.UnitVector();
    for (int frame = 1; frame <= 30; ++frame) {
      const double far = 0.05 * frame;
      drag.MoveTo(*data_, {far * way[0], far * way[1], far * way[2]});
    }
    EXPECT_EQ(std::vector(data_->qpos, data_->qpos + 7), before) << "the pelvis has moved";
    for (int joint = 0; joint < model_->njnt; ++joint) {
      if (!model_->jnt_limited[joint]) continue;
      const double* const q = data_->qpos + model_->jnt_qposadr[joint];
      const double low = model_->jnt_range[2 * joint], high = model_->jnt_range[2 * joint + 1];
      const bool ball = model_->jnt_type[joint] == mjJNT_BALL;
      const double value = ball ? 2 * std::acos(std::min(1.0, std::abs(q[0]))) : q[0];
      EXPECT_GE(value, low - 1e-9);
      EXPECT_LE(value, high + 1e-6);
      limited += value > high - 1e-6 || (!ball && value < low + 1e-6);
    }
  }
  EXPECT_GE(limited, 10) << "the trials hardly meet a limit";
}

}  // namespace
}  // namespace mjcf_pdg::test
