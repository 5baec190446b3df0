// mjcf-pdg solve: finds the nearest free configuration for every configuration (row) asked about.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli.h"
#include "apps/console/interrupt.h"
#include "apps/console/progress.h"
#include "apps/console/text.h"
#include "apps/input/configurations.h"
#include "apps/input/npy.h"
#include "apps/input/qpos_file.h"
#include "apps/output/output_files.h"
#include "apps/output/repaired_mjcf.h"
#include "apps/output/report.h"
#include "apps/solve/resume.h"
#include "apps/solve/scene_output.h"
#include "apps/solve/solve_arguments.h"
#include "apps/solve/solve_page.h"
#include "apps/solve/solve_rows.h"
#include "apps/solve/trace.h"
#include "mjcf_pdg/pdg.h"
#ifdef MJCF_PDG_HAVE_RENDER
#include "apps/picture/animation.h"
#include "apps/picture/egl_context.h"
#include "apps/picture/motion_shots.h"
#include "apps/picture/render.h"
#include "apps/picture/row_picture.h"
#endif

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

void CheckSmooth(const SolveArguments& arguments) {
  if (!arguments.options.trajectory) throw Error("--smooth needs --trajectory");
  if (arguments.options.method == Method::kPaper) throw Error("--smooth needs --method auto");
  if (arguments.time_limit_ms < std::numeric_limits<double>::infinity()) {
    throw Error("--smooth seeks all frames together, --time-limit is per row");
  }
}

// What goes with one model only, or not with rows of an earlier run.
void CheckCombination(const SolveArguments& arguments) {
  for (const auto& [flag, path] : {std::pair{"--out-qpos", &arguments.out_qpos},
                                   {"--out-mjcf", &arguments.out_mjcf},
                                   {"--png", &arguments.png},
                                   {"--animation", &arguments.animation},
                                   {"--trace", &arguments.trace}}) {
    if (path->empty()) continue;
    if (arguments.models.size() > 1) throw Error(std::string(flag) + " is for a single model");
    if (arguments.resume && path != &arguments.out_qpos) {
      throw Error("--resume goes with --json and --out-qpos, not with " + std::string(flag));
    }
  }
  if (arguments.resume && !arguments.html.empty()) {
    throw Error("--resume goes with --json and --out-qpos, not with --html");
  }
  if (!arguments.trace.empty() && arguments.options.trajectory) {
    throw Error("--trace: the frames of a --trajectory are followed, not searched");
  }
  if (arguments.smooth > 0.0) CheckSmooth(arguments);
  if (!arguments.resume) return;
  if (arguments.json.empty() || arguments.json == "-") throw Error("--resume needs --json FILE");
  if (arguments.out_qpos == "-") throw Error("--resume cannot go on with --out-qpos on stdout");
  if (arguments.options.trajectory) {
    throw Error("--resume: the frames of a --trajectory depend on those before");
  }
}

void AddOutputs(const SolveArguments& arguments, OutputFiles& outputs, SceneOutput& scene) {
  std::vector<std::string> inputs = arguments.models;
  if (!arguments.which.file.empty() && arguments.which.file != "-") {
    inputs.push_back(arguments.which.file);
  }
  CheckQposFileName("--out-qpos", arguments.out_qpos);
  outputs.Add("--json", arguments.json, inputs);
  outputs.Add("--out-qpos", arguments.out_qpos, inputs);
  scene.Add(arguments.out_mjcf, arguments.models.front(), inputs, outputs);
  outputs.Add("--trace", arguments.trace, inputs);
  outputs.Add("--html", arguments.html, inputs);
  outputs.Add("--png", arguments.png, inputs);
  outputs.Add("--animation", arguments.animation, inputs);
  // Throws Error if it is a stream: the writers of pictures need a file.
  for (const std::string& picture : {arguments.png, arguments.animation}) {
    if (!picture.empty()) outputs.StagedName(picture);
  }
}

#ifdef MJCF_PDG_HAVE_RENDER
// The first page is `path`; look.png is followed by look-2.png.
std::string PageName(const std::string& path, std::size_t page) {
  if (page == 0) return path;
  fs::path name(path);
  const std::string ending = name.extension().string();
  return name.replace_extension().string() + "-" + std::to_string(page + 1) + ending;
}

void StagePng(const Scene& scene, const std::vector<Configuration>& rows,
              const std::vector<Result>& results, const std::string& path, OutputFiles& outputs) {
  std::vector<RenderRow> pictures;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    pictures.push_back(PictureRow(rows[i], results[i]));
  }
  std::vector<std::string> pages;
  for (std::size_t page = 0; page * kRowsPerPage < rows.size(); ++page) {
    const std::string name = PageName(path, page);
    if (page > 0) outputs.Add("--png", name, {});
    pages.push_back(outputs.StagedName(name));
  }
  RenderBeforeAfter(scene.model(), pictures, pages);
}

