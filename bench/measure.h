// What the benchmarks share: measured solves, quantiles, the unit of time.
//
// The unit of time is an evaluation: one mj_kinematics + mj_comPos + mj_collision of the same model
// at the problems' own configurations. It is timed in the same run, between the solves, so that a
// slower or busier machine changes both times alike.
#ifndef MJCF_PDG_BENCH_MEASURE_H_
#define MJCF_PDG_BENCH_MEASURE_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "problem_sets.h"

namespace mjcf_pdg::bench {

// Makes MuJoCo throw its errors as Error, write its warnings as one line to stderr, and write no
// log file.
void HandleMujocoMessages();

// Processor time of this thread [s]. A solve never waits, so this is the wall time on an idle
// machine, and on a busy one other programs do not count.
double CpuSeconds();

// The p-quantile (p from 0 to 1) by linear interpolation between order statistics. It is infinite
// next to an infinite value, and NaN if there are no values.
double Quantile(std::vector<double> values, double p);

// The time of one evaluation of a configuration: mj_kinematics, mj_comPos and mj_collision, median
// of 21 [s].
double EvaluationSeconds(const Scene& scene, const std::vector<double>& q);

// One solve of one problem.
struct Measured {
  int problem = 0;  // index in the set
  std::uint64_t seed = 0;
  Result result;
  bool verified = false;  // it is solved or already free, and Verify, asked again, agrees
  double seconds = 0.0;   // processor time of the solve [s]
};

// The solves of a set with several seeds and otherwise the same options.
struct Series {
  std::string label;
  std::vector<Measured> solves;            // seed by seed, problems in order
  std::vector<double> evaluation_seconds;  // timings of one evaluation [s]

  // The median timing, which is the unit of time.
  double EvaluationSeconds() const { return Quantile(evaluation_seconds, 0.5); }
};

// The seeds first, first + 1, ...
struct Seeds {
  std::uint64_t first = 0;
  int count = 1;
};

// Solves all problems of the set with each seed. A set of consecutive configurations is solved as a
// trajectory.
Series Measure(const Scene& scene, const ProblemSet& set, Options options, Seeds seeds);

// The lowest σ known of each problem [m²]: as the set gives it (infinite: unknown), and then
// lowered to that of verified solves.
std::vector<double> BestGiven(const ProblemSet& set);
void LowerBest(const Series& series, std::vector<double>& best);

// Statistics of the solves of one or more series, for a row of a table. Problems that were free
// already count in n, already_free and ok alone.
struct Tally {
  int n = 0, already_free = 0, ok = 0;  // solves; of free problems; verified
  std::vector<double> ratio;            // σ / best known σ; infinite for a failure
  std::vector<double> bound;            // √(proven lower bound of σ / best known σ)
  std::vector<double> queries, evaluations, iterations, starts;
  std::map<std::string, int> winners;  // verified solves by the start that won

  void Add(const Series& series, const std::vector<double>& best);
};

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_MEASURE_H_
