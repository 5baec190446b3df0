#include "apps/output/junit.h"

#include <cstdio>

#include "apps/console/text.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

// An attribute with its name. Control characters are not allowed in XML, not even escaped.
std::string Attribute(const std::string& name, const std::string& value) {
  std::string out;
  for (const char c : OneLine(Utf8(value))) {
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
  // U+FFFE and U+FFFF are UTF-8, but no characters of XML.
  for (const char* none : {"\xEF\xBF\xBE", "\xEF\xBF\xBF"}) {
    for (std::size_t at; (at = out.find(none)) != std::string::npos;) out.replace(at, 3, "?");
  }
  return " " + name + "=\"" + out + "\"";
}

// The schemas' decimal numbers have no exponent, and those of Jenkins' test suites no more than
// three decimals.
std::string Seconds(double seconds, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, seconds);
  return text;
}

std::string DateTime(std::time_t time) {
  std::tm utc = {};
  gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  return text;
}

std::string FormatCase(const JunitSuite& suite, const JunitCase& one) {
  const std::string head = "    <testcase" + Attribute("classname", suite.name) +
                           Attribute("name", one.name) + Attribute("time", Seconds(one.seconds, 6));
  if (one.failure.empty()) return head + "/>\n";
  const std::string kind = one.error ? "error" : "failure";
  return head + "><" + kind + Attribute("type", kind) + Attribute("message", one.failure) +
         "/></testcase>\n";
}

}  // namespace

std::string FormatJunit(const std::vector<JunitSuite>& suites, std::time_t start) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  int id = 0;
  for (const JunitSuite& suite : suites) {
    int failures = 0, errors = 0;
    double seconds = 0.0;
    for (const JunitCase& one : suite.cases) {
      seconds += one.seconds;
      if (!one.failure.empty()) ++(one.error ? errors : failures);
    }
    text += "  <testsuite" + Attribute("name", suite.name) +
            Attribute("tests", std::to_string(suite.cases.size())) +
            Attribute("failures", std::to_string(failures)) +
            Attribute("errors", std::to_string(errors)) + Attribute("time", Seconds(seconds, 3)) +
            Attribute("timestamp", DateTime(start)) + Attribute("hostname", "localhost") +
            Attribute("package", "mjcf-pdg") + Attribute("id", std::to_string(id++)) +
            ">\n    <properties/>\n";
    for (const JunitCase& one : suite.cases) text += FormatCase(suite, one);
    text += "    <system-out/>\n    <system-err/>\n  </testsuite>\n";
  }
  return text + "</testsuites>\n";
}

}  // namespace mjcf_pdg::app
