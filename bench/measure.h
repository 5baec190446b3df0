// What the benchmarks share: measured solves, quantiles, the unit of time.
//
// Time is counted in evaluations: one mj_kinematics + mj_comPos + mj_collision of the same model at
// the problems' own configurations, timed in the same run between the solves, so that a slower
// machine or a busy one changes both.
#ifndef MJCF_PDG_BENCH_MEASURE_H_
#define MJCF_PDG_BENCH_MEASURE_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "problem_sets.h"

namespace mjcf_pdg::bench {

// MuJoCo's errors become Error, its warnings one line on stderr; no log file.
void HandleMujocoMessages();

// Processor time of this thread alone: solves wait for nothing, so on an idle machine it is wall
// time, and on a busy one the others do not count.
double CpuSeconds();

// Linear interpolation between order statistics; an infinite neighbour makes it infinite, no values
// NaN.
double Quantile(std::vector<double> values, double p);

// One solve of one problem.
struct Measured {
  int problem = 0;
  std::uint64_t seed = 0;
  Result result;
  bool verified = false;  // solved or already free, and Verify, asked again, agrees
  double seconds = 0.0;   // processor time
};

// All solves of a set with the same options but the seed: seed by seed, problems in order.
struct Series {
  std::string label;
  std::vector<Measured> solves;
  std::vector<double> evaluation_seconds;

  double EvaluationSeconds() const { return Quantile(evaluation_seconds, 0.5); }
};

struct Seeds {
  std::uint64_t first = 0;
  int count = 1;
};

// A set of consecutive configurations is solved as a trajectory.
Series Measure(const Scene& scene, const ProblemSet& set, Options options, Seeds seeds);

// The lowest σ known of each problem: what the set gives, lowered by verified solves.
std::vector<double> BestGiven(const ProblemSet& set);
void LowerBest(const Series& series, std::vector<double>& best);

// Solves of one or more series, for a row of a table. What was free already counts in n,
// already_free and ok alone.
struct Tally {
  int n = 0, already_free = 0, ok = 0;
  std::vector<double> ratio;  // σ/best; infinite for a failure
  std::vector<double> queries, evaluations, iterations, starts;
  std::map<std::string, int> winners;

  void Add(const Series& series, const std::vector<double>& best);
};

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_MEASURE_H_
