// Writes the Result: the verifier's verdicts on q_in and on the answer, unedited, and the reason
// where there is no answer.
#ifndef MJCF_PDG_SRC_SOLVE_REPORT_H_
#define MJCF_PDG_SRC_SOLVE_REPORT_H_

#include <optional>
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

  // Resets `result`, keeping its memory.
  static void Clear(Result& result);

  // Asks the verifier about q_in. If it is free, the result is complete: returns true.
  bool Input(const std::vector<double>& q_in, Result& result);
  // Takes the depth at q_in from the search's `overlaps`, unless contacts or distances are to be
  // reported: the verifier takes longer to measure deep overlaps than to find that there are some.
  void Overlaps(const std::vector<NearPair>& overlaps, Result& result) const;
  // The answer is `q`, which the verifier was last asked about and called free; `checked`: by
  // Check.
  struct Answered {
    const std::vector<double>& q;
    Component start;
    bool checked = false;
    std::optional<double> sigma = {};  // of q [m²]; none: it is computed
  };
  void Solved(const std::vector<double>& q_in, const Answered& answer, Result& result);
  // There is no answer: the result's q is the least overlap that the search found, or q_in moved
  // inside its limits where that is no worse by the verifier. `outcome` is null if nothing was
  // searched. `frozen`: pairs overlap that no movable joint can part.
  void Unsolved(const std::vector<double>& q_in, const Outcome* outcome, bool frozen,
                Result& result);
  // How exactly Unsolved measures overlaps.
  verify::Depths depths_of_unsolved = verify::Depths::kMeasured;
  // Whether contacts or distances are to be reported.
  bool Reports() const {
    return problem_.options.report_contacts || problem_.options.report_distances_to > 0.0;
  }

 private:
  bool MeasureInput(const std::vector<double>& q_in, Result& result);
  void FillFree(const std::vector<double>& q_in, Result& result);
  double Sigma(const std::vector<double>& q);
  void Answer(const Verdict& verdict, Result& result) const;
  void CountKeptContacts(Result& result) const;
  void AnswerUnmeasured(Result& result) const;
  void SayWhy(const Outcome* outcome, bool frozen, const Verdict& verdict, Result& result);

  const Problem& problem_;
  Workspace& work_;
  Verifier& verifier_;
  VectorXd q_;  // scratch
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_REPORT_H_
