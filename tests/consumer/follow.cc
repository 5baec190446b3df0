// Runs the control loop of docs/consumers.md, with what it leaves to the reader: an arm.
#include "follow.h"

#include <mujoco/mujoco.h>

#include <cstdio>
#include <vector>

// A ball on a slide that is told to sink into the floor, a little deeper each tick.
struct Arm {
  bool NextCommand(std::vector<double>& command, const mjData*) {
    command = {-0.01 * static_cast<double>(height.size())};
    return height.size() < 10;
  }
  void MoveTo(const std::vector<double>& q) { height.push_back(q[0]); }

  std::vector<double> height;
};

#include "document.inc"

bool FollowsCommandsWithoutTouching(const mjModel* model) {
  mjData* data = mj_makeData(model);
  data->qpos[0] = 0.03;
  Arm arm;
  Follow(model, data, arm);
  mj_deleteData(data);
  bool apart = arm.height.size() == 10;
  for (const double height : arm.height) apart = apart && height > 0.02 - 2e-6;
  std::printf("followed %zu commands, last at %g m\n", arm.height.size(), arm.height.back());
  return apart;
}
