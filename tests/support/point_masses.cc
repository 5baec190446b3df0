#include "tests/support/point_masses.h"

namespace mjcf_pdg::test {

std::string PointMassXml(const std::string& pattern, Random& rng) {
  std::string text;
  for (std::size_t at = 0; at < pattern.size();) {
    if (pattern.compare(at, 7, "@points") == 0) {
      for (int i = 0; i < 4; ++i) {
        const double mass = rng.Uniform(0.2, 2.0);
        const Vector3d pos = rng.InBox(0.3);
        text += "<geom size='2e-5' contype='0' conaffinity='0' mass='" + Join(&mass, 1) +
                "' user='" + Join(&mass, 1) + "' pos='" + Join(pos.data(), 3) + "'/>";
      }
      at += 7;
    } else if (pattern.compare(at, 5, "@pose") == 0) {
      const Eigen::Quaterniond quat = rng.UnitQuat();
      const Vector3d pos = rng.InBox(0.4);
      const double wxyz[4] = {quat.w(), quat.x(), quat.y(), quat.z()};
      text += "pos='" + Join(pos.data(), 3) + "' quat='" + Join(wxyz, 4) + "'";
      at += 5;
    } else if (pattern.compare(at, 5, "@axis") == 0) {
      const Vector3d axis = rng.UnitVector(), pos = rng.InBox(0.2);
      text += "axis='" + Join(axis.data(), 3) + "' pos='" + Join(pos.data(), 3) + "'";
      at += 5;
    } else {
      text += pattern[at++];
    }
  }
  return "<mujoco><size nuser_geom='1'/><worldbody>" + text + "</worldbody></mujoco>";
}

VectorXd OneJointMoved(const JointEntry& joint, const VectorXd& q_in, const VectorXd& q) {
  const int entries = joint.type == mjJNT_FREE ? 7 : joint.type == mjJNT_BALL ? 4 : 1;
  VectorXd moved = q_in;
  moved.segment(joint.qadr, entries) = q.segment(joint.qadr, entries);
  return moved;
}

double SequentialByPoints(const Scene& scene, const VectorXd& q_in, const VectorXd& q) {
  Points points(scene);
  const Eigen::Matrix3Xd at_in = points.At(q_in);
  double sigma = 0.0;
  for (const JointEntry& joint : scene.tables().joints) {
    sigma += points.MeanSquare(at_in, points.At(OneJointMoved(joint, q_in, q)));
  }
  return sigma;
}

double RootByPoints(const Scene& scene, int root, int top, const VectorXd& q_in,
                    const VectorXd& q) {
  Points points(scene);
  const Eigen::Matrix3Xd at_in = points.At(q_in);
  Eigen::Matrix3Xd moved = at_in;
  const Eigen::Isometry3d carried = points.Pose(q, root) * points.Pose(q_in, root).inverse();
  for (int i = 0; i < moved.cols(); ++i) {
    if (points.InSubtree(i, top)) moved.col(i) = carried * at_in.col(i);
  }
  double sigma = points.MeanSquare(at_in, moved);
  for (const JointEntry& joint : scene.tables().joints) {
    if (joint.body == top) continue;
    const VectorXd one = OneJointMoved(joint, q_in, q);
    int on_path = root;
    while (on_path > joint.body) on_path = scene.model()->body_parentid[on_path];
    moved = points.At(one);
    if (on_path == joint.body) {
      const Eigen::Isometry3d turned =
          points.Pose(q_in, joint.body) * points.Pose(one, joint.body).inverse();
      for (int i = 0; i < moved.cols(); ++i) {
        const bool other_side = points.InSubtree(i, top) && !points.InSubtree(i, joint.body);
        moved.col(i) = other_side ? Vector3d(turned * at_in.col(i)) : Vector3d(at_in.col(i));
      }
    }
    sigma += points.MeanSquare(at_in, moved);
  }
  return sigma;
}

}  // namespace mjcf_pdg::test
