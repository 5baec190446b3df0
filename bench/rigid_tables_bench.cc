// The paper's results for rigid models with ours beside them: Table I, Table II, Fig. 11, and the
// cost against the number of triangles.
//
// Table I: A is translated through B in 200 frames while its orientation changes, once with motion
// coherence (the frames follow each other) and once with centroid difference. Table II: compared
// with random sampling on the contact space (contact_sampling.h), which gets ten times our time per
// frame. Fig. 11: a spoon in a box compared with brute force (figure11.h). Only frames that
// penetrate count. The paper's times are from an Intel i5 of 2.4 GHz.
//
// Run: rigid_tables_bench [--parts table1,table2,figure11,triangles] [--big FOLDER] FOLDER is that
// of the big models, which models/rigid/make_rigid.py writes there if they are missing.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "contact_sampling.h"
#include "figure11.h"
#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "oracle_tally.h"
#include "triangle_cost.h"

namespace mjcf_pdg::bench {
namespace {

constexpr double kTolerance = 1e-5;  // [m]
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A straight path of the free body's frame, which turns at a constant rate.
struct Path {
  const char* scene;
  Vector3d from, to;  // [m]
  Vector3d axis;      // of the rotation, any length
  double turns;       // full turns on the whole path
};

const Path kBunnyDragon = {"bunny_dragon", {-0.25, 0.02, 0.08}, {0.25, 0.0, 0.06}, {1, 2, 1}, 1.0};
const Path kSpoonCup = {"spoon_cup", {-0.10, 0.01, 0.07}, {0.10, 0.0, 0.05}, {1, 1, 2}, 1.0};
const std::vector<Path> kTable2 = {
    {"pawn_cad", {-0.12, 0.01, 0.01}, {0.12, 0.0, -0.01}, {1, 2, 0}, 1.0},
    {"hammer_bumpy_sphere", {-0.2, 0.02, -0.1}, {0.2, 0.0, -0.05}, {1, 0, 2}, 1.0},
    {"l_shape_torus_knot", {-0.2, 0.02, 0.01}, {0.2, 0.0, -0.02}, {2, 1, 1}, 1.0},
};

std::vector<std::vector<double>> Frames(const Path& path, int count) {
  std::vector<std::vector<double>> frames;
  for (int k = 0; k < count; ++k) {
    const double t = k / (count - 1.0);
    const Vector3d p = (1.0 - t) * path.from + t * path.to;
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(2.0 * mjPI * path.turns * t, path.axis.normalized()));
    frames.push_back({p.x(), p.y(), p.z(), turn.w(), turn.x(), turn.y(), turn.z()});
  }
  return frames;
}

Scene Load(const std::string& folder, const char* name) {
  SceneOptions options;
  options.exact_mesh = true;
  return Scene::FromFile(folder + "/" + name + ".xml", options);
}

struct Solved {
  bool asked = false;  // the frame was solved at all
  Result result;
  double ms = 0.0;
};

std::vector<Solved> Solve(const Scene& scene, const std::vector<std::vector<double>>& frames,
                          const Options& options, OracleTally& oracle, int every = 1) {
  Solver solver(scene, options);
  std::vector<Solved> all(frames.size());
  for (std::size_t k = 0; k < frames.size(); k += every) {
    const double begin = CpuSeconds();
    all[k].result = solver.Solve(frames[k]);
    all[k].ms = 1e3 * (CpuSeconds() - begin);
    all[k].asked = true;
  }
  for (const Solved& solved : all) {  // after all solves, whose caches CGAL would empty
    if (solved.asked) oracle.Ask(solved.result);
  }
  return all;
}

// The median time of one distance query of the pair from scratch at the answers of the penetrating
// frames [ms].
double QueryMs(const Scene& scene, const std::vector<Solved>& solves) {
  ContactFinder finder(scene.tables());
  std::vector<double> ms;
  for (const Solved& solved : solves) {
    if (solved.result.status != Status::kSolved) continue;
    finder.Pose(Eigen::Map<const VectorXd>(solved.result.q.data(), 7));
    NearPair near;
    const double begin = CpuSeconds();
    finder.Distance(0, 1.0, near);
    ms.push_back(1e3 * (CpuSeconds() - begin));
  }
  return Quantile(ms, 0.5);
}

struct Row {
  std::string label;
  std::vector<Solved> solves;
};

void PrintRow(const Row& row, const std::vector<double>& best, double query_ms) {
  std::vector<double> ms, iterations, queries, ratios;
  int solved = 0;
  for (std::size_t k = 0; k < row.solves.size(); ++k) {
    const Result& result = row.solves[k].result;
    if (!row.solves[k].asked || result.status == Status::kAlreadyFree) continue;
    ms.push_back(row.solves[k].ms);
    iterations.push_back(result.stats.iterations);
    queries.push_back(result.stats.collision_queries);
    solved += result.status == Status::kSolved;
    ratios.push_back(result.status == Status::kSolved ? result.sigma / best[k] : kInfinity);
  }
  std::printf("  %-28s %6zu %7.1f %9.2f %9.2f %9.0f %8.0f %7.0f %9.3f %9.3f\n", row.label.c_str(),
              ms.size(), ms.empty() ? 0.0 : 100.0 * solved / ms.size(), Quantile(ms, 0.5),
              Quantile(ms, 0.95), Quantile(ms, 0.5) / query_ms, Quantile(iterations, 0.5),
              Quantile(queries, 0.5), Quantile(ratios, 0.5), Quantile(ratios, 0.95));
}

void PrintTable1(const std::string& folder, const Path& path, const char* paper, int count) {
  const Scene scene = Load(folder, path.scene);
  const std::vector<std::vector<double>> frames = Frames(path, count);
  OracleTally oracle(scene, kTolerance);
  std::vector<Row> rows;
  std::vector<double> best(frames.size(), kInfinity);
  // Method paper takes seconds per frame on big meshes, so it gets every tenth frame only.
  auto add = [&](const char* label, Method method, Effort effort, bool coherence) {
    Options options;
    options.tolerance = kTolerance;
    options.method = method;
    options.effort = effort;
    options.trajectory = coherence;
    rows.push_back(
        {label, Solve(scene, frames, options, oracle, method == Method::kPaper ? 10 : 1)});
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const Result& result = rows.back().solves[k].result;
      if (result.status == Status::kSolved) best[k] = std::min(best[k], result.sigma);
    }
  };
  add("fast, motion coherence", Method::kAuto, Effort::kFast, true);
  add("fast", Method::kAuto, Effort::kFast, false);
  add("default, motion coherence", Method::kAuto, Effort::kDefault, true);
  add("default", Method::kAuto, Effort::kDefault, false);
  add("paper, motion coherence", Method::kPaper, Effort::kDefault, true);
  add("paper, centroid difference", Method::kPaper, Effort::kDefault, false);
  const double query_ms = QueryMs(scene, rows.front().solves);
  std::printf("Table I, %s (paper: %s); one distance query: %.3f ms\n", path.scene, paper,
              query_ms);
  std::printf("  %-28s %6s %7s %9s %9s %9s %8s %7s %9s %9s\n", "", "frames", "ok %", "ms", "p95",
              "/query", "iter", "queries", "ratio", "p95");
  for (const Row& row : rows) PrintRow(row, best, query_ms);
  oracle.Print();
  std::fflush(stdout);
}

