// Tells a user's Observer (mjcf_pdg/observer.h) what the descents of a solve do. One per solver,
// shared by the workspaces of its islands.
#ifndef MJCF_PDG_SRC_PROBLEM_RECORDER_H_
#define MJCF_PDG_SRC_PROBLEM_RECORDER_H_

#include <utility>
#include <vector>

#include "mjcf_pdg/observer.h"
#include "model/kinematics.h"
#include "problem/components.h"

namespace mjcf_pdg {

class Recorder {
 public:
  void Set(Observer observer) { observer_ = std::move(observer); }
  bool watched() const { return static_cast<bool>(observer_); }

  void BeginSolve() { iteration_.descent = -1; }
  void BeginDescent(Component start) {
    iteration_.start = NameOf(start);
    ++iteration_.descent;
    iteration_.step = -1;
  }

  // Where a step has ended.
  struct Place {
    const VectorXd& q;  // nq
    double sigma;       // [m²]
    double violation;   // [m]
    bool free;
  };
  // Tells the next step of the descent, with rows(). Only if watched().
  void Tell(const Place& place) {
    ++iteration_.step;
    iteration_.q = {place.q.data(), static_cast<std::size_t>(place.q.size())};
    iteration_.sigma = place.sigma;
    iteration_.violation = place.violation;
    iteration_.free = place.free;
    iteration_.rows = rows_;
    observer_(iteration_);
  }
  std::vector<ObservedRow>& rows() { return rows_; }

 private:
  Observer observer_;
  Iteration iteration_;
  std::vector<ObservedRow> rows_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_RECORDER_H_
