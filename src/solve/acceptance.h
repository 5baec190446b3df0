// Makes a candidate of the search the answer: only one that the verifier calls free.
#ifndef MJCF_PDG_SRC_SOLVE_ACCEPTANCE_H_
#define MJCF_PDG_SRC_SOLVE_ACCEPTANCE_H_

#include <vector>

#include "problem/strategy.h"
#include "problem/workspace.h"
#include "start/selection.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

class Acceptance {
 public:
  Acceptance(Workspace& work, Strategy& strategy, Verifier& verifier)
      : problem_(work.problem()),
        work_(work),
        strategy_(strategy),
        verifier_(verifier),
        starts_(work) {}

  // Begins a solve of `q_in`, as the user gave it, which must live until the solve ends: the
  // verifier is told it because contacts may rest as deep as they do there (Options::rest).
  void Begin(const std::vector<double>& q_in) { q_in_ = &q_in; }

  // Polishes and verifies the free candidates, nearest first; then the least overlap, because exact
  // meshes that cross may still be within the tolerance; then `hint` (null: none), which comes
  // before candidates that are farther. Returns true if one is free; q and start then say which. Of
  // a solve whose budget is spent only the first candidate and the hint are looked at.
  bool Accept(Outcome& outcome, const VectorXd* hint);

  const std::vector<double>& q() const { return q_; }  // nq
  Component start() const { return start_; }

 private:
  bool AcceptCandidate(Candidate& candidate);
  bool AcceptFartherOut(const Candidate& candidate, bool proven);
  bool IsFree(const VectorXd& q, Component start);

  const Problem& problem_;
  Workspace& work_;
  Strategy& strategy_;
  Verifier& verifier_;
  const std::vector<double>* q_in_ = nullptr;
  StartSelection starts_;
  VectorXd trial_, unwound_;
  std::vector<double> q_;
  Component start_ = Component::kNone;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_ACCEPTANCE_H_
