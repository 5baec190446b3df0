#include "apps/solve/solve_page.h"

#include <algorithm>
#include <cmath>

#include "apps/html/shell_command.h"

namespace mjcf_pdg::app {

SolvePage::SolvePage(const CLI::App& command, const SolveArguments& arguments)
    : arguments_(arguments),
      given_(GivenOptions(command)),
      given_norm_(GivenNormOptions(command)),
      page_({"", {"depth mm", "rms mm"}, OptionsInForce(command)}) {}

void SolvePage::Begin(const std::string& model, const Scene& scene) {
  model_ = model;
  page_.BeginModel(model, scene);
}

void SolvePage::Add(const Scene& scene, const SolvedRow& solved) {
  PageRow row = SolvedPageRow(scene, arguments_.options.metric, solved);
  row.values = {std::max(0.0, -1e3 * solved.result.depth_in), 1e3 * std::sqrt(solved.result.sigma)};
  row.content["norm"] = NormCommand(model_, given_norm_);
  if (arguments_.options.trajectory) {  // a frame depends on those before it
    const bool found = solved.result.status != Status::kUnsolved;
    if (!found) unsolved_.push_back(motion_.size());
    motion_.push_back({solved.result.q, solved.row.label + (found ? "" : ": not solved")});
    motion_values_.resize(row.values.size(), 0.0);
    for (std::size_t k = 0; k < row.values.size(); ++k) {
      motion_values_[k] = std::max(motion_values_[k], row.values[k]);
    }
    row.content["note"] = InputNote() + ClockNote();
    row.content["command"] = AllRowsCommand() + " | sed -n " + std::to_string(motion_.size()) + "p";
  } else {
    const RowCommand command{{"solve", model_}, given_};
    row.content["command"] = command.Of(solved.row);
    row.content["trace"] = command.Of(solved.row, "--trace");
    row.content["note"] = ClockNote();
  }
  page_.Add(row);
}

// Makes all rows of a model again, a line of JSON each.
std::string SolvePage::AllRowsCommand() const {
  std::vector<std::string> again = {"solve", model_};
  again.insert(again.end(), given_.begin(), given_.end());
  const WhichArguments& which = arguments_.which;
  for (const std::string& key : which.keys) again.insert(again.end(), {"--key", key});
  for (const std::string& q : which.qpos) again.insert(again.end(), {"--qpos", q});
  if (!which.file.empty()) again.insert(again.end(), {"--qpos-file", which.file});
  again.insert(again.end(), {"--json", "-"});
  return ShellCommand(again);
}

// What is to be known of AllRowsCommand, in words.
std::string SolvePage::InputNote() const {
  return arguments_.which.file == "-" ? "It reads stdin: give it the same input again." : "";
}

// What is to be known of the command of one row.
std::string SolvePage::ClockNote() const {
  return std::isfinite(arguments_.options.time_limit)
             ? "A clock may have ended it (--time-limit), and then another run ends elsewhere."
             : "";
}

void SolvePage::End() {
  if (motion_.empty()) return;
  PageRow row = TrajectoryPageRow(motion_, unsolved_);
  row.values = motion_values_;
  row.content["command"] = AllRowsCommand();
  row.content["note"] = InputNote() + ClockNote();
  page_.Add(row);
  motion_.clear();
  unsolved_.clear();
  motion_values_.clear();
}

}  // namespace mjcf_pdg::app
