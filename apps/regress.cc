// mjcf-pdg regress: solves suites of models again and says what has changed since their golden
// results.
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/console/interrupt.h"
#include "apps/console/progress.h"
#include "apps/console/text.h"
#include "apps/html/shell_command.h"
#include "apps/input/plugins.h"
#include "apps/options.h"
#include "apps/output/output_files.h"
#include "apps/regress/discover.h"
#include "apps/regress/regress_page.h"
#include "apps/regress/regress_report.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

// What the report of --update says of what it compares with.
constexpr const char* kReplaced =
    "This run wrote new golden results (--update), and rows are compared with those here. A run "
    "without --update, before it, shows what changes. A model that failed keeps its golden "
    "results, and its rows are not here.";

struct RegressArguments {
  std::vector<std::string> suites;
  std::string discover, json, junit, html;
  bool update = false;
  unsigned long long threads = 1;
};

// Every suite and its golden results, so that what is wrong with one is told before any work.
std::vector<SuiteRun> ReadSuites(const RegressArguments& arguments) {
  std::vector<SuiteRun> runs;
  std::vector<std::string> warnings;
  for (const std::string& path : arguments.suites) runs.push_back({ReadSuite(path), {}, false, {}});
  if (!arguments.discover.empty()) {
    runs.push_back({DiscoverSuite(arguments.discover, warnings), {}, true, {}});
    for (std::string& words : warnings) words = "left out: " + words;
  }
  if (runs.empty()) throw Error("a suite is needed, or --discover DIR");
  std::set<fs::path> files;
  for (SuiteRun& run : runs) {
    std::error_code ec;
    const std::string path = run.suite.golden();
    if (!files.insert(fs::weakly_canonical(fs::absolute(path), ec)).second) {
      throw Error(run.suite.path + ": its golden results are " + path +
                  ", as those of a suite before it");
    }
    run.golden = ReadGolden(path);
    if (!arguments.update && !fs::exists(path, ec)) {
      warnings.push_back(path + ": no such file, so nothing to compare with (--update makes it)");
    }
  }
  for (const std::string& words : warnings) WriteWarning(words);
  return runs;
}

