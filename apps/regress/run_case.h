// Solves the rows of one case of a suite and compares them with their golden results.
#ifndef MJCF_PDG_APPS_REGRESS_RUN_CASE_H_
#define MJCF_PDG_APPS_REGRESS_RUN_CASE_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/regress/golden.h"
#include "apps/solve/solve_rows.h"

namespace mjcf_pdg::app {

struct RowReport {
  GoldenRow now;
  std::optional<GoldenRow> before;  // none: there is no golden result
  Change change = Change::kNone;
  std::string reason;  // of an unsolved row, or of one that penetrates and did not before
  double seconds = 0.0;
};

struct CaseReport {
  std::string model;
  std::string error;  // why it could not be run: the model does not load, a file is missing
  std::vector<RowReport> rows;
  std::vector<GoldenRow> gone;  // rows that the golden results alone have
  Queries queries;
  std::optional<long long> new_queries;  // of the rows without golden results; none: no such row
  bool more_queries = false;             // than tolerated

  bool Failed() const;
};

// Is given each row when it is compared, with the iterations of its search.
using LookAtRow =
    std::function<void(const Scene& scene, const SolvedRow& solved, const RowReport& report)>;

struct CaseRun {
  std::size_t threads = 1;
  bool progress = false;  // a bar for its rows
  LookAtRow look = {};    // empty: nobody looks
};

// Never throws for what is wrong with the case: that is its report. `golden`: its model's rows.
CaseReport RunCase(const Suite& suite, const SuiteCase& one, const std::vector<GoldenRow>& golden,
                   const CaseRun& how);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REGRESS_RUN_CASE_H_
