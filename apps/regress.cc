// mjcf-pdg regress: solves suites of models again and says what has changed since their golden
// results.
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/console/interrupt.h"
#include "apps/console/progress.h"
#include "apps/console/text.h"
#include "apps/options.h"
#include "apps/output/junit.h"
#include "apps/output/output_files.h"
#include "apps/output/report.h"
#include "apps/regress/golden.h"
#include "apps/regress/run_case.h"
#include "apps/regress/suite.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct RegressArguments {
  std::vector<std::string> suites;
  std::string discover, json, junit;
  bool update = false;
  unsigned long long threads = 1;
};

struct SuiteRun {
  Suite suite;
  Golden golden;
  bool discovered = false;
  std::vector<CaseReport> reports;
};

// Every suite and its golden results, so that what is wrong with one is told before any work.
std::vector<SuiteRun> ReadSuites(const RegressArguments& arguments) {
  std::vector<SuiteRun> runs;
  for (const std::string& path : arguments.suites) runs.push_back({ReadSuite(path), {}, false, {}});
  if (!arguments.discover.empty()) {
    std::vector<std::string> skipped;
    runs.push_back({DiscoverSuite(arguments.discover, skipped), {}, true, {}});
    for (const std::string& words : skipped) WriteWarning("left out: " + words);
  }
  if (runs.empty()) throw Error("a suite is needed, or --discover DIR");
  std::set<fs::path> files;
  for (SuiteRun& run : runs) {
    std::error_code ec;
    if (!files.insert(fs::weakly_canonical(fs::absolute(run.suite.golden()), ec)).second) {
      throw Error(run.suite.path + ": its golden results are " + run.suite.golden() +
                  ", as those of a suite before it");
    }
    run.golden = ReadGolden(run.suite.golden());
  }
  return runs;
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

std::string ReportJson(const SuiteRun& run) {
  std::string text;
  for (const CaseReport& report : run.reports) {
    Json head = {{"suite", run.suite.path}, {"model", report.model}};
    for (const RowReport& row : report.rows) {
      Json json = head;
      json["row"] = row.now.name;
      json["change"] = NameOf(row.change);
      json["status"] = StatusName(row.now.status);
      json["sigma"] = row.now.sigma;
      json["queries"] = row.now.queries;
      if (row.before) {
        json["golden"] = {{"status", StatusName(row.before->status)},
                          {"sigma", row.before->sigma},
                          {"queries", row.before->queries}};
      }
      if (!row.reason.empty()) json["reason"] = row.reason;
      text += JsonLine(json);
    }
    for (const std::string& row : report.gone) {
      Json json = head;
      json["row"] = row;
      json["change"] = NameOf(Change::kGone);
      text += JsonLine(json);
    }
    head["failed"] = report.Failed();
    head["queries"] = report.queries.now;
    head["golden_queries"] = report.queries.before;
    if (!report.error.empty()) head["error"] = report.error;
    text += JsonLine(head);
  }
  return text;
}

JunitSuite ReportJunit(const CaseReport& report) {
  JunitSuite suite{report.model, {}};
  for (const RowReport& row : report.rows) {
    suite.cases.push_back({row.now.name, Words(row), row.seconds});
  }
  if (!report.error.empty()) suite.cases.push_back({"loads", report.error, 0.0});
  if (report.more_queries) suite.cases.push_back({"queries", QueryWords(report), 0.0});
  return suite;
}

// One line for every change, and one for every model that failed as a whole.
std::string ReportTable(const std::vector<SuiteRun>& runs) {
  Table table({"model", "row", "change", "golden", "now", "sigma m^2"});
  std::size_t rows = 0, regressions = 0, failed = 0, changes = 0;
  std::string errors;
  for (const SuiteRun& run : runs) {
    for (const CaseReport& report : run.reports) {
      rows += report.rows.size();
      failed += !report.error.empty();
      if (!report.error.empty()) errors += report.model + ": " + OneLine(report.error) + "\n";
      if (report.more_queries) errors += report.model + ": " + QueryWords(report) + "\n";
      for (const RowReport& row : report.rows) {
        regressions += IsRegression(row.change);
        if (row.change == Change::kNone || ++changes > kRowsShown) continue;
        table.AddRow({report.model, row.now.name, NameOf(row.change),
                      row.before ? Short(row.before->sigma) : "-", StatusName(row.now.status),
                      Short(row.now.sigma)});
      }
      for (const std::string& row : report.gone) {
        if (++changes <= kRowsShown) {
          table.AddRow({report.model, row, NameOf(Change::kGone), "", "", ""});
        }
      }
    }
  }
  std::string text = changes > 0 ? table.ToString() : "";
  if (changes > kRowsShown) {
    text += "... and " + std::to_string(changes - kRowsShown) + " changes that are not shown\n";
  }
  return text + errors + std::to_string(rows) + " rows, " + std::to_string(regressions) +
         " regressions, " + std::to_string(failed) + " models that failed\n";
}

// A model that failed keeps the golden results that it had.
Golden Updated(const SuiteRun& run) {
  Golden golden;
  for (const CaseReport& report : run.reports) {
    const auto before = run.golden.find(report.model);
    if (!report.error.empty()) {
      if (before != run.golden.end()) golden[report.model] = before->second;
      continue;
    }
    for (const RowReport& row : report.rows) golden[report.model].push_back(row.now);
  }
  return golden;
}

void AddOutputs(const RegressArguments& arguments, const std::vector<SuiteRun>& runs,
                OutputFiles& outputs) {
  std::vector<std::string> inputs = arguments.suites;
  outputs.Add("--json", arguments.json, inputs);
  outputs.Add("--junit", arguments.junit, inputs);
  if (!arguments.update) return;
  for (const SuiteRun& run : runs) {
    if (run.discovered) outputs.Add("--update", run.suite.path, inputs);
    outputs.Add("--update", run.suite.golden(), inputs);
  }
}

int RunRegress(const RegressArguments& arguments) {
  std::vector<SuiteRun> runs = ReadSuites(arguments);
  OutputFiles outputs;
  AddOutputs(arguments, runs, outputs);
  std::size_t cases = 0;
  for (const SuiteRun& run : runs) cases += run.suite.cases.size();
  bool failed = false;
  std::string json;
  std::vector<JunitSuite> junit;
  CatchInterrupts();
  {
    Progress progress("solving models", cases);
    for (SuiteRun& run : runs) {
      for (const SuiteCase& one : run.suite.cases) {
        run.reports.push_back(RunCase(run.suite, one, run.golden[one.model], arguments.threads));
        if (Interrupted()) return kExitSignal + Interrupted();
        const CaseReport& report = run.reports.back();
        failed |= arguments.update ? !report.error.empty() : report.Failed();
        junit.push_back(ReportJunit(report));
        progress.Step();
      }
      json += ReportJson(run);
    }
  }
  outputs.Stage(arguments.json, json);
  outputs.Stage(arguments.junit, FormatJunit(junit));
  if (arguments.update) {
    for (const SuiteRun& run : runs) {
      if (run.discovered) outputs.Stage(run.suite.path, FormatSuite(run.suite));
      outputs.Stage(run.suite.golden(), FormatGolden(run.suite, Updated(run)));
    }
  }
  outputs.Commit();
  if (!outputs.uses_stdout()) WriteStdout(ReportTable(runs));
  return failed ? kExitNotFree : kExitFree;
}

}  // namespace

Verb AddRegressVerb(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "regress", "Solve suites of models again and compare with their golden results");
  auto arguments = std::make_shared<RegressArguments>();
  command->add_option("SUITE", arguments->suites, "suites, as docs/regress.md describes them")
      ->type_name("FILE");
  AddPath(*command, "--discover", "the models below this folder, as a suite", arguments->discover)
      ->type_name("DIR");
  command->add_flag("--update", arguments->update,
                    "write the golden results (and DIR/pdg.json, with --discover)");
  AddInteger(*command, {"--threads", "N", "rows solved at once", {.low = 1.0, .high = 1024.0}},
             arguments->threads);
  AddJson(*command, arguments->json);
  AddPath(*command, "--junit", "write the results as JUnit's XML", arguments->junit);
  return {command, [arguments] { return RunRegress(*arguments); }};
}

}  // namespace mjcf_pdg::app
