// From candidates to an answer: what the verifier does not call free is not accepted.
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

  // The verifier's word on what `q_in`, as the user gave it, may rest.
  void Begin(const std::vector<double>& q_in) { q_in_ = &q_in; }

  // Polishes and verifies the candidates, best first, then the least overlap, for exact meshes that
  // cross may be within the tolerance, then `hint` (null: none). True if one is free: then q and
  // start say which. Ends early when the budget is spent, but for one candidate and the hint.
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
  VectorXd trial_;
  std::vector<double> q_;
  Component start_ = Component::kNone;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_ACCEPTANCE_H_