void PrintTable2(const std::string& folder, int count) {
  std::printf("Table II: against sampling on the contact space with 10 times our time\n");
  std::printf("  %-22s %-8s %6s %6s %9s %12s %9s %14s %12s\n", "", "effort", "frames", "ok %", "ms",
              "sampling ms", "samples", "error (Eq. 31)", "not beaten %");
  for (const Path& path : kTable2) {
    const Scene scene = Load(folder, path.scene);
    const std::vector<std::vector<double>> frames = Frames(path, count);
    OracleTally oracle(scene, kTolerance);
    for (const Effort effort : {Effort::kFast, Effort::kDefault}) {
      Options options;
      options.tolerance = kTolerance;
      options.effort = effort;
      const std::vector<Solved> solves = Solve(scene, frames, options, oracle);
      Workspace work(scene.tables(), options);
      std::vector<double> ms, errors, samples;
      int solved = 0, not_beaten = 0;
      for (std::size_t k = 0; k < frames.size(); ++k) {
        const Result& ours = solves[k].result;
        if (ours.status == Status::kAlreadyFree) continue;
        ms.push_back(solves[k].ms);
        if (ours.status != Status::kSolved) continue;
        ++solved;
        work.Begin(ToEigen(frames[k]));
        const SamplingResult theirs = SampleContactSpace(work, 1e-2 * solves[k].ms, k);
        samples.push_back(theirs.samples);
        if (theirs.free) errors.push_back(RelativeError(ours.sigma, theirs.sigma));
        not_beaten += !(theirs.sigma < 0.99 * ours.sigma);
      }
      std::printf("  %-22s %-8s %6zu %6.1f %9.2f %12.2f %9.0f %14.3f %12.1f\n", path.scene,
                  effort == Effort::kFast ? "fast" : "default", ms.size(),
                  100.0 * solved / ms.size(), Quantile(ms, 0.5), 10.0 * Quantile(ms, 0.5),
                  Quantile(samples, 0.5), Quantile(errors, 0.5), 100.0 * not_beaten / ms.size());
      std::fflush(stdout);
    }
    oracle.Print();
  }
}

