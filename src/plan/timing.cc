#include "plan/timing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ruckig/ruckig.hpp>
#include <span>
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

// The way between two corners. s is the time that it would take at full speed [s], 0 at the first.
struct Way {
  struct Piece {
    VectorXd from, rate;  // nq; n, dq/ds
    double s;             // where it begins
  };
  std::vector<Piece> pieces;
  double length = 0.0;  // s of the second corner
};

// s as a function of the time, from rest to rest in whole time steps. Ruckig sees a way of length 1
// that takes about 1: its tolerances, and the longest time that it admits, are numbers.
class Profile {
 public:
  // The largest ds/dt and d²s/dt² [1/s]; that may be infinite.
  Profile(double length, double speed, double acceleration, double step) : length_(length) {
    const bool reaches_speed = length * acceleration >= speed * speed;
    const double fastest = reaches_speed ? length / speed + speed / acceleration
                                         : 2.0 * std::sqrt(length / acceleration);
    // It takes a step at least, and need not be faster than in half of one.
    time_ = std::max(fastest, 0.5 * step);
    ruckig::InputParameter<1> input;
    input.current_position = {0.0};
    input.target_position = {1.0};
    input.max_velocity = {speed * fastest / length};
    if (std::isfinite(acceleration)) {
      input.max_acceleration = {acceleration * fastest * fastest / length};
    }
    input.duration_discretization = ruckig::DurationDiscretization::Discrete;
    ruckig::Ruckig<1> ruckig(step / time_);
    const ruckig::Result result = ruckig.calculate(input, trajectory_);
    if (result == ruckig::Result::Working) return;
    std::ostringstream words;
    words << "no times for an edge that takes " << length
          << " s at full speed (Ruckig: " << static_cast<int>(result) << ")";
    throw Error(words.str());
  }

  double duration() const { return time_ * trajectory_.get_duration(); }  // [s]

  struct Point {
    double s, rate;  // ds/dt
  };
  Point At(double time) const {
    double s, rate, acceleration;
    trajectory_.at_time(time / time_, s, rate, acceleration);
    return {std::clamp(length_ * s, 0.0, length_), length_ / time_ * rate};
  }

  // When s(t) is s, by halving: it never falls.
  double TimeOf(double s) const {
    double early = 0.0, late = duration();
    for (;;) {
      const double time = std::midpoint(early, late);
      if (time <= early || time >= late) return late;
      (At(time).s < s ? early : late) = time;
    }
  }

 private:
  double length_, time_;
  ruckig::Trajectory<1> trajectory_;
};

class PathTimer {
 public:
  PathTimer(const SceneTables& tables, const TimingLimits& limits)
      : tables_(tables), limits_(limits) {}

  TimedPath Run(const std::vector<std::vector<double>>& path, const std::vector<int>& corners) {
    Rest(path.front());
    for (std::size_t k = 1; k < corners.size(); ++k) {
      const auto first = path.begin() + corners[k - 1], last = path.begin() + corners[k];
      Go({first, last + 1});
      Rest(*last);
    }
    return std::move(timed_);
  }

 private:
  // The next sample is a corner of the path.
  void Rest(const std::vector<double>& q) {
    Append(ToEigen(q), VectorXd::Zero(tables_.n));
    timed_.samples.back().q = q;
    timed_.times.push_back(timed_.samples.back().time);
  }

  // The samples between two corners, and the times of configurations between them.
  void Go(std::span<const std::vector<double>> path) {
    const double begin = timed_.samples.back().time;
    const Way way = MakeWay(path);
    if (way.length == 0.0) {
      timed_.times.insert(timed_.times.end(), way.pieces.size() - 1, begin);
      return;
    }
    const Profile profile = MakeProfile(way);
    Sample(way, profile);
    for (std::size_t k = 1; k < way.pieces.size(); ++k) {
      timed_.times.push_back(begin + profile.TimeOf(way.pieces[k].s));
    }
  }

  Way MakeWay(std::span<const std::vector<double>> path) const {
    Way way;
    VectorXd dq(tables_.n);
    for (std::size_t k = 1; k < path.size(); ++k) {
      const VectorXd from = ToEigen(path[k - 1]);
      Difference(tables_, from, ToEigen(path[k]), dq);
      const double seconds = Longest(tables_, limits_.speed, dq, true);
      way.pieces.push_back({from, seconds > 0.0 ? VectorXd(dq / seconds) : dq, way.length});
      way.length += seconds;
    }
    return way;
  }

  Profile MakeProfile(const Way& way) const {
    double bends = 0.0,
           along = 0.0;  // accelerations of joints over their limits, by (ds/dt)², d²s/dt²
    for (std::size_t k = 0; k < way.pieces.size(); ++k) {
      const Way::Piece& piece = way.pieces[k];
      along = std::max(along, Longest(tables_, limits_.acceleration, piece.rate, false));
      if (k == 0) continue;
      const Way::Piece& before = way.pieces[k - 1];
      const double end = k + 1 < way.pieces.size() ? way.pieces[k + 1].s : way.length;
      const double between = 0.5 * (end - before.s);
      if (between == 0.0) continue;
      const VectorXd bend = (piece.rate - before.rate) / between;
      bends = std::max(bends, Longest(tables_, limits_.acceleration, bend, false));
    }
    const double share = bends > 0.0 ? 0.5 : 1.0;
    return Profile(way.length, std::min(1.0, std::sqrt(share / bends)), share / along,
                   limits_.step);
  }

  void Sample(const Way& way, const Profile& profile) {
    const double steps = std::round(profile.duration() / limits_.step);
    if (static_cast<double>(timed_.samples.size()) + steps > kMaxSamples) {
      throw Error(
          "the path takes more than a million steps of the trajectory (--speeds, --time-step)");
    }
    VectorXd q;
    std::size_t piece = 0;
    for (int k = 1; k < static_cast<int>(steps); ++k) {
      const auto [s, rate] = profile.At(k * limits_.step);
      while (piece + 1 < way.pieces.size() && way.pieces[piece + 1].s <= s) ++piece;
      const Way::Piece& at = way.pieces[piece];
      Integrate(tables_, at.from, (s - at.s) * at.rate, q);
      Append(q, rate * Tangent(way, piece, s));
    }
  }

  // dq/ds at s, on the way's piece `k`: that of a piece in its middle, and between those of
  // neighbours a mean, since edges are chords of what bends.
  static VectorXd Tangent(const Way& way, std::size_t k, double s) {
    const auto middle = [&way](std::size_t i) {
      const double end = i + 1 < way.pieces.size() ? way.pieces[i + 1].s : way.length;
      return 0.5 * (way.pieces[i].s + end);
    };
    const bool before = s < middle(k);
    if (before ? k == 0 : k + 1 == way.pieces.size()) return way.pieces[k].rate;
    const std::size_t first = before ? k - 1 : k;
    const double t = (s - middle(first)) / (middle(first + 1) - middle(first));
    return (1.0 - t) * way.pieces[first].rate + t * way.pieces[first + 1].rate;
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
  TimedPath timed_;
};

}  // namespace

TimedPath TimePath(const Scene& scene, const std::vector<std::vector<double>>& path,
                   const std::vector<int>& corners, const TimingLimits& limits) {
  return PathTimer(scene.tables(), limits).Run(path, corners);
}

}  // namespace mjcf_pdg
