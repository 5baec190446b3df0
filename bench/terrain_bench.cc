// Robots pushed into waves, stairs and noise, beside the same robots pushed into a plane.
// README.md beside this file says what the columns mean.

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <random>

#include "collide/contacts.h"
#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "terrain_models.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

struct Arguments {
  std::vector<std::string> robots = TerrainRobots(), grounds = Grounds();
  int count = 40, persistence = 4;
  std::uint64_t seed = 1;
};

constexpr std::uint64_t kFirstPersistentSeed = 1000;
constexpr double kHighest = 3.0, kDeepest = 0.15, kAround = 3.0;  // [m]
constexpr int kQueries = 2000;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }

 private:
  std::mt19937_64 engine_;
};

// A pose somewhere over the ground: upright and turned, or (every third) fallen, with joints in the
// middle half of their ranges.
std::vector<double> DrawPose(const Scene& scene, int k, Draw& draw) {
  const mjModel& m = *scene.model();
  std::vector<double> q = scene.DefaultQpos();
  for (int j = 0; j < m.njnt; ++j) {
    if (m.jnt_type[j] != mjJNT_HINGE) continue;
    const double low = m.jnt_range[2 * j], high = m.jnt_range[2 * j + 1];
    q[m.jnt_qposadr[j]] = draw.Uniform(0.75 * low + 0.25 * high, 0.25 * low + 0.75 * high);
  }
  q[0] = draw.Uniform(-kAround, kAround);
  q[1] = draw.Uniform(-kAround, kAround);
  const double tilt = k % 3 == 2 ? draw.Uniform(1.0, 2.0) : draw.Uniform(-0.2, 0.2);
  const double yaw = draw.Uniform(-mjPI, mjPI), way = draw.Uniform(-mjPI, mjPI);
  const double axis[] = {std::cos(way), std::sin(way), 0.0}, up[] = {0.0, 0.0, 1.0};
  double turn[4], lean[4];
  mju_axisAngle2Quat(turn, up, yaw);
  mju_axisAngle2Quat(lean, axis, tilt);
  mju_mulQuat(q.data() + 3, lean, turn);
  return q;
}

// Lowers the pose on to the ground, and into it by up to kDeepest. False if its own links collide.
bool PushIn(Solver& solver, Draw& draw, std::vector<double>& q) {
  const double deep = draw.Uniform(0.005, kDeepest);
  double free = kHighest, blocked = -1.0;
  q[2] = free;
  if (!solver.IsFree(q)) return false;
  while (free - blocked > 1e-4) {
    q[2] = 0.5 * (free + blocked);
    (solver.IsFree(q) ? free : blocked) = q[2];
  }
  q[2] = free - deep;
  return true;
}

ProblemSet PushedIn(const Scene& scene, const std::string& name, const Arguments& arguments) {
  ProblemSet set{name, "", {}};
  Solver solver(scene);
  Draw draw(arguments.seed);
  for (int k = 0; static_cast<int>(set.problems.size()) < arguments.count; ++k) {
    BenchProblem problem{std::to_string(k), DrawPose(scene, k, draw)};
    if (PushIn(solver, draw, problem.q_in)) set.problems.push_back(std::move(problem));
  }
  return set;
}

// Microseconds of one query of contact features of a geom near the ground, and prisms asked.
std::pair<double, double> QueryCost(const Scene& scene, const ProblemSet& set) {
  const SceneTables& tables = scene.tables();
  ContactFinder finder(tables);
  const double margin = 0.1 * tables.size;
  std::vector<NearPair> near;
  double seconds = 0.0;
  std::int64_t queries = 0, asked = 0;
  for (int k = 0; queries < kQueries && k < 100 * kQueries; ++k) {
    finder.Pose(ToEigen(set.problems[k % set.problems.size()].q_in));
    for (std::size_t pair = 0; pair < tables.pairs.size(); ++pair) {
      if (tables.pairs[pair].kind != PairKind::kTerrain) continue;
      NearPair found;
      if (!finder.Distance(static_cast<int>(pair), margin, found)) continue;
      const std::int64_t before = finder.distances();
      const double begin = CpuSeconds();
      near.clear();
      finder.AppendFeatures(static_cast<int>(pair), margin, Depths::kMeasured, near);
      seconds += CpuSeconds() - begin;
      asked += finder.distances() - before;
      ++queries;
    }
  }
  return {1e6 * seconds / static_cast<double>(queries),
          static_cast<double>(asked) / static_cast<double>(queries)};
}

void Run(const Arguments& arguments) {
  std::printf("%-20s %4s %6s %9s %7s %7s %7s %8s %8s %9s %9s %8s %7s\n", "set", "n", "ok%",
              "certified", "ratio", "p95", "max", "ms", "p95", "x plane", "queries", "us/query",
              "prisms");
  for (const std::string& robot : arguments.robots) {
    double on_plane = std::nan("");
    for (const std::string& ground : arguments.grounds) {
      const Scene scene = Scene::FromString(TerrainXml(robot, ground));
      const ProblemSet set = PushedIn(scene, robot + "/" + ground, arguments);
      const Series series = Measure(scene, set, {}, {0, 1});
      std::vector<double> best = BestGiven(set);
      LowerBest(series, best);
      Options longer;
      longer.effort = Effort::kMax;
      LowerBest(Measure(scene, set, longer, {kFirstPersistentSeed, arguments.persistence}), best);
      Tally t;
      t.Add(series, best);
      std::vector<double> ms;
      int certified = 0;
      for (const Measured& solve : series.solves) {
        ms.push_back(1e3 * solve.seconds);
        certified += solve.result.certified && solve.verified;
      }
      if (ground == "plane") on_plane = Quantile(ms, 0.5);
      const auto [us, prisms] = ground == "plane" ? std::pair(0.0, 0.0) : QueryCost(scene, set);
      std::printf("%-20s %4d %6.1f %9d %7.4f %7.4f %7.3f %8.2f %8.2f %9.2f %9.0f %8.2f %7.1f\n",
                  set.name.c_str(), t.n, 100.0 * t.ok / t.n, certified, Quantile(t.ratio, 0.5),
                  Quantile(t.ratio, 0.95), Quantile(t.ratio, 1.0), Quantile(ms, 0.5),
                  Quantile(ms, 0.95), Quantile(ms, 0.5) / on_plane, Quantile(t.queries, 0.5), us,
                  prisms);
      std::fflush(stdout);
    }
  }
}

}  // namespace

int Main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("A humanoid and a quadruped pushed into height fields and into a plane.",
               "terrain_bench");
  app.add_option("--robot", arguments.robots, "humanoid, quadruped")
      ->delimiter(',')
      ->check(CLI::IsMember(TerrainRobots()));
  app.add_option("--ground", arguments.grounds,
                 "plane (first, to compare with), waves, stairs, noise")
      ->delimiter(',')
      ->check(CLI::IsMember(Grounds()));
  app.add_option("--count", arguments.count, "poses for each")->check(CLI::Range(1, 100000));
  app.add_option("--seed", arguments.seed, "of the poses");
  app.add_option("--persistence", arguments.persistence,
                 "seeds at effort max that only look for a lower σ")
      ->check(CLI::Range(0, 1000));
  return RunProgram(app, argc, argv, [&] { Run(arguments); });
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::Main(argc, argv); }
