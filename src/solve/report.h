// What a result says: the verifier's verdicts on q_in and on the answer, unedited, and why there is
// no answer if there is none.
#ifndef MJCF_PDG_SRC_SOLVE_REPORT_H_
#define MJCF_PDG_SRC_SOLVE_REPORT_H_

#include <vector>

#include "mjcf_pdg/pdg.h"
#include "problem/strategy.h"
#include "problem/workspace.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

class Reporter {
 public:
  Reporter(Workspace& work, Verifier& verifier)
      : problem_(work.problem()), work_(work), verifier_(verifier) {}

  // Empties `result`, keeping its memory.
  static void Clear(Result& result);

  // The verifier's word on q_in: true if it is free, and the result says so.
  bool Input(const std::vector<double>& q_in, Result& result);
  // Without contacts and distances to report, depths at q_in are the search's own: the verifier
  // takes longer to measure deep overlaps than to tell that there are some.
  void Overlaps(const std::vector<NearPair>& overlaps, Result& result) const;
  // `q` is free by the verifier's last word.
  void Solved(const std::vector<double>& q_in, const std::vector<double>& q, Component start,
              Result& result);
  // The least overlap that the search saw, or q_in inside its limits if the verifier finds more
  // there. `outcome` null: nothing was searched. `frozen`: pairs overlap that no movable joint can
  // part.
  void Unsolved(const std::vector<double>& q_in, const Outcome* outcome, bool frozen,
                Result& result);

 private:
  bool Reports() const {
    return problem_.options.report_contacts || problem_.options.report_distances_to > 0.0;
  }
  double Sigma(const std::vector<double>& q);
  void Answer(const Verdict& verdict, Result& result) const;
  void AnswerUnmeasured(Result& result) const;
  void SayWhy(const Outcome* outcome, bool frozen, const Verdict& verdict, Result& result);

  const Problem& problem_;
  Workspace& work_;
  Verifier& verifier_;
  VectorXd q_;  // scratch
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_REPORT_H_
