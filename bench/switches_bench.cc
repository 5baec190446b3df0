// How many changes of optimum a motion forces: with hindsight, the fewest with which Σσ stays
// within a share of that of solves, beside those of a Tracker. README.md beside this file says how.
#include <mujoco/mujoco.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "base/random.h"
#include "mjcf_pdg/pdg.h"
#include "track_motion.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Arguments : MotionArguments {
  int grid = 20;        // ticks from one solve, and one σ of an optimum, to the next
  int start_every = 5;  // solves from one optimum that is followed to the next
  double share = 1.1;   // of the solves' Σσ
};

// σ on the grid while an optimum is there; infinite before and after.
using Course = std::vector<double>;

// What solves find on the grid. σ is 0 where the command is free.
struct Solved {
  std::vector<Result> at;
  double Sigma(int k) const { return at[k].status == Status::kSolved ? at[k].sigma : 0.0; }
  bool Free(int k) const { return at[k].status == Status::kAlreadyFree; }
};

// The optimum that a solve found at one point of the grid, until it vanishes or the command is free
// of everything, forward in time (direction 1) or backward (-1).
void Follow(const Scene& scene, const Commands& commands, const Arguments& a, const Solved& solved,
            int from, int direction, Course& course) {
  TrackOptions options;
  options.options.report_lower_bound = false;
  options.switch_gain = 0.999;  // stays as long as it can
  Tracker tracker(scene, options);
  tracker.Reset(solved.at[from].q);
  Result result;
  const int last = a.ticks - 1;
  for (int tick = from * a.grid; tick >= 0 && tick <= last; tick += direction) {
    tracker.Step(commands.At(1e-3 * tick), result);
    if (result.switched || result.status != Status::kSolved) return;
    if (tick % a.grid == 0) course[tick / a.grid] = result.sigma;
  }
}

struct Choice {
  double sigma = 0.0;
  int switches = 0;
};

// The cheapest way along the courses where a switch costs `price`. Solves' own answers may be taken
// for one point of the grid. A switch where the command is free is none.
Choice Cheapest(const std::vector<Course>& courses, const Solved& solved, double price) {
  struct State {
    double cost = kInfinity;
    Choice choice;
    bool operator<(const State& other) const { return cost < other.cost; }
  };
  const int free = static_cast<int>(courses.size()), single = free + 1;
  std::vector<State> before(courses.size() + 2), now(before);
  before[free].cost = 0.0;
  for (int k = 0; k < static_cast<int>(solved.at.size()); ++k) {
    const auto best = std::min_element(before.begin(), before.end());
    std::fill(now.begin(), now.end(), State());
    if (solved.Free(k)) {
      now[free] = *best;
    } else {
      for (int c = 0; c <= single; ++c) {
        if (c == free) continue;
        const double sigma = c == single ? solved.Sigma(k) : courses[c][k];
        if (sigma == kInfinity) continue;
        const auto come = [&](State from, bool switched) {
          from.cost += sigma + switched * price;
          from.choice.sigma += sigma;
          from.choice.switches += switched;
          if (from.cost < now[c].cost) now[c] = from;
        };
        come(before[free], false);
        if (c != single) come(before[c], false);
        come(*best, true);
      }
    }
    std::swap(before, now);
  }
  return std::min_element(before.begin(), before.end())->choice;
}

// The fewest switches with which Σσ is at most `most`, by the price of a switch.
Choice Fewest(const std::vector<Course>& courses, const Solved& solved, double most) {
  double low = 1e-9 * most, high = most;
  Choice choice = Cheapest(courses, solved, low);
  for (int k = 0; k < 60; ++k) {
    const double price = std::sqrt(low * high);
    const Choice tried = Cheapest(courses, solved, price);
    (tried.sigma <= most ? low : high) = price;
    if (tried.sigma <= most && tried.switches <= choice.switches) choice = tried;
  }
  return choice;
}

void PrintRow(const std::string& path, const Arguments& a) {
  Random random(a.seed);
  const ModelPtr model = WithObstacles(path, a, random);
  const Scene scene = Scene::FromModel(model.get());
  const Commands commands(*model, a, random);
  Options options;
  options.report_lower_bound = false;
  Solver solver(scene, options);
  TrackOptions track;
  track.options.report_lower_bound = false;
  Tracker tracker(scene, track);
  Solved solved;
  Result result;
  Choice tracked;
  double all = 0.0;
  for (int tick = 0; tick < a.ticks; ++tick) {
    const Q command = commands.At(1e-3 * tick);
    tracker.Step(command, result);
    tracked.switches += result.switched;
    if (tick % a.grid != 0) continue;
    Result& at = solved.at.emplace_back();
    solver.Solve(command, at);
    all += at.status == Status::kSolved ? at.sigma : 0.0;
    tracked.sigma += result.status == Status::kSolved ? result.sigma : 0.0;
  }
  const int points = static_cast<int>(solved.at.size());
  std::vector<Course> courses;
  for (int k = 0; k < points; k += a.start_every) {
    if (solved.at[k].status != Status::kSolved) continue;
    Course& course = courses.emplace_back(points, kInfinity);
    Follow(scene, commands, a, solved, k, 1, course);
    Follow(scene, commands, a, solved, k, -1, course);
  }
  const Choice fewest = Fewest(courses, solved, a.share * all);
  const Choice as_near = Fewest(courses, solved, tracked.sigma);
  const std::string name = path.substr(path.find_last_of('/') + 1);
  std::printf("%-24s %7zu %7d %7.3f %7d %7.3f %7d %7.3f\n", name.c_str(), courses.size(),
              tracked.switches, tracked.sigma / all, fewest.switches, fewest.sigma / all,
              as_near.switches, as_near.sigma / all);
  std::fflush(stdout);
}

void Run(const Arguments& arguments) {
  std::printf("%-24s %7s %7s %7s %7s %7s %7s %7s\n", "model", "optima", "tracker", "sigma",
              "forced", "sigma", "as near", "sigma");
  const std::vector<std::string> models = arguments.models.empty() ? OwnModels() : arguments.models;
  for (const std::string& path : models) PrintRow(path, arguments);
}

}  // namespace
}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) {
  CLI::App app("How many changes of optimum a motion forces");
  mjcf_pdg::bench::Arguments a;
  mjcf_pdg::bench::AddMotionArguments(app, a);
  app.add_option("--grid", a.grid, "Ticks from one solve to the next");
  app.add_option("--start-every", a.start_every, "Solves from one followed optimum to the next");
  app.add_option("--share", a.share, "Of the solves' sum of sigma that may be spent");
  return mjcf_pdg::bench::RunProgram(app, argc, argv, [&] { mjcf_pdg::bench::Run(a); });
}
