// How far bodies are moved from one configuration to another, each measured by its own size: what
// matters in a narrow passage, where √σ does not see a light hand turn.
#ifndef MJCF_PDG_SRC_PLAN_BODY_TRAVEL_H_
#define MJCF_PDG_SRC_PLAN_BODY_TRAVEL_H_

#include <vector>

#include "model/kinematics.h"
#include "plan/configuration_space.h"

namespace mjcf_pdg {

class BodyTravel {
 public:
  // `tables` must outlive this object.
  explicit BodyTravel(const SceneTables& tables);

  // The largest ratio, over the bodies that move and collide, of how far its farthest point is
  // moved, at most, to the radius of the sphere around its geoms. Configurations have nq entries.
  double InRadii(const VectorXd& from, const VectorXd& to);

 private:
  struct Pose {
    Vector3d center_W;  // of the body's sphere
    Matrix3d R;
  };
  Pose PoseOf(int body) const;

  const SceneTables& tables_;
  PosedModel posed_;
  std::vector<int> bodies_;
  std::vector<Pose> before_;  // by bodies_
};

// The median of InRadii over motions of this length, √σ [m], from random configurations of the
// space towards others.
double TypicalTravel(const ConfigurationSpace& space, double length);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_BODY_TRAVEL_H_