void StageAnimation(const RepairedRows& repaired, const Options& options, const std::string& path,
                    OutputFiles& outputs) {
  std::vector<Shot> shots;
  if (options.trajectory) {
    shots.push_back(TrajectoryShot(repaired.rows, repaired.results));
  } else {
    Solver solver(repaired.scene, options);
    for (std::size_t i = 0; i < std::min(repaired.rows.size(), kRowsPerPage); ++i) {
      shots.push_back(RepairShot(repaired.scene, solver, repaired.rows[i], repaired.results[i]));
    }
  }
  RenderAnimation(repaired.scene.model(), shots, outputs.StagedName(path));
}
#endif

// One call of solve, over all of its models.
class SolveRun {
 public:
  SolveRun(const CLI::App& command, SolveArguments& arguments)
      : arguments_(arguments),
        given_(GivenOptions(command)),
        several_(arguments.models.size() > 1),
        table_(several_) {
    if (!arguments.html.empty()) page_.emplace(command, arguments);
  }

  int Run();

 private:
  void CheckModels();
  void SolveModel(const std::string& model);
  void BeginFiles(const Scene& scene, std::size_t skipped);
  void Tell(const Scene& scene, const SolvedRow& solved);
  void WriteNpySize();
  void StageScene(const Scene& scene);
  void SolveModels();
  std::string NotFreeWords() const;
  std::string LeftWords() const;
  bool Draws() const { return !arguments_.png.empty() || !arguments_.animation.empty(); }
  bool Watches() const { return !arguments_.trace.empty() || !arguments_.html.empty(); }
  int ExitCode() const { return (table_.unsolved() == 0) ? kExitFree : kExitNotFree; }

  SolveArguments& arguments_;
  const std::vector<std::string> given_;
  const bool several_;
  OutputFiles outputs_;
  SceneOutput scene_output_;
  SolveTable table_;
  std::unique_ptr<LeftRows> left_;  // with --resume
  std::optional<SolvePage> page_;   // with --html
  std::unique_ptr<Progress> progress_;
  std::size_t index_ = 0;    // of the present model's next row
  std::size_t told_ = 0;     // rows written by this run
  int nq_ = 0;               // of the present model
  bool npy_header_ = false;  // comes before the next row
  // Kept for --out-mjcf and pictures alone.
  std::vector<Configuration> rows_;
  std::vector<Result> results_;
};

// Models that are bad are told before any work, so that nothing is written then.
void SolveRun::CheckModels() {
  if (several_ && arguments_.which.file == "-") {
    throw Error("--qpos-file: stdin can be read for one model only");
  }
  for (const std::string& model : arguments_.models) {
    if (!several_) return;  // the only one is loaded for its work at once
    const Scene scene = Scene::FromFile(model, arguments_.scene.options);
    const Solver solver(scene, arguments_.options);
    const RowSource rows(scene, arguments_.which);
  }
}

// Files go on behind `skipped` rows of an earlier run.
void SolveRun::BeginFiles(const Scene& scene, std::size_t skipped) {
  nq_ = scene.nq();
  if (told_ > 0) return;
  outputs_.Stream(arguments_.json, left_ ? left_->bytes() : 0);
  outputs_.Stream(arguments_.out_qpos,
                  skipped == 0 ? 0 : QposBytes(arguments_.out_qpos, skipped, nq_));
  if (skipped == 0 && IsNpyFile(arguments_.out_qpos)) npy_header_ = true;
  if (arguments_.trace.empty()) return;
  outputs_.Stream(arguments_.trace);
  outputs_.Append(arguments_.trace, TraceHeader(arguments_.scene.model, given_));
}

void SolveRun::Tell(const Scene& scene, const SolvedRow& solved) {
  const Configuration& row = solved.row;
  const Result& result = solved.result;
  const RowName name{several_ ? arguments_.scene.model : "", index_++};
  if (npy_header_) {
    outputs_.Append(arguments_.out_qpos, NpyHeader(0, result.q.size()));
    npy_header_ = false;
  }
  if (!arguments_.trace.empty()) {
    outputs_.Append(arguments_.trace, TraceRow(scene, name.index, solved));
  }
  // The line of JSON comes last: with it, a row counts as done.
  if (!arguments_.out_qpos.empty()) {
    outputs_.Append(arguments_.out_qpos, FormatQposRow(result.q, arguments_.out_qpos));
  }
  if (!arguments_.json.empty()) {
    outputs_.Append(arguments_.json, SolveJson(scene, name, row, result));
  }
  if (page_) page_->Add(scene, solved);
  table_.Add(scene, name, row, result);
  if (!arguments_.out_mjcf.empty() || Draws()) {
    rows_.push_back(row);
    results_.push_back(result);
  }
  ++told_;
  progress_->Step();
}

// A .npy says in front how many rows it has.
void SolveRun::WriteNpySize() {
  if (!IsNpyFile(arguments_.out_qpos)) return;
  outputs_.Overwrite(arguments_.out_qpos, NpyHeader(table_.rows(), static_cast<std::size_t>(nq_)));
}

