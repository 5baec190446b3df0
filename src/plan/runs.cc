#include "plan/runs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "base/in_order.h"
#include "base/random.h"
#include "plan/body_travel.h"
#include "plan/motion_prover.h"
#include "plan/planners.h"
#include "plan/shrunk_scenes.h"
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

// Careful runs slide along contacts (plan/retraction.h) in steps so short that they lead through
// holes and round corners in which others are stuck. Those that begin with smaller bodies, or
// smaller or thinner geoms, are careful as well. Each kind is the cheapest somewhere. Seconds of
// the processor per path in runs of one kind: for a bridge with a hole of 0.29 m 1.0, 1.6, 6.8, for
// slot.xml (models/passages) 2.3, 0.57, 2.9, for piano.xml 8.0, 9.9, 1.4; for a U in its hole
// smaller geoms find a path in 0.4 and no other kind does (bench/README.md, plan_bench).
enum class Kind { kOrdinary, kCareful, kSmallerBodies, kSmallerGeoms, kThinnerGeoms };

// Steps are whole, or so short that half of them move no body farther than kRadiiOfAShortStep: a
// step is a share of the extent, in which an arm that swings counts for more than a hand that is to
// turn in a hole.
enum class Steps { kWhole, kShort };

struct Turn {
  Kind kind;
  Steps steps;
};

// A round of runs; `number` is that of the round, from 0. Runs that begin smaller take longest, and
// come once each: with smaller bodies, with which most narrow passages are found, after one run of
// either kind that does not, with thinner and smaller geoms last. Those with bodies and with
// smaller geoms have whole and short steps in turn from round to round. Thinner ones have whole
// steps, with which they find more (bench/README.md, Passages).
std::vector<Turn> Round(const std::string& planner, std::int64_t number) {
  using enum Kind;
  using enum Steps;
  if (!Retracts(planner)) return {{kOrdinary, kWhole}, {kOrdinary, kShort}};
  if (!RetractsByPdg(planner)) {
    return {{kOrdinary, kWhole}, {kCareful, kShort}, {kOrdinary, kShort}, {kCareful, kWhole}};
  }
  const bool even = number % 2 == 0;
  return {{kOrdinary, kWhole},
          {kCareful, kShort},
          {kSmallerBodies, even ? kWhole : kShort},
          {kOrdinary, kShort},
          {kCareful, kWhole},
          {kThinnerGeoms, kWhole},
          {kSmallerGeoms, even ? kShort : kWhole}};
}

// Samples of slides and free bodies without limits come from a box around start and goal. Of the
// margin that the model's extent adds to it, whole in the first round, half is left in the next,
// then a quarter, an eighth, and all again: in a closed room nearly all of the whole box may be
// outside. Steps follow from the box. Of seven free bodies that are to leave half of a room
// through a hole 3 % wider, three seeds each, 21 are found within 20 s, and 9 with the whole box
// alone (bench/README.md, plan_bench).
double MarginShare(std::int64_t round) {
  constexpr std::int64_t kHalvings = 4;
  return std::ldexp(1.0, -static_cast<int>(round % kHalvings));
}

// Of the clearance that contact samples keep, the whole in the first round, a quarter in the next,
// a sixteenth, and all again: with less, motions along walls are harder to prove, with more, what
// is thin does not fit a hole that is hardly wider. Of the 69 passages of bench/passages, one seed
// each, 53 that are 1 % wider are found within 30 s with the whole clearance, and 63 so; of 138
// searches of those 3 % wider 127 and 126 end within 20 s (bench/README.md, plan_bench).
double ClearanceShare(std::int64_t round) {
  constexpr std::int64_t kQuarterings = 3;
  return std::ldexp(1.0, -2 * static_cast<int>(round % kQuarterings));
}

// How far bodies move in half of the short steps, at most [their radii]. A step of a flat hand of
// seven hinges is 8 radii long, one of the bridge's robot, too, one of a bent tube 1.2. Seconds per
// path of runs that begin with smaller bodies, with whole steps and with quarters: for the hand 8
// and 0.8, for the tube 1.7 and no path of 16 runs. Of eight arms, four seeds each, 31, 29 and 28
// are found within 20 s with 1, 2 and 4, of eight single bodies 26 with 1 and 29 with 2
// (bench/README.md, plan_bench).
constexpr double kRadiiOfAShortStep = 2.0;

double StepShare(const ConfigurationSpace& space, const PlanOptions& options, Steps steps,
                 double margin_share) {
  if (steps == Steps::kWhole) return 1.0;
  const ConfigurationSpace drawn(space, 0, margin_share);
  return std::min(1.0, kRadiiOfAShortStep / TypicalTravel(drawn, StepLength(options, drawn)));
}

// No scene is made until a run begins in one: that copies what a scene knows.
class ShrunkForEnds {
 public:
  explicit ShrunkForEnds(const RunsInput& input) : input_(input) {}

