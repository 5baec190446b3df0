// mjcf-pdg audit: what is wrong with a model, whatever it is used for.
#include <ctime>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/audit/audit_page.h"
#include "apps/audit/examine.h"
#include "apps/audit/mended_text.h"
#include "apps/cli.h"
#include "apps/console/interrupt.h"
#include "apps/console/progress.h"
#include "apps/console/text.h"
#include "apps/html/shell_command.h"
#include "apps/input/plugins.h"
#include "apps/options.h"
#include "apps/output/junit.h"
#include "apps/output/output_files.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

struct AuditArguments {
  SceneArguments scene;
  std::vector<std::string> models;
  AuditOptions options;
  unsigned long long samples = 1000, seed = 0;
  std::string fix, json, junit, html;
};

// A model and what was found, or why it could not be looked at.
struct ModelAudit {
  std::string model, error;
  Audit audit;
  std::shared_ptr<const Scene> scene;

  bool Wrong() const { return !error.empty() || audit.Wrong(); }
};

std::string AuditJson(const ModelAudit& one) {
  Json json = {{"model", one.model}};
  if (!one.error.empty()) {
    json["error"] = one.error;
    return JsonLine(json);
  }
  const Audit& audit = one.audit;
  json["samples"] = audit.samples;
  json["pairs"] = Json::array();
  for (const AuditedPair& pair : audit.pairs) {
    json["pairs"].push_back({{"geom1", GeomJson(*one.scene, pair.geom1)},
                             {"geom2", GeomJson(*one.scene, pair.geom2)},
                             {"class", NameOf(pair.kind)},
                             {"share", pair.share},
                             {"count", pair.count},
                             {"depth", pair.deepest.distance},
                             {"deepest_in", pair.where.label}});
  }
  json["never"] = audit.never;
  // With 95 % confidence a pair never seen to overlap does so in a smaller share of configurations.
  json["never_share_below"] = audit.never_share;
  json["exclude"] = Json::array();
  for (const auto& [body1, body2] : audit.exclude) json["exclude"].push_back({body1, body2});
  json["keyframes"] = Json::array();
  for (const AuditedKey& key : audit.keys) {
    json["keyframes"].push_back({{"name", key.of.label},
                                 {"depth", key.depth},
                                 {"limit_excess", key.limit_excess},
                                 {"equality_residual", key.equality_residual},
                                 {"force_over_weight", key.force_over_weight}});
  }
  json["warnings"] = audit.warnings;
  return JsonLine(json);
}

std::string Excludes(const Audit& audit) {
  std::string lines;
  for (const auto& [body1, body2] : audit.exclude)
    lines += "    " + ExcludeLine(body1, body2) + "\n";
  return lines;
}

std::string AuditText(const ModelAudit& one) {
  std::string text = one.model + "\n";
  if (!one.error.empty()) return text + "  " + OneLine(one.error) + "\n";
  const Audit& audit = one.audit;
  Table pairs({"  pair", "", "overlaps", "share %", "depth mm"});
  for (const AuditedPair& pair : audit.pairs) {
    pairs.AddRow({"  " + one.scene->GeomName(pair.geom1), one.scene->GeomName(pair.geom2),
                  NameOf(pair.kind), Short(100.0 * pair.share),
                  Short(-1e3 * pair.deepest.distance)});
  }
  if (!audit.pairs.empty()) text += pairs.ToString();
  text += "  " + std::to_string(audit.never) + " pairs never overlap in " +
          std::to_string(audit.samples) + " configurations (in less than " +
          Short(100.0 * audit.never_share) + " % of all, with 95 % confidence)\n";
  Table keys({"  keyframe", "depth mm", "limit excess", "equality residual", "force/weight", ""});
  for (const AuditedKey& key : audit.keys) {
    keys.AddRow({"  " + key.of.label, Short(1e3 * key.depth), Short(key.limit_excess),
                 Short(key.equality_residual), Short(key.force_over_weight),
                 key.Wrong() ? "wrong" : ""});
  }
  text += keys.ToString();
  for (const std::string& warning : audit.warnings) text += "  " + OneLine(warning) + "\n";
  if (!audit.exclude.empty()) {
    text += "  No joint parts these; MuJoCo leaves them out with\n  <contact>\n" + Excludes(audit) +
            "  </contact>\n";
  }
  return text;
}

JunitSuite AuditJunit(const ModelAudit& one) {
  JunitSuite suite{one.model, {}};
  suite.cases.push_back({"loads", one.error, 0.0, true});
  if (!one.error.empty()) return suite;
  std::string wrong;
  for (const AuditedPair& pair : one.audit.pairs) {
    if (pair.kind == Overlap::kSometimes) continue;
    wrong += (wrong.empty() ? "" : "; ") + one.scene->GeomName(pair.geom1) + " and " +
             one.scene->GeomName(pair.geom2) + ": " + NameOf(pair.kind);
  }
  suite.cases.push_back({"pairs", wrong});
  for (const AuditedKey& key : one.audit.keys) {
    const std::string failure = "depth " + Short(1e3 * key.depth) + " mm, limits exceeded by " +
                                Short(key.limit_excess) + ", equalities violated by " +
                                Short(key.equality_residual);
    suite.cases.push_back({"keyframe " + key.of.label, key.Wrong() ? failure : ""});
  }
  return suite;
}

