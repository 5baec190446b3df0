// What a run of regress found: for people, programs and CI servers.
#ifndef MJCF_PDG_APPS_REGRESS_REGRESS_REPORT_H_
#define MJCF_PDG_APPS_REGRESS_REGRESS_REPORT_H_

#include <string>
#include <vector>

#include "apps/output/junit.h"
#include "apps/regress/golden.h"
#include "apps/regress/run_case.h"
#include "apps/regress/suite.h"

namespace mjcf_pdg::app {

struct SuiteRun {
  Suite suite;
  Golden golden;
  bool discovered = false;
  std::vector<CaseReport> reports;
};

// One line for every change, and one for every model that failed as a whole. Models are told with
// their suite where there are several.
std::string ReportTable(const std::vector<SuiteRun>& runs);
// JSON Lines: one for every row, one for every model.
std::string ReportJson(const std::vector<SuiteRun>& runs);
// A test suite for every model.
std::vector<JunitSuite> ReportJunit(const std::vector<SuiteRun>& runs);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REGRESS_REGRESS_REPORT_H_
