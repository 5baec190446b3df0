// All frames of a trajectory together (TrajectoryOptions::smooth): minimizes
//   E = Σ_k σ(q_in_k, q_k) + W Σ_k change(q_k, q_k+1)
// over free configurations, where change(a, b) = ‖J_k X(a, b)‖² is the norm's quadratic form with
// the Jacobian of its residual at q_in_k, and X(a, b) is the Change of norm/change.h.
//
// Source: Tang & Kim, Eq. 26 and 28, for the form; sweeps are successive over-relaxation (Young,
// Iterative Solution of Large Linear Systems, 1971) by blocks, one frame each, projected onto what
// is free.
// How: the frames are followed from the first to the last and from the last to the first, each with
// and without a search for other optima, and of the four answers of each frame the sequence of
// least E is taken (dynamic programming): so a frame knows what comes. Then sweeps go forward and
// backward: each frame in turn descends on E with its neighbours where they are. What the verifier
// does not call free, or what does not lower E, is not taken. So every state is free, and E never
// rises.
#ifndef MJCF_PDG_SRC_TRACK_SMOOTHER_H_
#define MJCF_PDG_SRC_TRACK_SMOOTHER_H_

#include <functional>
#include <vector>

#include "track/follower.h"
#include "track/frame_solver.h"

namespace mjcf_pdg {

// Throws Error unless `weight` is a W, or 0 for none, and the options can do with it.
void CheckSmooth(double weight, const Options& options);

class Smoother {
 public:
  // `weight`: W > 0. Keeps a reference to `frames`. Throws Error as Solver does.
  Smoother(const Scene& scene, const Options& options, double weight,
           const std::vector<Frame>& frames);

  // Fills a result for each frame. `go_on` is asked between frames; where it says no, returns
  // false. Frames for which nothing free is found keep what FrameSolver says, and pull nobody.
  bool Run(const std::function<bool()>& go_on, std::vector<Result>& results);

 private:
  struct Answer {
    VectorXd q;  // nq
    bool free = false;
    double sigma = 0.0;  // from its q_in, as followed [m²]
  };
  bool Follow(FrameSolver& solver, bool backward, const std::function<bool()>& go_on,
              std::vector<Result>& results);
  void Choose(const std::vector<std::vector<Result>>& ways);
  double ChangeFrom(std::size_t k, const Answer& from, const Answer& to);
  double Energy();
  bool Sweep(bool backward, const std::function<bool()>& go_on);
  double Improve(std::size_t k);
  void Begin(std::size_t k);
  void Pull(std::size_t k, std::size_t neighbour, std::size_t earlier);
  bool Lower(const VectorXd& q, double than);
  void Report(std::size_t k, Result& result);

  const double weight_;      // W
  const double relaxation_;  // ω
  const std::vector<Frame>& frames_;
  const Scene scene_;
  const Options options_;
  SolverCore core_;
  Follower follower_;
  NormEvaluator earlier_;  // its reference is the q_in of another frame
  std::vector<Answer> answers_;
  std::vector<double> gains_;  // by which the last visit of each frame lowered E [m²]
  std::vector<int> iterations_, queries_;
  std::vector<double> seconds_;
  double energy_ = 0.0;  // E of the frames that are free [m²]

  const std::vector<double>* q_in_ = nullptr;  // of the present frame
  int visits_ = 0;                             // of frames, by now
  std::vector<double> asked_;
  VectorXd at_rest_, X_, r_, dq_, trial_, found_;
  MatrixXd J_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_SMOOTHER_H_