ModelAudit AuditModel(const std::string& model, const AuditArguments& arguments) {
  ModelAudit one{model, "", {}, nullptr};
  try {
    one.scene = std::make_shared<Scene>(Scene::FromFile(model, arguments.scene.options));
    one.audit = Examine(*one.scene, arguments.options);
  } catch (const Error& e) {
    one.error = e.what();
  } catch (const std::exception& e) {  // of MuJoCo, or out of memory: no other model suffers
    one.error = model + ": " + e.what();
  }
  return one;
}

// The report of --html, which holds what `page` has been given.
class AuditPage {
 public:
  AuditPage(const CLI::App& command, const AuditArguments& arguments)
      : check_options_(GivenOptions(command, {"--samples", "--seed"})),
        page_({Again(command, arguments), kAuditColumns, OptionsInForce(command)}) {}

  void Add(const ModelAudit& one) {
    if (one.error.empty()) {
      AddAudit(one.model, *one.scene, one.audit, check_options_, page_);
    } else {
      AddUnaudited(one.model, one.error, page_);
    }
  }
  std::string ToString() const { return page_.ToString(); }

 private:
  static std::string Again(const CLI::App& command, const AuditArguments& arguments) {
    std::vector<std::string> words = {"audit"};
    words.insert(words.end(), arguments.models.begin(), arguments.models.end());
    for (const std::string& option : GivenOptions(command)) words.push_back(option);
    words.insert(words.end(), {"--json", "-"});
    return ShellCommand(words);
  }

  const std::vector<std::string> check_options_;  // those that check has, too
  Page page_;
};

// Returns what was mended, as a line of the text.
std::string StageMended(const ModelAudit& one, const AuditArguments& arguments,
                        OutputFiles& outputs) {
  MendOptions options{arguments.fix, arguments.scene.options, {}};
  options.solve.tolerance = arguments.options.tolerance;
  const MendedModel mended = Mended(one.model, one.audit, options);
  for (const std::string& words : mended.left) WriteWarning("--fix: " + words);
  outputs.Stage(arguments.fix, mended.text);
  return "  mended in " + arguments.fix + ": " + mended.done + "\n";
}

int RunAudit(const CLI::App& command, AuditArguments& arguments) {
  const std::time_t start = std::time(nullptr);
  arguments.options.samples = arguments.samples;
  arguments.options.seed = arguments.seed;
  if (!arguments.fix.empty() && arguments.models.size() > 1) {
    throw Error("--fix is for a single model");
  }
  OutputFiles outputs;
  outputs.Add("--fix", arguments.fix, arguments.models);
  outputs.Add("--json", arguments.json, arguments.models);
  outputs.Add("--junit", arguments.junit, arguments.models);
  outputs.Add("--html", arguments.html, arguments.models);
  std::optional<AuditPage> page;
  if (!arguments.html.empty()) page.emplace(command, arguments);
  std::string json, text;
  std::vector<JunitSuite> junit;
  bool wrong = false;
  CatchInterrupts();
  {
    Progress progress("auditing", arguments.models.size());
    for (const std::string& model : arguments.models) {
      const ModelAudit one = AuditModel(model, arguments);
      if (Interrupted()) return SayInterrupted("before the end: nothing was written");
      // The only model that cannot be loaded is bad input; among others it is a finding.
      if (!one.error.empty() && arguments.models.size() == 1) throw Error(one.error);
      const std::string mended = arguments.fix.empty() ? "" : StageMended(one, arguments, outputs);
      if (page) page->Add(one);
      wrong |= one.Wrong();
      json += AuditJson(one);
      text += AuditText(one) + mended;
      junit.push_back(AuditJunit(one));
      progress.Step();
    }
  }
  outputs.Stage(arguments.json, json);
  outputs.Stage(arguments.junit, FormatJunit(junit, start));
  if (page) outputs.Stage(arguments.html, page->ToString());
  outputs.Commit();
  if (!outputs.uses_stdout()) WriteStdout(text);
  return wrong ? kExitNotFree : kExitFree;
}

}  // namespace

Verb AddAuditVerb(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "audit", "Report pairs that overlap always or by default, and keyframes that are wrong");
  auto arguments = std::make_shared<AuditArguments>();
  AddModels(*command, arguments->models);
  AddPlugins(*command);
  AddExactMesh(*command, arguments->scene);
  AddModelRules(*command, arguments->scene);
  AddNumber(*command,
            {"--tolerance", "M", "overlap that still counts as free", {.above_low = true}},
            arguments->options.tolerance);
  AddInteger(*command,
             {"--samples", "N", "random configurations inside limits", {.low = 10.0, .high = 1e9}},
             arguments->samples);
  AddInteger(*command, {"--seed", "N", "of the random configurations", {.high = 1e18}},
             arguments->seed);
  AddPath(*command, "--fix",
          "write the model with <exclude> lines for what no joint parts and repaired keyframes",
          arguments->fix);
  AddJson(*command, arguments->json);
  AddPath(*command, "--junit", "write the findings as JUnit's XML", arguments->junit);
  AddHtml(*command, arguments->html);
  return {command, [command, arguments] { return RunAudit(*command, *arguments); }};
}

}  // namespace mjcf_pdg::app
