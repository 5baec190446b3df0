#include "triangle_cost.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "base/random.h"
#include "collide/contacts.h"
#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "oracle_tally.h"
#include "tests/support/mesh_shapes.h"

namespace mjcf_pdg::bench {
namespace {

constexpr int kPoses = 30;                   // poses of each kind
constexpr double kSize = 0.1;                // size of the knots [m]
constexpr double kNear = 1e-4, kFar = 0.05;  // distances at which queries are timed [m]
constexpr double kBeside = 1e-3;             // a warm query follows a query this far away [m]
constexpr double kDeep = -0.005;             // about the signed distance of overlaps [m]
constexpr double kMargin = 0.005;            // features of the rows are at most this far apart [m]

// A scene of two torus knots, one on a free joint, of 16 nu² triangles each.
Scene KnotScene(int nu) {
  const test::MeshShape knot = test::TorusKnot(kSize, 0.3 * kSize, 8 * nu, nu);
  const std::string xml = "<mujoco><asset>" + test::MeshXml("knot", knot, "inertia='exact'") +
                          "</asset><worldbody><geom type='mesh' mesh='knot'/><body><freejoint/>"
                          "<geom type='mesh' mesh='knot'/></body></worldbody></mujoco>";
  return Scene::FromString(xml, test::Exact());
}

std::vector<double> RandomPose(Random& random, double away) {
  Vector3d way(random.Normal(), random.Normal(), random.Normal());
  Eigen::Vector4d turn(random.Normal(), random.Normal(), random.Normal(), random.Normal());
  way = away * way.normalized();
  turn.normalize();
  return {way[0], way[1], way[2], turn[0], turn[1], turn[2], turn[3]};
}

// The signed distance of the two knots at q, at most 10 m.
double Distance(ContactFinder& finder, const std::vector<double>& q) {
  finder.Pose(Eigen::Map<const VectorXd>(q.data(), 7));
  NearPair near;
  return finder.Distance(0, 10.0, near) ? near.distance : 10.0;
}

// Poses at this signed distance: the moving knot is turned at random, put far away in a random
// direction, and moved towards the other one's centre; for an overlap, it is moved on from contact
// by its depth.
std::vector<std::vector<double>> PosesAt(const Scene& scene, double distance) {
  ContactFinder finder(scene.tables());
  Random random(7);
  std::vector<std::vector<double>> poses;
  for (int k = 0; k < kPoses; ++k) {
    const std::vector<double> start = RandomPose(random, 6.0 * kSize);
    std::vector<double> q = start;
    double share = 1.0;  // of the way back to `start`; no step is longer than the distance
    for (int step = 0; step < 200; ++step) {
      const double ahead = Distance(finder, q) - std::max(distance, kNear);
      if (ahead < 0.01 * kNear) break;
      share -= ahead / (6.0 * kSize);
      for (int i = 0; i < 3; ++i) q[i] = share * start[i];
    }
    if (distance < 0.0) {  // on from contact
      share += distance / (6.0 * kSize);
      for (int i = 0; i < 3; ++i) q[i] = share * start[i];
    }
    poses.push_back(q);
  }
  return poses;
}

// The median over the poses of the time of a query [µs], for each pose the least of three. A query
// is from scratch, or, if `before` > 0, follows a query at a pose that is `before` away [m].
double MedianUs(const Scene& scene, const std::vector<std::vector<double>>& poses,
                const std::function<void(ContactFinder&)>& query, double before = 0.0) {
  ContactFinder finder(scene.tables());
  std::vector<double> us;
  for (const std::vector<double>& q : poses) {
    const VectorXd at = Eigen::Map<const VectorXd>(q.data(), 7);
    finder.Pose(at);
    double least = 1e9;
    for (int k = 0; k < 3; ++k) {
      finder.Forget();
      if (before > 0.0) {
        VectorXd beside = at;
        beside.head<3>() += before * Vector3d(1.0, 1.0, 1.0).normalized();
        finder.Pose(beside);
        query(finder);
        finder.Pose(at);
      }
      const double begin = CpuSeconds();
      query(finder);
      least = std::min(least, 1e6 * (CpuSeconds() - begin));
    }
    us.push_back(least);
  }
  return Quantile(us, 0.5);
}

// A row of the table.
struct Cost {
  double triangles = 0.0;       // in each mesh
  std::vector<double> entries;  // one per name in kColumns
  double verify_ms = 0.0;
};

const char* const kColumns[] = {"far dist",  "... warm", "near dist",  "far free",
                                "near free", "overlap",  "rows",       "depth",
                                "fast ms",   "queries",  "default ms", "queries"};

// Appends the median time [ms] and the median collision queries of solves to `entries`. CGAL is
// asked about each answer.
void AppendSolves(const Scene& scene, const std::vector<std::vector<double>>& poses,
                  const Options& options, OracleTally& oracle, std::vector<double>& entries) {
  Solver solver(scene, options);
  std::vector<double> ms, queries;
  for (const std::vector<double>& q : poses) {
    const double begin = CpuSeconds();
    const Result result = solver.Solve(q);
    ms.push_back(1e3 * (CpuSeconds() - begin));
    queries.push_back(result.stats.collision_queries);
    oracle.Ask(result);
  }
  entries.push_back(Quantile(ms, 0.5));
  entries.push_back(Quantile(queries, 0.5));
}

Cost Measure(const Scene& scene, double tolerance, int frames, OracleTally& oracle) {
  auto distance = [](ContactFinder& finder) {
    NearPair near;
    finder.Distance(0, 10.0, near);
  };
  auto free = [](ContactFinder& finder) { finder.Find(0.0, Depths::kSkipped); };
  auto rows = [](ContactFinder& finder) { finder.Find(kMargin, Depths::kSkipped); };
  auto depth = [](ContactFinder& finder) { finder.Find(0.0, Depths::kMeasured); };
  const auto far = PosesAt(scene, kFar), near = PosesAt(scene, kNear), deep = PosesAt(scene, kDeep);
  Cost cost;
  cost.entries = {MedianUs(scene, far, distance),  MedianUs(scene, far, distance, kBeside),
                  MedianUs(scene, near, distance), MedianUs(scene, far, free),
                  MedianUs(scene, near, free),     MedianUs(scene, deep, free),
                  MedianUs(scene, near, rows),     MedianUs(scene, deep, depth)};
  Options options;
  options.tolerance = tolerance;
  const std::vector<std::vector<double>> few(deep.begin(), deep.begin() + std::min(frames, kPoses));
  for (const Effort effort : {Effort::kFast, Effort::kDefault}) {
    options.effort = effort;
    AppendSolves(scene, few, options, oracle, cost.entries);
  }
  const double begin = CpuSeconds();
  for (const std::vector<double>& q : near) Verify(scene, q, options);
  cost.verify_ms = 1e3 * (CpuSeconds() - begin) / kPoses;
  return cost;
}

// The slope of log(entry) over log(triangles) from row `first` on, by least squares.
double Exponent(const std::vector<Cost>& costs, std::size_t column, std::size_t first) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t row = first; row < costs.size(); ++row) {
    const double u = std::log(costs[row].triangles), v = std::log(costs[row].entries[column]);
    n += 1.0;
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

void PrintTriangleCost(double tolerance, int largest, int frames) {
  std::printf("Cost against triangles: two torus knots, each of so many; medians, from scratch\n");
  std::printf(
      "  distance and freedom 5 cm apart (far; warm: after a query 1 mm away) and 0.1 mm apart "
      "(near), overlap 5 mm along a "
      "random "
      "line: told (overlap) and measured (depth); rows: features within 5 mm near contact [us]; "
      "CGAL: answers failed/asked\n");
  std::printf("  %9s %8s", "triangles", "build s");
  for (const char* column : kColumns) std::printf(" %10s", column);
  std::printf(" %10s %7s\n", "Verify ms", "CGAL");
  std::vector<Cost> costs;
  for (int nu = 8; 16 * nu * nu <= largest; nu *= 2) {
    const double begin = CpuSeconds();
    const Scene scene = KnotScene(nu);
    const double build = CpuSeconds() - begin;
    OracleTally oracle(scene, tolerance);
    costs.push_back(Measure(scene, tolerance, frames, oracle));
    Cost& cost = costs.back();
    cost.triangles = 16.0 * nu * nu;
    std::printf("  %9.0f %8.2f", cost.triangles, build);
    for (const double entry : cost.entries) std::printf(" %10.1f", entry);
    std::printf(" %10.1f %4d/%d\n", cost.verify_ms, oracle.failed(), oracle.asked());
    std::fflush(stdout);
  }
  if (costs.size() < 2) return;
  for (const std::size_t first : {std::size_t{0}, costs.size() - 2}) {
    std::printf("  %18s", first == 0 ? "exponent" : "... of the end");
    for (std::size_t k = 0; k < costs[0].entries.size(); ++k) {
      std::printf(" %10.2f", Exponent(costs, k, first));
    }
    std::printf("\n");
  }
}

}  // namespace mjcf_pdg::bench