void SolveRun::SolveModel(const std::string& model) {
  arguments_.scene.model = model;
  const Scene scene = LoadScene(arguments_.scene);
  RowSource rows(scene, arguments_.which);
  index_ = left_ ? left_->Skip(several_ ? model : "", rows, table_) : 0;
  if (left_ && left_->telling()) CheckSolvesAlike(*left_->telling(), scene, arguments_.options);
  BeginFiles(scene, index_);
  if (page_) page_->Begin(model, scene);
  progress_ = std::make_unique<Progress>("solving", rows.size(), index_);
  try {
    const std::size_t most = rows.size().value_or(arguments_.threads);
    const std::size_t threads = std::clamp<std::size_t>(most, 1, arguments_.threads);
    SolveRows(
        scene, {arguments_.options, threads, arguments_.smooth, Watches()},
        [&](Configuration& row) { return rows.Next(row); },
        [&](const SolvedRow& solved) { Tell(scene, solved); });
  } catch (...) {
    WriteNpySize();
    throw;
  }
  progress_.reset();
  if (Interrupted()) return;
  if (page_) page_->End();
  StageScene(scene);
}

void SolveRun::StageScene(const Scene& scene) {
  const RepairedRows repaired{scene, rows_, results_};
  if (scene_output_.wanted()) scene_output_.Stage(arguments_.scene.model, repaired, outputs_);
#ifdef MJCF_PDG_HAVE_RENDER
  if (!arguments_.png.empty()) StagePng(scene, rows_, results_, arguments_.png, outputs_);
  if (!arguments_.animation.empty()) {
    StageAnimation(repaired, arguments_.options, arguments_.animation, outputs_);
  }
#endif
}

// A file of answers has a row for every configuration. Which of them are not free it cannot say.
std::string SolveRun::NotFreeWords() const {
  if (arguments_.out_qpos.empty() || table_.unsolved() == 0) return "";
  return arguments_.out_qpos + " has all " + std::to_string(table_.rows()) + " rows, also the " +
         std::to_string(table_.unsolved()) +
         " unsolved ones, which are not free (\"status\" in --json)\n";
}

// Where the rows so far are, and how to go on behind them; empty: nowhere.
std::string SolveRun::LeftWords() const {
  const std::string part = OutputFiles::PartName(arguments_.json);
  std::error_code ec;
  if (table_.rows() == 0 || arguments_.json.empty() || !fs::exists(part, ec)) return "";
  const bool resumes = !arguments_.options.trajectory && arguments_.out_mjcf.empty() && !Draws() &&
                       arguments_.html.empty() && arguments_.trace.empty() &&
                       arguments_.out_qpos != "-";
  return " in " + part + (resumes ? "; the same command with --resume goes on" : "");
}

void SolveRun::SolveModels() {
  try {
    for (const std::string& model : arguments_.models) {
      SolveModel(model);
      if (Interrupted()) break;
    }
    WriteNpySize();
  } catch (const std::exception& e) {
    const std::string left = LeftWords();
    if (left.empty()) throw;
    const std::string words =
        e.what() + ("; " + std::to_string(table_.rows()) + " rows are") + left;
    if (dynamic_cast<const Error*>(&e)) throw Error(words);
    throw std::runtime_error(words);
  }
}

int SolveRun::Run() {
  CheckCombination(arguments_);
  AddOutputs(arguments_, outputs_, scene_output_);
  CheckModels();
  // What cannot be written is told before any work.
  if (!arguments_.out_mjcf.empty()) ParseSpec(arguments_.models.front());
#ifdef MJCF_PDG_HAVE_RENDER
  if (Draws()) EglContext{};
#endif
  if (arguments_.resume) {
    left_ = std::make_unique<LeftRows>(OutputFiles::PartName(arguments_.json));
  }
  CatchInterrupts();
  SolveModels();
  if (Interrupted()) {
    const std::string left = LeftWords();
    return SayInterrupted("after " + std::to_string(table_.rows()) + " rows" +
                          (left.empty() ? "" : ", which are" + left));
  }
  if (page_) outputs_.Stage(arguments_.html, page_->ToString());
  outputs_.Commit();
  if (!outputs_.uses_stdout()) WriteStdout(table_.ToString() + NotFreeWords());
  return ExitCode();
}

int RunSolve(const CLI::App& command, SolveArguments& arguments) {
  FinishSolveOptions(arguments);
  return SolveRun(command, arguments).Run();
}

}  // namespace

Verb AddSolveVerb(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("solve", "Find the nearest collision-free configuration");
  auto arguments = std::make_shared<SolveArguments>();
  AddSolveFlags(*command, *arguments);
  return {command, [command, arguments] { return RunSolve(*command, *arguments); }};
}

}  // namespace mjcf_pdg::app