  // Those (plan/shrunk_scenes.h) in which start and goal are free, as they may not be for a body
  // that reaches around something, and at last the scene itself.
  std::span<const Scene> Get(Shrunk what) {
    std::vector<Scene>& scenes = scenes_[what];
    if (scenes.empty()) {
      scenes = ShrunkScenes(input_.scene, what);
      std::erase_if(scenes, [this](const Scene& scene) { return !EndsAreFree(scene); });
      scenes.push_back(input_.scene);
    }
    return scenes;
  }

 private:
  bool EndsAreFree(const Scene& scene) const {
    MotionProver prover(scene, input_.options.options,
                        std::make_shared<ConfigurationSpace>(input_.space, 0, 1.0));
    return prover.IsFree(input_.start) && prover.IsFree(input_.goal);
  }

  const RunsInput& input_;
  std::map<Shrunk, std::vector<Scene>> scenes_;
};

struct Run {
  std::int64_t number = 0;  // 1, 2, ...
  Kind kind = Kind::kOrdinary;
  std::int64_t samples = 0;       // at most so many
  double margin_share = 1.0;      // of the box of samples
  double step_share = 1.0;        // of the length of a planner's step
  ContactSlide::Options slide;    // of retractions
  std::span<const Scene> scenes;  // where it begins, and into which its path is retracted
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
    if (samples_left_ <= 0 || run.number >= found_ || Ended()) return false;
    if (next_ == turns_.size()) {
      turns_ = Round(input_.options.planner, ++round_);
      next_ = 0;
    }
    const Turn turn = turns_[next_++];
    run.kind = turn.kind;
    run.scenes = ScenesOf(run.kind);
    run.margin_share = MarginShare(round_);
    run.step_share = StepShare(input_.space, input_.options, turn.steps, run.margin_share);
    run.slide.careful = run.kind != Kind::kOrdinary;
    run.slide.clearance =
        std::lerp(input_.options.options.clearance, input_.clearance, ClearanceShare(round_));
    // Those that begin smaller take about as many samples as all others.
    const std::int64_t samples =
        kSamplesOfARun * Luby(round_ + 1) * (run.scenes.size() > 1 ? 3 : 1);
    run.samples = begins_anew_ ? std::min(samples_left_, samples)
                               : samples_left_;  // a run of OMPL's other planners has no end
    samples_left_ -= run.samples;
    return true;
  }

  std::span<const Scene> ScenesOf(Kind kind) {
    if (kind == Kind::kSmallerBodies) return shrunk_.Get(Shrunk::kBodies);
    if (kind == Kind::kSmallerGeoms) return shrunk_.Get(Shrunk::kGeoms);
    if (kind == Kind::kThinnerGeoms) return shrunk_.Get(Shrunk::kThickness);
    return {&input_.scene, 1};
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
    return {scene,
            input_.options,
            std::make_shared<ConfigurationSpace>(input_.space, seed, run.margin_share),
            run.slide,
            run.step_share,
            [&run, this] { return IsOver(run); }};
  }

  // Adds to what the run has cost.
  static void Add(const SearchCost& cost, Run& run) {
    run.result.nodes += cost.nodes;
    run.result.collision_queries += cost.collision_queries;
  }

  void Do(Run& run) {
    run.result = {};
    const std::uint64_t seed = SeedOf(run);
    const TreeSearchInput input = InputOf(run, run.scenes.front(), seed);
    TreeSearch search(input);
    run.result.path = search.Find(input_.start, input_.goal, run.samples);
    run.result.samples = input.space->samples();
    if (run.scenes.size() > 1) Straighten(search.prover(), input.ended, run.result.path);
    Add(search.cost(), run);
    Tighten(seed, run);
    if (run.result.path.empty()) return;
    std::int64_t before = found_;
    while (run.number < before && !found_.compare_exchange_weak(before, run.number)) {
    }
  }

  // Retracts the path step by step into the scene itself, with the samples that are left.
  void Tighten(std::uint64_t seed, Run& run) {
    for (const Scene& scene : run.scenes.subspan(1)) {
      if (run.result.path.empty()) return;
      const TreeSearchInput input = InputOf(run, scene, seed);
      Tightening tightening(input);
      run.result.path = tightening.Tighten(run.result.path, run.samples - run.result.samples);
      run.result.samples += input.space->samples();
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
  ShrunkForEnds shrunk_{input_};
  std::int64_t round_ = -1;
  std::vector<Turn> turns_;  // of the round
  std::size_t next_ = 0;     // of them
  std::int64_t taken_ = 0, samples_left_ = kNoBound;
  std::atomic<std::int64_t> found_ = kNoBound;  // the first run that found a path
  mutable std::mutex ended_;
  Runs all_;
};

}  // namespace

Runs Search(const RunsInput& input) { return Searching(input).Go(); }

}  // namespace mjcf_pdg
