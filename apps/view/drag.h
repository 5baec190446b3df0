// A body that is moved by hand, and what moves with it. Contacts do not count: the hand may move
// anything into anything.
#ifndef MJCF_PDG_APPS_VIEW_DRAG_H_
#define MJCF_PDG_APPS_VIEW_DRAG_H_

#include <mujoco/mujoco.h>

#include <array>

namespace mjcf_pdg::app {

// Moves the body that was grabbed to where the hand is.
//
// A body with a free joint of its own, or on a mocap body, is carried as it is. Any other pulls the
// joints between it and the next free joint or the world behind it, which turn within their limits:
// damped least squares, dq = W Jᵀ (J W Jᵀ + λI)⁻¹ e, with MuJoCo's dof_invweight0 as W, so that
// light links move first.
class Drag {
 public:
  // Grabs `body` at a point that is fixed to it (world frame, as the body is posed in `data` [m]).
  Drag(const mjModel& model, const mjData& data, int body, const std::array<double, 3>& point_W);

  // Nothing can move the body: no joint, and not on a mocap body.
  bool stuck() const { return carrier_ == Carrier::kNone; }

  // Moves the grabbed point by `translation_W` [m] from where it was grabbed. Writes data.qpos or
  // the mocap pose, and poses `data`.
  void MoveTo(mjData& data, const std::array<double, 3>& translation_W) const;
  // Turns the body by a unit quaternion (w, x, y, z), world axes, from how it was grabbed.
  void TurnTo(mjData& data, const std::array<double, 4>& rotation_W) const;

 private:
  enum class Carrier { kNone, kFreeJoint, kMocap, kJoints };

  void Carry(mjData& data, const std::array<double, 3>& translation_W,
             const std::array<double, 4>& rotation_W) const;
  template <typename Error3>
  void Pull(mjData& data, bool turns, double enough, Error3 error) const;
  bool IsBetween(int joint) const;

  const mjModel& model_;
  int body_;
  int carrier_body_ = 0;  // with the free joint or the mocap pose
  Carrier carrier_ = Carrier::kNone;
  std::array<double, 3> point_W_ = {};      // where it was grabbed
  std::array<double, 3> point_B_ = {};      // the same in the body's frame
  std::array<double, 3> place_W_ = {};      // of the carrier when it was grabbed
  std::array<double, 4> turn_W_ = {};       // the same, as a quaternion
  std::array<double, 4> body_turn_W_ = {};  // of the body when it was grabbed
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEW_DRAG_H_
