// All that a Solver is made of, and the path of a solve: check, bound, search, accept, report.
// Solver (mjcf_pdg/pdg.h) checks its arguments and calls this; Tracker (track/) shares the parts.
#ifndef MJCF_PDG_SRC_SOLVE_SOLVER_CORE_H_
#define MJCF_PDG_SRC_SOLVE_SOLVER_CORE_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bound/lower_bound.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"
#include "problem/bystanders.h"
#include "problem/workspace.h"
#include "solve/island_search.h"
#include "solve/report.h"
#include "solve/stages.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

struct SolverCore {
  // Throws Error as Solver's constructor does.
  SolverCore(const Scene& s, const Options& o);

  // Solves for q (nq), which has been checked.
  Status Solve(std::span<const double> q, Result& result);
  void SetMocap(std::span<const double> pos, std::span<const double> quat);
  // By equality constraint of the model. Throws Error if the method cannot hold one.
  void SetActive(std::span<const mjtBool> active);
  // Mocap poses and active constraints as in `data`; and whether they are so already.
  void SetObstacles(const mjData& data);
  bool HasObstacles(const mjData& data) const;
  // Throws Error unless q has nq good entries and the model is as it was.
  void CheckInput(std::span<const double> q) const;
  void Forget();  // all earlier solves
  // Since construction: collision queries, and steps of LCPs.
  std::int64_t Queries() const;
  std::int64_t LcpSteps() const;

  const Scene scene;
  const Options options;
  Workspace work;    // of the whole scene
  LowerBound bound;  // likewise, for those who follow an answer instead of searching (track/)
  Verifier verifier;
  Reporter reporter;
  Budget budget;
  MocapPoses mocap;
  VectorXd hint;  // nq; empty: none
  Recorder recorder;

 private:
  bool Search(Result& result);
  bool SearchWhole(const std::vector<NearPair>& overlaps, int distances, Result& result);
  bool SearchIslands(const std::vector<NearPair>& overlaps, Result& result);
  const VectorXd* Hint();
  void LeaveBystanders(const std::vector<NearPair>& overlaps);
  void Remember(const Result& result);

  // One of the two is null: a scene is solved as a whole or island by island.
  std::unique_ptr<Stages> whole_;
  std::unique_ptr<IslandSearch> islands_;
  Bystanders bystanders_;

  // The present solve.
  std::vector<double> q_in_;     // as the user gave it
  VectorXd at_rest_;             // per kept pair, see DistancesAtRest
  VectorXd q_hint_;              // the hint with what is frozen as in q_in
  std::vector<double> q_;        // the answer
  std::optional<double> sigma_;  // of the answer, if it is known [m²]
  std::vector<double> left_;     // the answer without what need not have moved
  Component start_ = Component::kNone;
  Outcome* outcome_ = nullptr;  // null: nothing was searched
  bool frozen_ = false;         // pairs overlap that no movable joint can part
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_SOLVER_CORE_H_
