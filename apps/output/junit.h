// JUnit's XML, which CI servers show. It holds to both schemas that servers check: Ant's (Windy
// Road) and Jenkins' (junit-10).
#ifndef MJCF_PDG_APPS_OUTPUT_JUNIT_H_
#define MJCF_PDG_APPS_OUTPUT_JUNIT_H_

#include <ctime>
#include <string>
#include <vector>

namespace mjcf_pdg::app {

struct JunitCase {
  std::string name;
  std::string failure;   // in words; empty: passed
  double seconds = 0.0;  // that it took
  bool error = false;    // the failure is one to ask at all: the model does not load
};

struct JunitSuite {
  std::string name;
  std::vector<JunitCase> cases;
};

// `start`: when the run began. Bytes of names that are no UTF-8, and characters that XML does not
// have, are replaced.
std::string FormatJunit(const std::vector<JunitSuite>& suites, std::time_t start);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_JUNIT_H_
