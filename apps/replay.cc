// mjcf-pdg replay: recomputes what `solve --trace` has recorded, and stops at the first difference.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/console/text.h"
#include "apps/solve/solve_arguments.h"
#include "apps/solve/trace.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {
namespace {

struct ReplayArguments {
  std::string trace, model;
};

// A trace, line by line.
class TraceFile {
 public:
  explicit TraceFile(const std::string& path) : path_(path), file_(path) {
    if (!file_) throw Error(path + ": cannot be read");
  }

  bool Next(std::string& line) {
    if (!std::getline(file_, line)) return false;
    ++number_;
    return true;
  }

  std::string place() const { return path_ + " line " + std::to_string(number_); }

  // `read` with the place of the present line in front of its Error.
  template <typename Read>
  auto Placed(const Read& read) const {
    try {
      return read();
    } catch (const Error& e) {
      throw Error(place() + ": " + e.what());
    }
  }

 private:
  const std::string path_;
  std::ifstream file_;
  std::size_t number_ = 0;
};

// The options of the run that was recorded.
void ParseOptions(const TraceStart& start, SolveArguments& arguments) {
  CLI::App command;
  AddSolveFlags(command, arguments);
  std::vector<std::string> words = start.options;
  words.push_back(start.model);
  std::reverse(words.begin(), words.end());  // as CLI11 wants them
  try {
    command.parse(words);
  } catch (const CLI::Error& e) {
    throw Error(std::string("options: ") + e.what());
  }
  FinishSolveOptions(arguments);
  arguments.scene.model = start.model;
}

// One call of replay.
class Replay {
 public:
  explicit Replay(const ReplayArguments& arguments)
      : arguments_(arguments), file_(arguments.trace) {}

  int Run();

 private:
  // Recomputes the row whose first line is `first`. False at a difference, which is then in
  // difference_.
  bool Row(const Scene& scene, Solver& solver, const std::string& first);

  const ReplayArguments& arguments_;
  TraceFile file_;
  std::size_t rows_ = 0, iterations_ = 0;
  std::string difference_;
};

bool Replay::Row(const Scene& scene, Solver& solver, const std::string& first) {
  SolvedRow solved;
  SolvedRow* target = &solved;
  const TraceInput input = file_.Placed([&] { return ReadTraceInput(first); });
  solved.row = input.row;
  file_.Placed([&] {
    Watch(target, solver);
    solver.SetMocap(input.row.mocap_pos, input.row.mocap_quat);
    solver.Solve(input.row.q, solved.result);
    return 0;
  });
  std::istringstream now(TraceRow(scene, input.index, solved));
  std::string line, traced = first;
  std::getline(now, line);  // the input
  while (std::getline(now, line)) {
    if (!file_.Next(traced)) {
      throw Error(file_.place() + ": the trace ends within row " + std::to_string(input.index));
    }
    if (traced != line) {
      difference_ = file_.place() + ": " + TraceDifference(traced, line);
      return false;
    }
  }
  ++rows_;
  iterations_ += solved.iterations.size();
  return true;
}

int Replay::Run() {
  std::string line;
  if (!file_.Next(line)) throw Error(arguments_.trace + ": empty");
  TraceStart start = file_.Placed([&] { return ReadTraceHeader(line); });
  if (!arguments_.model.empty()) start.model = arguments_.model;
  SolveArguments arguments;
  file_.Placed([&] {
    ParseOptions(start, arguments);
    return 0;
  });
  const Scene scene = LoadScene(arguments.scene);
  Solver solver(scene, arguments.options);
  bool same = true;
  while (same && file_.Next(line)) same = Row(scene, solver, line);
  if (same && rows_ == 0) throw Error(arguments_.trace + ": there is no row in it");
  const bool versions = start.version == MJCF_PDG_VERSION && start.mujoco == mj_versionString();
  if (!versions) {
    WriteWarning("the trace is of mjcf-pdg " + start.version + " with MuJoCo " + start.mujoco +
                 ", this is " MJCF_PDG_VERSION " with " + mj_versionString());
  }
  WriteStdout(same ? "the same: " + std::to_string(rows_) + " rows, " +
                         std::to_string(iterations_) + " iterations\n"
                   : "different after " + std::to_string(rows_) + " rows that are the same\n" +
                         difference_ + "\n");
  return same ? kExitFree : kExitNotFree;
}

}  // namespace

Verb AddReplayVerb(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "replay", "Recompute a trace of solve --trace, up to the first difference");
  auto arguments = std::make_shared<ReplayArguments>();
  AddPath(*command, "TRACE", "what solve --trace has written", arguments->trace)->required();
  AddPath(*command, "--model", "where the model is now, if not where it was", arguments->model);
  command->footer("Exit codes: 0 the same, 3 different, 2 bad input, 1 other.");
  return {command, [arguments] { return Replay(*arguments).Run(); }};
}

}  // namespace mjcf_pdg::app
