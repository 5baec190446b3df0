// Where position actuators pull to when a configuration is replaced by a repaired one: left where
// it was, a servo would pull the repaired robot back into what it was freed of.
#ifndef MJCF_PDG_APPS_OUTPUT_SETPOINTS_H_
#define MJCF_PDG_APPS_OUTPUT_SETPOINTS_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <vector>

#include "apps/input/configurations.h"

namespace mjcf_pdg::app {

// Controls (nu entries) and activations (na entries), as in a keyframe.
struct Setpoints {
  std::vector<double> ctrl, act;

  bool operator==(const Setpoints&) const = default;
};

class SetpointMover {
 public:
  // `model` must outlive this object. Throws std::runtime_error if MuJoCo cannot make its data.
  explicit SetpointMover(const mjModel& model);

  // Those of the row's keyframe; 0, as mj_resetData has them, for a row without one.
  Setpoints Of(const Configuration& row) const;
  // The same with those of position actuators moved by the change of the actuator's length from the
  // row's q to `q` (nq entries), within their ranges. A servo that was off its setpoint stays off
  // by as much, so that the scene behaves as its author meant it, without the overlap.
  Setpoints Moved(const Configuration& row, const std::vector<double>& q);

 private:
  struct DataDeleter {
    void operator()(mjData* data) const { mj_deleteData(data); }
  };

  std::vector<double> ActuatorLengths(const Configuration& row, const std::vector<double>& q);

  const mjModel& model_;
  const std::unique_ptr<mjData, DataDeleter> data_;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_SETPOINTS_H_
