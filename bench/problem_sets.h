// Problem sets for the benchmarks: keyframes of a model, random penetrating configurations of it,
// and sets from JSON-Lines files.
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
  std::vector<double> q_in;                                     // nq
  double best_known = std::numeric_limits<double>::infinity();  // lowest σ known [m²]
  std::optional<std::vector<double>> hint = std::nullopt;       // given to the solver
};

struct ProblemSet {
  std::string name;
  std::string model_path;
  std::vector<BenchProblem> problems;
  bool consecutive = false;  // frames of one motion
};

// The project's own three scenes.
std::vector<std::string> OwnModels();

// Overlaps shallower than this are no random problem [m].
inline constexpr double kLeastDepth = 1e-4;

ProblemSet Keyframes(const Scene& scene, const std::string& model_path);

// `count` configurations that overlap by more than kLeastDepth; fewer if they are hard to find.
// Joint angles are uniform within the limits (none: ±π), ball joints uniform over rotations. A tree
// with a free joint is turned at random and thrown at a geom that is not its own. The same seed
// gives the same problems on every machine.
ProblemSet RandomProblems(const Scene& scene, const std::string& model_path, int count,
                          std::uint64_t seed);

// One object a line: "model" (path below `root`), "qpos_in" or else "qpos", and where known "best"
// (σ, null if not) and "id". One set per model, in order of appearance. Throws Error.
std::vector<ProblemSet> ReadProblems(const std::string& path, const std::string& root);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_PROBLEM_SETS_H_
