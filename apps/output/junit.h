// JUnit's XML, which CI servers show.
#ifndef MJCF_PDG_APPS_OUTPUT_JUNIT_H_
#define MJCF_PDG_APPS_OUTPUT_JUNIT_H_

#include <string>
#include <vector>

namespace mjcf_pdg::app {

struct JunitCase {
  std::string name;
  std::string failure;  // in words; empty: passed
  double seconds = 0.0;
};

struct JunitSuite {
  std::string name;
  std::vector<JunitCase> cases;
};

std::string FormatJunit(const std::vector<JunitSuite>& suites);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_JUNIT_H_
