#include "apps/regress/regress_report.h"

#include "apps/console/text.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

// Two suites may have models of the same name.
std::string ModelName(const std::vector<SuiteRun>& runs, const SuiteRun& run,
                      const CaseReport& report) {
  return runs.size() > 1 ? run.suite.path + ": " + report.model : report.model;
}

std::string Words(const RowReport& row) {
  if (!IsRegression(row.change)) return "";
  const std::string before =
      std::string(StatusName(row.before->status)) + ", sigma " + Short(row.before->sigma);
  return std::string(NameOf(row.change)) + ": was " + before + ", is " +
         StatusName(row.now.status) + ", sigma " + Short(row.now.sigma) +
         (row.reason.empty() ? "" : ": " + row.reason);
}

std::string QueryWords(const CaseReport& report) {
  return "queries: " + std::to_string(report.queries.now) + ", were " +
         std::to_string(report.queries.before);
}

Json GoldenJson(const GoldenRow& row) {
  return {{"status", StatusName(row.status)}, {"sigma", row.sigma}, {"queries", row.queries}};
}

std::string CaseJson(const SuiteRun& run, const CaseReport& report) {
  std::string text;
  Json head = {{"suite", run.suite.path}, {"model", report.model}};
  for (const RowReport& row : report.rows) {
    Json json = head;
    json["row"] = row.now.name;
    json["change"] = NameOf(row.change);
    json["status"] = StatusName(row.now.status);
    json["sigma"] = row.now.sigma;
    json["queries"] = row.now.queries;
    if (row.before) json["golden"] = GoldenJson(*row.before);
    if (!row.reason.empty()) json["reason"] = row.reason;
    text += JsonLine(json);
  }
  for (const GoldenRow& row : report.gone) {
    Json json = head;
    json["row"] = row.name;
    json["change"] = NameOf(Change::kGone);
    json["golden"] = GoldenJson(row);
    text += JsonLine(json);
  }
  head["failed"] = report.Failed();
  head["queries"] = report.queries.now;
  head["golden_queries"] = report.queries.before;
  if (report.new_queries) head["new_queries"] = *report.new_queries;
  if (!report.error.empty()) head["error"] = report.error;
  return text + JsonLine(head);
}

// Of all models: the lines of the table of changes, and what is said below it.
struct Summary {
  Table table{{"model", "row", "change", "golden", "now", "sigma m^2"}};
  std::size_t rows = 0, regressions = 0, failed = 0, slower = 0, changes = 0;
  std::string errors;

  void AddChange(const std::vector<std::string>& cells) {
    if (++changes <= kRowsShown) table.AddRow(cells);
  }
  void Add(const std::string& model, const CaseReport& report) {
    rows += report.rows.size();
    failed += !report.error.empty();
    slower += report.more_queries;
    if (!report.error.empty()) errors += model + ": " + OneLine(report.error) + "\n";
    if (report.more_queries) errors += model + ": " + QueryWords(report) + "\n";
    for (const RowReport& row : report.rows) {
      regressions += IsRegression(row.change);
      if (row.change == Change::kNone) continue;
      if (IsRegression(row.change) && !row.reason.empty()) {
        errors += model + ": " + row.now.name + ": " + OneLine(row.reason) + "\n";
      }
      AddChange({model, row.now.name, NameOf(row.change),
                 row.before ? Short(row.before->sigma) : "-", StatusName(row.now.status),
                 Short(row.now.sigma)});
    }
    for (const GoldenRow& row : report.gone) {
      AddChange({model, row.name, NameOf(Change::kGone), "", "", ""});
    }
  }
};

}  // namespace

std::string ReportJson(const std::vector<SuiteRun>& runs) {
  std::string text;
  for (const SuiteRun& run : runs) {
    for (const CaseReport& report : run.reports) text += CaseJson(run, report);
  }
  return text;
}

std::vector<JunitSuite> ReportJunit(const std::vector<SuiteRun>& runs) {
  std::vector<JunitSuite> suites;
  for (const SuiteRun& run : runs) {
    for (const CaseReport& report : run.reports) {
      JunitSuite suite{ModelName(runs, run, report), {}};
      for (const RowReport& row : report.rows) {
        suite.cases.push_back({row.now.name, Words(row), row.seconds});
      }
      if (!report.error.empty()) suite.cases.push_back({"loads", report.error, 0.0, true});
      if (report.more_queries) suite.cases.push_back({"queries", QueryWords(report)});
      suites.push_back(std::move(suite));
    }
  }
  return suites;
}

std::string ReportTable(const std::vector<SuiteRun>& runs) {
  Summary all;
  for (const SuiteRun& run : runs) {
    for (const CaseReport& report : run.reports) all.Add(ModelName(runs, run, report), report);
  }
  std::string text = all.changes > 0 ? all.table.ToString() : "";
  if (all.changes > kRowsShown) {
    text += "... and " + std::to_string(all.changes - kRowsShown) + " changes that are not shown\n";
  }
  return text + all.errors + std::to_string(all.rows) + " rows, " +
         std::to_string(all.regressions) + " regressions, " + std::to_string(all.failed) +
         " models that failed, " + std::to_string(all.slower) + " that take more queries\n";
}

}  // namespace mjcf_pdg::app