// Golden results of models that the suite does not have (any more).
void AddGoneModels(SuiteRun& run, const std::function<void(const CaseReport&)>& end) {
  std::set<std::string> models;
  for (const SuiteCase& one : run.suite.cases) models.insert(one.model);
  for (const auto& [model, rows] : run.golden) {
    if (models.contains(model)) continue;
    CaseReport report;
    report.model = model;
    for (const GoldenRow& row : rows) report.gone.push_back(row);
    run.reports.push_back(std::move(report));
    end(run.reports.back());
  }
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

// Everything that a run reads: no report may be written over it.
std::vector<std::string> Inputs(const std::vector<SuiteRun>& runs) {
  std::vector<std::string> inputs;
  for (const SuiteRun& run : runs) {
    inputs.push_back(run.suite.path);
    inputs.push_back(run.suite.golden());
    for (const SuiteCase& one : run.suite.cases) {
      inputs.push_back((run.suite.folder / one.model).string());
      for (const SuiteRows& rows : one.rows) {
        if (!rows.file.empty()) inputs.push_back((run.suite.folder / rows.file).string());
      }
    }
  }
  return inputs;
}

void AddOutputs(const RegressArguments& arguments, const std::vector<SuiteRun>& runs,
                OutputFiles& outputs) {
  const std::vector<std::string> inputs = Inputs(runs);
  outputs.Add("--json", arguments.json, inputs);
  outputs.Add("--junit", arguments.junit, inputs);
  outputs.Add("--html", arguments.html, inputs);
  if (!arguments.update) return;
  for (const SuiteRun& run : runs) {
    if (run.discovered) outputs.Add("--update", run.suite.path, arguments.suites);
    outputs.Add("--update", run.suite.golden(), arguments.suites);
  }
}

// A row, and a model, as a run after --update reports them.
RowReport Renewed(RowReport report) {
  report.before = Kept(report.now);
  report.change = Change::kNone;
  return report;
}

CaseReport Renewed(CaseReport report) {
  report.gone.clear();
  report.queries.now += report.new_queries.value_or(0);
  report.queries.before = report.queries.now;
  report.queries.rows = report.rows.size();
  report.new_queries.reset();
  report.more_queries = false;
  return report;
}

// Shows a model when it is done. After --update one that the suite has no more is not there, and
// one that failed has no rows: they would be compared with results that were not written.
void EndModel(const Suite& suite, const CaseReport& report, bool update, RegressPage& page) {
  if (!update) return page.End(suite, report);
  if (!report.error.empty()) {
    page.DropRows();
    CaseReport failed;
    failed.model = report.model;
    failed.error = report.error;
    return page.End(suite, failed);
  }
  if (!report.rows.empty()) page.End(suite, Renewed(report));
}

// False if it was interrupted. `page` gets all rows, unless it is null.
bool RunSuites(std::vector<SuiteRun>& runs, const RegressArguments& arguments, RegressPage* page) {
  const auto look = [&](const Scene& scene, const SolvedRow& solved, const RowReport& report) {
    page->Add(scene, solved, arguments.update ? Renewed(report) : report);
  };
  std::size_t cases = 0;
  for (const SuiteRun& run : runs) cases += run.suite.cases.size();
  Progress progress("solving models", cases);  // of a single one its rows are shown
  for (SuiteRun& run : runs) {
    CaseRun how{arguments.threads, cases == 1};
    if (page) how.look = look;
    const auto end = [&](const CaseReport& report) {
      if (page) EndModel(run.suite, report, arguments.update, *page);
    };
    for (const SuiteCase& one : run.suite.cases) {
      if (page) page->Begin(run.suite, one);
      run.reports.push_back(RunCase(run.suite, one, run.golden[one.model], how));
      if (Interrupted()) return false;
      end(run.reports.back());
      progress.Step();
    }
    AddGoneModels(run, end);
  }
  return true;
}

// The command line that runs the suites again.
std::string Again(const CLI::App& command, const RegressArguments& arguments) {
  std::vector<std::string> words = {"regress"};
  const auto append = [&](const std::vector<std::string>& list) {
    words.insert(words.end(), list.begin(), list.end());
  };
  append(arguments.suites);
  if (!arguments.discover.empty()) append({"--discover", arguments.discover});
  append(GivenOptions(command));
  append({"--json", "-"});
  return ShellCommand(words);
}

int RunRegress(const CLI::App& command, const RegressArguments& arguments) {
  const std::time_t start = std::time(nullptr);
  std::vector<SuiteRun> runs = ReadSuites(arguments);
  OutputFiles outputs;
  AddOutputs(arguments, runs, outputs);
  CatchInterrupts();
  std::unique_ptr<RegressPage> page;
  if (!arguments.html.empty()) {
    page = std::make_unique<RegressPage>(
        RegressPageHead{Again(command, arguments), arguments.update ? kReplaced : "",
                        GivenNormOptions(command), runs.size() > 1});
  }
  if (!RunSuites(runs, arguments, page.get()))
    return SayInterrupted("before the end: nothing was written");
  if (page) outputs.Stage(arguments.html, page->ToString());
  outputs.Stage(arguments.json, ReportJson(runs));
  outputs.Stage(arguments.junit, FormatJunit(ReportJunit(runs), start));
  bool failed = false;
  for (const SuiteRun& run : runs) {
    for (const CaseReport& report : run.reports) {
      failed |= arguments.update ? !report.error.empty() : report.Failed();
    }
    if (!arguments.update) continue;
    if (run.discovered) outputs.Stage(run.suite.path, FormatSuite(run.suite));
    outputs.Stage(run.suite.golden(), FormatGolden(run.suite, Updated(run)));
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
  AddPlugins(*command);
  AddInteger(*command, {"--threads", "N", "rows solved at once", {.low = 1.0, .high = 1024.0}},
             arguments->threads);
  AddJson(*command, arguments->json);
  AddPath(*command, "--junit", "write the results as JUnit's XML", arguments->junit);
  AddHtml(*command, arguments->html);
  return {command, [command, arguments] { return RunRegress(*command, *arguments); }};
}

}  // namespace mjcf_pdg::app