std::string BigModels(std::string folder) {
  if (folder.empty()) folder = (std::filesystem::temp_directory_path() / "mjcf_pdg_big").string();
  if (!std::filesystem::exists(folder + "/bunny_dragon.xml")) {
    const std::string command =
        "python3 '" MJCF_PDG_MODEL_DIR "/rigid/make_rigid.py' '" + folder + "'";
    if (std::system(command.c_str()) != 0) throw Error("cannot make the big models: " + command);
  }
  return folder;
}

}  // namespace

int RigidTablesMain(int argc, char** argv) {
  std::string big;
  int frames = 200, figure_frames = 12, largest = 1 << 20;
  const std::vector<std::string> known = {"table1", "table2", "figure11", "triangles"};
  std::vector<std::string> parts = known;
  CLI::App app(
      "Table I, Table II and Fig. 11 of the paper, with our rows; cost against triangles.");
  app.add_option("--big", big, "folder of the big models; made there if missing");
  app.add_option("--parts", parts, "table1, table2, figure11, triangles; several with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(known));
  app.add_option("--frames", frames, "of each path")->check(CLI::Range(2, 100000));
  app.add_option("--figure-frames", figure_frames, "of Fig. 11")->check(CLI::Range(2, 1000));
  app.add_option("--largest", largest, "triangles of each mesh in the last row of triangles")
      ->check(CLI::Range(1024, 1 << 22));
  CLI11_PARSE(app, argc, argv);
  try {
    const std::string small = MJCF_PDG_MODEL_DIR "/rigid";
    auto wanted = [&](const char* part) {
      return std::find(parts.begin(), parts.end(), part) != parts.end();
    };
    if (wanted("table1")) {
      PrintTable1(BigModels(big), kBunnyDragon,
                  "22.8 ms, 2.14 iterations with coherence; 59.2 ms, 6.5 without", frames);
      PrintTable1(small, kSpoonCup, "7.76 ms, 2.35 iterations with coherence; 24.1 ms, 7.3 without",
                  frames);
    }
    if (wanted("table2")) PrintTable2(small, frames);
    if (wanted("figure11")) PrintFigure11(kTolerance, figure_frames);
    if (wanted("triangles")) PrintTriangleCost(kTolerance, largest, 10);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rigid_tables_bench: error: %s\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::RigidTablesMain(argc, argv); }
