#include "apps/output/junit.h"

#include <algorithm>

#include "apps/console/text.h"

namespace mjcf_pdg::app {
namespace {

// An attribute's value. Control characters are not allowed in XML, not even escaped.
std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : OneLine(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace

std::string FormatJunit(const std::vector<JunitSuite>& suites) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const JunitSuite& suite : suites) {
    const auto failures = std::count_if(suite.cases.begin(), suite.cases.end(),
                                        [](const JunitCase& one) { return !one.failure.empty(); });
    const std::string name = Escaped(suite.name);
    text += "  <testsuite name=\"" + name + "\" tests=\"" + std::to_string(suite.cases.size()) +
            "\" failures=\"" + std::to_string(failures) + "\">\n";
    for (const JunitCase& one : suite.cases) {
      text += "    <testcase classname=\"" + name + "\" name=\"" + Escaped(one.name) +
              "\" time=\"" + Short(one.seconds) + "\"";
      text += one.failure.empty()
                  ? "/>\n"
                  : "><failure message=\"" + Escaped(one.failure) + "\"/></testcase>\n";
    }
    text += "  </testsuite>\n";
  }
  return text + "</testsuites>\n";
}

}  // namespace mjcf_pdg::app
