// Bodies that are clouds of points with masses, so that σ can be measured as what it means: the
// mean squared displacement of mass, of one joint's motion at a time or of all together.
#ifndef MJCF_PDG_TESTS_SUPPORT_POINT_MASSES_H_
#define MJCF_PDG_TESTS_SUPPORT_POINT_MASSES_H_

#include <Eigen/Dense>
#include <string>

#include "mjcf_pdg/scene.h"
#include "model/kinematics.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

// MJCF with `pattern` as its world: @points (four of random mass), @pose, @pos and @axis are filled
// in at random.
std::string PointMassXml(const std::string& pattern, Random& rng);

// All joint kinds, several joints per body, branches, two trees on a shared static stand, a weld.
inline constexpr char kForest[] = R"(
    <body name="base" @pose><freejoint name="free"/>@points
      <body name="torso" @pose><joint name="waist" @axis/>@points
        <body name="left" @pose><joint name="shoulder" type="ball" @axis/>@points
          <body name="hand" @pose><joint name="wrist" @axis/><joint name="palm" type="slide" @axis/>
          @points</body></body>
        <body name="plate" @pose>@points</body>
        <body name="right" @pose><joint name="lift" type="slide" @axis/>@points</body></body></body>
    <body name="stand" @pose>@points
      <body name="one" @pose><joint name="turn" @axis/>@points
        <body name="tip" @pose><joint name="ball" type="ball" @axis/>@points</body></body>
      <body name="two" @pose><joint name="x" type="slide" @axis/>
        <joint name="y" type="slide" @axis/><joint name="yaw" @axis/>@points
        <body name="mast" @pose><joint name="tilt" @axis/>@points</body></body></body>)";

// The mass points of a model at configurations.
class Points {
 public:
  explicit Points(const Scene& scene) : scene_(scene), d_(mj_makeData(scene.model())) {}

  Eigen::Matrix3Xd At(const VectorXd& q) {
    mju_copy(d_->qpos, q.data(), scene_.nq());
    mj_kinematics(scene_.model(), d_.get());
    return Eigen::Map<Eigen::Matrix3Xd>(d_->geom_xpos, 3, scene_.model()->ngeom);
  }
  Eigen::Isometry3d Pose(const VectorXd& q, int body) {
    At(q);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = AsMatrix(d_->xmat + 9 * body);
    pose.translation() = AsVector(d_->xpos + 3 * body);
    return pose;
  }
  int body(int point) const { return scene_.model()->geom_bodyid[point]; }
  bool InSubtree(int point, int top) const {
    int b = body(point);
    while (b > top) b = scene_.model()->body_parentid[b];
    return b == top;
  }
  double mass(int point) const {
    return scene_.tables().body_moves[body(point)] ? scene_.model()->geom_user[point] : 0.0;
  }
  double MeanSquare(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) const {
    double sum = 0.0, total = 0.0;
    for (int i = 0; i < from.cols(); ++i) {
      sum += mass(i) * (from.col(i) - to.col(i)).squaredNorm();
      total += mass(i);
    }
    return sum / total;
  }

 private:
  const Scene& scene_;
  DataPtr d_;
};

// q_in with one joint's entries from q.
VectorXd OneJointMoved(const JointEntry& joint, const VectorXd& q_in, const VectorXd& q);

// σ of the sequential metric [m²]: joint by joint, outboard joints as in q_in.
double SequentialByPoints(const Scene& scene, const VectorXd& q_in, const VectorXd& q);

// The same with another root link: its pose carries all of its tree (top body `top`); a joint on
// the way to it moves the rest of the tree the other way.
double RootByPoints(const Scene& scene, int root, int top, const VectorXd& q_in, const VectorXd& q);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_POINT_MASSES_H_
