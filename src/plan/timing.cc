#include "plan/timing.h"

#include <algorithm>
#include <cmath>
#include <ruckig/ruckig.hpp>
#include <sstream>
#include <string>

#include "base/names.h"
#include "model/kinematics.h"

namespace mjcf_pdg {
namespace {

// A path of this many samples is a mistake in a unit rather than meant.
constexpr double kMaxSamples = 1e6;

// For how long the motion dq lasts at the rates, each joint by itself: [s] for speeds, [s²] for
// accelerations. Throws Error for a joint that moves without a finite `rates`, if that is asked.
double Longest(const SceneTables& tables, const std::vector<JointRate>& rates, const VectorXd& dq,
               bool finite) {
  double longest = 0.0;
  for (const JointEntry& joint : tables.joints) {
    const JointRate& rate = rates[static_cast<std::size_t>(joint.id)];
    const int slides = joint.Slides(0) ? std::min(joint.ndof, 3) : 0;
    const double slid = dq.segment(joint.col, slides).norm();
    const double turned = dq.segment(joint.col + slides, joint.ndof - slides).norm();
    if (finite &&
        ((slid > 0.0 && std::isinf(rate.slide)) || (turned > 0.0 && std::isinf(rate.turn)))) {
      throw Error("no speed is given for joint " +
                  QuotedNameOrId(*tables.model, mjOBJ_JOINT, joint.id));
    }
    longest = std::max({longest, slid / rate.slide, turned / rate.turn});
  }
  return longest;
}

class PathTimer {
 public:
  PathTimer(const SceneTables& tables, const TimingLimits& limits)
      : tables_(tables), limits_(limits), ruckig_(limits.step) {}

  TimedPath Run(const std::vector<std::vector<double>>& path) {
    Rest(path.front());
    for (std::size_t k = 1; k < path.size(); ++k) {
      Edge(path[k - 1], path[k]);
      Rest(path[k]);
    }
    return std::move(timed_);
  }

 private:
  // The next sample is a configuration of the path.
  void Rest(const std::vector<double>& q) {
    Append(ToEigen(q), VectorXd::Zero(tables_.n));
    timed_.samples.back().q = q;
    timed_.times.push_back(timed_.samples.back().time);
  }

  // The samples between two configurations of the path.
  void Edge(const std::vector<double>& from, const std::vector<double>& to) {
    const VectorXd q_from = ToEigen(from);
    VectorXd dq(tables_.n), q;
    Difference(tables_, q_from, ToEigen(to), dq);
    const double seconds = Longest(tables_, limits_.speed, dq, true);
    if (seconds == 0.0) return;
    const ruckig::Trajectory<1> way = Profile(seconds, dq);
    const double steps = std::round(way.get_duration() / limits_.step);
    if (static_cast<double>(timed_.samples.size()) + steps > kMaxSamples) {
      throw Error("the path takes more than a million steps of the trajectory");
    }
    for (int k = 1; k < static_cast<int>(steps); ++k) {
      double at, rate, acceleration;
      way.at_time(k * limits_.step, at, rate, acceleration);
      Integrate(tables_, q_from, std::clamp(at / seconds, 0.0, 1.0) * dq, q);
      Append(q, rate / seconds * dq);
    }
  }

  // The way along an edge, in seconds that it takes at full speed, as a function of the time. In
  // that unit the largest speed is 1, so that Ruckig's tolerances fit edges of any length.
  ruckig::Trajectory<1> Profile(double seconds, const VectorXd& dq) {
    ruckig::InputParameter<1> input;
    input.current_position = {0.0};
    input.target_position = {seconds};
    input.max_velocity = {1.0};
    const double squared = Longest(tables_, limits_.acceleration, dq, false);
    if (squared > 0.0) input.max_acceleration = {seconds / squared};
    input.duration_discretization = ruckig::DurationDiscretization::Discrete;
    ruckig::Trajectory<1> way;
    const ruckig::Result result = ruckig_.calculate(input, way);
    if (result == ruckig::Result::Working) return way;
    std::ostringstream words;
    words << "no times for an edge that takes " << seconds
          << " s at full speed (Ruckig: " << static_cast<int>(result) << ")";
    throw Error(words.str());
  }

  void Append(const VectorXd& q, const VectorXd& rates) {
    TimedPath::Sample sample;
    sample.time = static_cast<double>(timed_.samples.size()) * limits_.step;
    sample.q.assign(q.data(), q.data() + q.size());
    sample.v.assign(tables_.column_of_dof.size(), 0.0);
    for (std::size_t dof = 0; dof < sample.v.size(); ++dof) {
      if (tables_.column_of_dof[dof] >= 0) sample.v[dof] = rates[tables_.column_of_dof[dof]];
    }
    timed_.samples.push_back(std::move(sample));
  }

  const SceneTables& tables_;
  const TimingLimits& limits_;
  ruckig::Ruckig<1> ruckig_;
  TimedPath timed_;
};

}  // namespace

TimedPath TimePath(const Scene& scene, const std::vector<std::vector<double>>& path,
                   const TimingLimits& limits) {
  return PathTimer(scene.tables(), limits).Run(path);
}

}  // namespace mjcf_pdg
