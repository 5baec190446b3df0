// The problem sets of the benchmarks: keyframes of a model, random penetrating configurations of
// it, and sets from JSON Lines files.
#ifndef MJCF_PDG_BENCH_PROBLEM_SETS_H_
#define MJCF_PDG_BENCH_PROBLEM_SETS_H_

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::bench {

struct BenchProblem {
  std::string id;
  std::vector<double> q_in;                                     // nq entries
  double best_known = std::numeric_limits<double>::infinity();  // lowest σ known [m²]
  std::optional<std::vector<double>> hint = std::nullopt;       // free_hint of Solver::Solve
};

struct ProblemSet {
  std::string name;
  std::string model_path;
  std::vector<BenchProblem> problems;
  bool consecutive = false;  // the problems are frames of one motion
};

// Paths of the project's own three articulated scenes.
std::vector<std::string> OwnModels();

// Random configurations whose overlaps are all shallower than this are not used [m].
inline constexpr double kLeastDepth = 1e-4;

// All keyframes of the model, free ones too.
ProblemSet Keyframes(const Scene& scene, const std::string& model_path);

// `count` random configurations that overlap by more than kLeastDepth; fewer if they are hard to
// find. Joint angles are uniform within the limits (without limits: within ±π), ball joints uniform
// over rotations. A tree with a free joint is turned at random and moved until one of its geoms is
// near a geom of another tree. The same seed gives the same problems on every machine.
ProblemSet RandomProblems(const Scene& scene, const std::string& model_path, int count,
                          std::uint64_t seed);

// Reads a JSON Lines file: each line has "model" (a path below `root`), "qpos_in" or else "qpos",
// and may have "best" (the lowest σ known [m²], or null) and "id". Returns one set per model, in
// order of appearance. Throws Error if the file cannot be read or parsed.
std::vector<ProblemSet> ReadProblems(const std::string& path, const std::string& root);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_PROBLEM_SETS_H_
