#include "plan/runs.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <mutex>

#include "base/in_order.h"
#include "base/random.h"
#include "plan/dilation.h"
#include "plan/planners.h"
#include "plan/tightening.h"
#include "plan/tree_search.h"

namespace mjcf_pdg {
namespace {

// The samples of a run, times a term of Luby's sequence. Of 100, 250, 500 and 1000 this has the
// least product of median times, over four scenes and both planners that retract (bench/README.md,
// plan_bench). In one run without end birrt found 4 of 10 paths on the bridge in 300 s each; begun
// anew, after any of these, it found ten.
constexpr std::int64_t kSamplesOfARun = 250;
constexpr std::int64_t kNoBound = std::numeric_limits<std::int64_t>::max();

// Term k = 1, 2, ... of 1 1 2 1 1 2 4 1 1 2 1 1 2 4 8 ... (Luby, Sinclair and Zuckerman, Optimal
// speedup of Las Vegas algorithms, 1993).
std::int64_t Luby(std::int64_t k) {
  std::int64_t power = 1;
  while (2 * power - 1 < k) power *= 2;
  return 2 * power - 1 == k ? power : Luby(k - power + 1);
}

// Every fourth run begins in a dilated scene, one of the two that are dilated most, by turns.
// Seconds on the bridge, for a peg in a hole, and in the slot of models/passages (medians of 6 to 8
// seeds, 9301 and after): 0.53, 1.5 and 1.7; with every second run 2.8 (birrt-r: 1.8), 0.86 and
// 0.74.
constexpr std::int64_t kWidest = 2, kEvery = 4;

struct Run {
  std::int64_t number = 0;   // 1, 2, ...
  std::int64_t samples = 0;  // at most so many
  int dilation = -1;         // the index of the dilated scene where it begins; -1: of none
  Runs result;
};

class Searching {
 public:
  explicit Searching(const RunsInput& input)
      : input_(input), begins_anew_(BeginsAnew(input.options.planner)) {
    if (input.options.max_samples > 0) samples_left_ = input.options.max_samples;
  }

  Runs Go() {
    InOrder<Run> runs(static_cast<std::size_t>(begins_anew_ ? input_.options.threads : 1));
    runs.Run([this](Run& run) { return Take(run); }, [this](std::size_t, Run& run) { Do(run); },
             [this](std::size_t, const Run& run) { return Tell(run); });
    return std::move(all_);
  }

 private:
  bool Take(Run& run) {
    run.number = ++taken_;
    run.dilation = -1;
    if (RetractsByPdg(input_.options.planner) && run.number % kEvery == 0) {
      if (dilated_.empty()) dilated_ = DilatedScenes(input_.scene);  // copies what the scene knows
      if (!dilated_.empty()) run.dilation = static_cast<int>((run.number / kEvery - 1) % kWidest);
    }
    run.samples = begins_anew_ ? std::min(samples_left_, Luby(run.number) * kSamplesOfARun)
                               : samples_left_;  // a run of OMPL's other planners has no end
    samples_left_ -= run.samples;
    return run.samples > 0 && run.number < found_ && !Ended();
  }

  // Of the random numbers of a run: apart for all runs of all seeds.
  std::uint64_t SeedOf(const Run& run) const {
    const std::uint64_t first = Random(input_.options.options.seed).Bits();
    return Random(first + static_cast<std::uint64_t>(run.number)).Bits();
  }

  bool Ended() const {
    const std::lock_guard<std::mutex> lock(ended_);
    return input_.ended();
  }

  bool IsOver(const Run& run) const { return run.number > found_ || Ended(); }

  TreeSearchInput InputOf(const Run& run, const Scene& scene, std::uint64_t seed) const {
    return {scene, input_.options, std::make_shared<ConfigurationSpace>(input_.space, seed),
            input_.clearance, [&run, this] { return IsOver(run); }};
  }

  // Adds to what the run has cost.
  static void Add(const SearchCost& cost, Run& run) {
    run.result.nodes += cost.nodes;
    run.result.collision_queries += cost.collision_queries;
  }

  void Do(Run& run) {
    run.result = {};
    const std::uint64_t seed = SeedOf(run);
    const bool dilated = run.dilation >= 0;
    const TreeSearchInput input =
        InputOf(run, dilated ? dilated_[run.dilation] : input_.scene, seed);
    TreeSearch search(input);
    run.result.path = search.Find(input_.start, input_.goal, run.samples);
    run.result.samples = input.space->samples();
    Add(search.cost(), run);
    if (dilated) Tighten(seed, run);
    if (run.result.path.empty()) return;
    std::int64_t before = found_;
    while (run.number < before && !found_.compare_exchange_weak(before, run.number)) {
    }
  }

  // Retracts the path step by step into the scene itself.
  void Tighten(std::uint64_t seed, Run& run) {
    for (std::size_t k = run.dilation + 1; k <= dilated_.size() && !run.result.path.empty(); ++k) {
      const Scene& scene = k < dilated_.size() ? dilated_[k] : input_.scene;
      Tightening tightening(InputOf(run, scene, seed));
      run.result.path = tightening.Tighten(run.result.path);
      Add(tightening.cost(), run);
    }
  }

  bool Tell(const Run& run) {
    all_.nodes += run.result.nodes;
    all_.samples += run.result.samples;
    all_.collision_queries += run.result.collision_queries;
    all_.path = run.result.path;
    return all_.path.empty();
  }

  const RunsInput& input_;
  const bool begins_anew_;
  std::vector<Scene> dilated_;  // empty until a run begins in one
  std::int64_t taken_ = 0, samples_left_ = kNoBound;
  std::atomic<std::int64_t> found_ = kNoBound;  // the first run that found a path
  mutable std::mutex ended_;
  Runs all_;
};

}  // namespace

Runs Search(const RunsInput& input) { return Searching(input).Go(); }

}  // namespace mjcf_pdg
