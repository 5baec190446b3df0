// When a path is where: as fast as the speeds and accelerations of its joints allow.
//
// The path stays the one that is proven free: it is gone through from rest to rest between its
// corners, q(t) = from ⊕ s(t)·(to ⊖ from), since straight edges that meet at an angle cannot be
// gone through without a jump of the speed there. s(t) is the fastest that keeps the limits, by
// Ruckig (Berscheid & Kroeger, Jerk-limited real-time trajectory generation, 2021). The rates of
// all joints are multiples of ds/dt, so that one degree of freedom is all that is to be solved for.
//
// Where a path bends between its corners, along equality constraints, s goes on from one of its
// short edges to the next. Half of the accelerations is for changes of ds/dt, half for the bends.
#ifndef MJCF_PDG_SRC_PLAN_TIMING_H_
#define MJCF_PDG_SRC_PLAN_TIMING_H_

#include <limits>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg {

// The largest rate of a joint: of the length of a free body's velocity and of its angular velocity,
// of the length of a ball's angular velocity, of the one coordinate of others.
struct JointRate {
  double slide = std::numeric_limits<double>::infinity();  // slides, free bodies [m/s or m/s²]
  double turn = std::numeric_limits<double>::infinity();   // hinges, balls, free bodies [rad/s(²)]
};

struct TimingLimits {
  std::vector<JointRate> speed;         // by joint of the model (njnt); finite where it may move
  std::vector<JointRate> acceleration;  // by joint of the model; infinite: speeds jump at corners
  double step = 0.0;                    // between samples [s]
};

struct TimedPath {
  struct Sample {
    double time = 0.0;      // [s]
    std::vector<double> q;  // nq
    std::vector<double> v;  // MuJoCo's qvel (nv), 0 at the corners of the path
  };
  // At multiples of the step. The corners of the path are among them: the way from one to the next
  // takes as many whole steps as it needs. So the straight motions between samples are parts of its
  // edges, except where it bends.
  std::vector<Sample> samples;
  std::vector<double> times;  // of the configurations of the path [s]
};

// `path` has a configuration or more, nq entries each; `corners` are those of Path. Throws Error if
// a joint that moves has no finite speed, or if the way between two corners takes longer than
// Ruckig can tell (7600 s) or has more than a million samples.
TimedPath TimePath(const Scene& scene, const std::vector<std::vector<double>>& path,
                   const std::vector<int>& corners, const TimingLimits& limits);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_TIMING_H_
