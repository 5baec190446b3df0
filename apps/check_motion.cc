#include "apps/check_motion.h"

#include <algorithm>

#include "apps/cli.h"
#include "apps/console/text.h"
#include "apps/html/checked_row.h"
#include "apps/html/shell_command.h"
#include "apps/output/output_files.h"
#include "apps/output/report.h"
#include "mjcf_pdg/motion.h"

namespace mjcf_pdg::app {
namespace {

const char* OutcomeName(MotionOutcome outcome) {
  switch (outcome) {
    case MotionOutcome::kFree:
      return "free";
    case MotionOutcome::kContact:
      return "contact";
    case MotionOutcome::kStartInCollision:
      return "start_in_collision";
    case MotionOutcome::kLimit:
      return "limit";
    case MotionOutcome::kBudget:
      break;
  }
  return "budget";
}

std::string MotionJson(const Scene& scene, const Motion& motion) {
  nlohmann::ordered_json json = {{"outcome", OutcomeName(motion.outcome)},
                                 {"t", motion.t},
                                 {"qpos", motion.q},
                                 {"certified", motion.certified}};
  json["pairs"] = nlohmann::ordered_json::array();
  for (const std::array<int, 2>& pair : motion.pairs) {
    json["pairs"].push_back(
        {{"geom1", GeomJson(scene, pair[0])}, {"geom2", GeomJson(scene, pair[1])}});
  }
  if (motion.joint >= 0) json["joint"] = scene.JointName(motion.joint);
  json["poses"] = motion.poses;
  json["distance_queries"] = motion.distance_queries;
  return JsonLine(json);
}

// What a straight motion does not hold; empty: nothing.
std::string LeftAside(const Scene& scene) {
  const bool equalities = !scene.HeldEqualities().empty();
  if (!equalities && !scene.HoldsTendonLimits()) return "";
  return std::string("is checked for collisions and joint limits, and leaves ") +
         (equalities ? "the model's equality constraints" : "tendon limits") + " aside";
}

// Says in words how far the motion is free and what ends it.
std::string Sentence(const Scene& scene, const Motion& motion) {
  const std::string at = "free up to t = " + Short(motion.t) + ": ";
  switch (motion.outcome) {
    case MotionOutcome::kFree:
      return "free all the way";
    case MotionOutcome::kContact:
      return at + "these are in the way";
    case MotionOutcome::kStartInCollision:
      return "not free where it starts: these overlap";
    case MotionOutcome::kLimit:
      return at + "joint " + OneLine(scene.JointName(motion.joint)) + " reaches its limit";
    case MotionOutcome::kBudget:
      break;
  }
  return at + "what follows takes too many steps to prove";
}

std::string MotionText(const Scene& scene, const Motion& motion) {
  std::string text =
      "motion " + Sentence(scene, motion) + (motion.certified ? "" : " (not certified)") + "\n";
  if (!motion.pairs.empty()) {
    Table table({"geom 1", "geom 2"});
    for (const std::array<int, 2>& pair : motion.pairs) {
      table.AddRow({scene.GeomName(pair[0]), scene.GeomName(pair[1])});
    }
    text += table.ToString();
  }
  return text + "poses " + std::to_string(motion.poses) + ", distance queries " +
         std::to_string(motion.distance_queries) + "\n";
}

// More than how far apart a motion leaves what is in its way (four) [tolerances].
constexpr double kStopBand = 8.0;

// What is in the way where the motion stops, or overlaps where it starts: of its pairs, those that
// are within the tolerance of `near`.
std::vector<Contact> ContactsAtStop(const Scene& scene, const std::vector<double>& from,
                                    const Motion& motion, const Options& near) {
  if (motion.pairs.empty()) return {};
  std::vector<Contact> contacts = Verify(scene, motion.q, near, &from).contacts;
  std::erase_if(contacts, [&](const Contact& contact) {
    return std::find(motion.pairs.begin(), motion.pairs.end(), contact.geom) == motion.pairs.end();
  });
  return contacts;
}

std::string MotionPage(const CLI::App& command, const MotionArguments& arguments,
                       const Scene& scene, const Motion& motion) {
  const std::string& model = arguments.scene.model;
  const Ends ends = ReadEnds(scene, arguments.ends);
  std::vector<std::string> again = {
      "check", model, "--motion", "--from", arguments.ends.from, "--to", arguments.ends.to};
  for (const std::string& option : GivenOptions(command)) again.push_back(option);
  again.insert(again.end(), {"--json", "-"});
  Page page({"", {}, OptionsInForce(command)});
  page.BeginModel(model, scene);
  Options near = arguments.options;
  near.tolerance = std::min(1.0, kStopBand * near.tolerance);
  PageRow row =
      MotionPageRow(scene, {ends, motion, ContactsAtStop(scene, ends.from, motion, near)});
  if (motion.outcome != MotionOutcome::kFree) row.content["reason"] = Sentence(scene, motion);
  row.content["command"] = ShellCommand(again);
  for (PageTable& table : row.tables) table.command = ShellCommand(again);
  RowCommand stop{{"check", model}, GivenOptions(command, {"--tolerance"})};
  stop.options.insert(stop.options.end(), {"--tolerance", nlohmann::json(near.tolerance).dump()});
  Configuration at;
  at.q = motion.q;
  row.content["stop"] = stop.Of(at);
  const std::string aside = LeftAside(scene);
  if (!aside.empty()) row.content["note"] = "It " + aside + ".";
  row.content["norm"] = NormCommand(model, GivenNormOptions(command));
  page.Add(row);
  return page.ToString();
}

}  // namespace

int RunCheckMotion(const CLI::App& command, const MotionArguments& arguments) {
  const Scene scene = LoadScene(arguments.scene);
  const Ends ends = ReadEnds(scene, arguments.ends);
  const std::string aside = LeftAside(scene);
  if (!aside.empty()) WriteWarning("the straight motion " + aside);
  OutputFiles outputs;
  outputs.Add("--json", arguments.json, {arguments.scene.model});
  outputs.Add("--html", arguments.html, {arguments.scene.model});
  const Motion motion = CheckMotion(scene, ends.from, ends.to, arguments.options);
  if (!arguments.json.empty()) outputs.Stage(arguments.json, MotionJson(scene, motion));
  if (!arguments.html.empty()) {
    outputs.Stage(arguments.html, MotionPage(command, arguments, scene, motion));
  }
  outputs.Commit();
  if (!outputs.uses_stdout()) WriteStdout(MotionText(scene, motion));
  return motion.outcome == MotionOutcome::kFree ? kExitFree : kExitNotFree;
}

}  // namespace mjcf_pdg::app
