// The motion that track_bench and switches_bench follow: joints on sinusoids, among obstacles.
#ifndef MJCF_PDG_BENCH_TRACK_MOTION_H_
#define MJCF_PDG_BENCH_TRACK_MOTION_H_

#include <mujoco/mujoco.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"

namespace mjcf_pdg::bench {

struct MotionArguments {
  std::vector<std::string> models;  // empty: our own three
  int ticks = 10000;
  int obstacles = 12;
  double amplitude = 0.35;  // of a joint's range, which is at most half a turn [1]
  unsigned long long seed = 0;
};

// Adds the options that fill `arguments`, whose values are the defaults.
void AddMotionArguments(CLI::App& app, MotionArguments& arguments);

using ModelPtr = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using DataPtr = std::unique_ptr<mjData, void (*)(mjData*)>;
using Q = std::vector<double>;

// Smooth commands about the home configuration; free joints and balls stay.
class Commands {
 public:
  Commands(const mjModel& m, const MotionArguments& a, Random& random);
  // At a time [s].
  Q At(double t) const;

 private:
  struct Wave {
    int qadr;
    double middle, amplitude, frequency, phase;
  };
  Q home_;
  std::vector<Wave> waves_;
};

// The model with boxes, balls and capsules of a few centimetres around it, each where some geom
// comes by, and none where the robot is at home.
ModelPtr WithObstacles(const std::string& path, const MotionArguments& a, Random& random);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_TRACK_MOTION_H_
