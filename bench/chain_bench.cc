// What a solve costs where one tree is long: chains of capsules whose hinges turn about two axes by
// turns, in random poses. A chain overlaps itself wherever it comes by, and what one link needs
// moves all that hang on it.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::bench {
namespace {

constexpr double kLength = 0.1, kRadius = 0.02;  // of a link [m]

struct Arguments {
  std::vector<int> counts{5, 10, 20, 50, 100, 200};
  int poses = 20;
  double range = 60.0;  // of each hinge, both ways [°]
};

// Links hang from the world; neighbours do not collide, as MuJoCo has it of parent and child.
Scene Chain(int count, double range) {
  std::string xml = "<mujoco><compiler angle=\"degree\"/><worldbody>", end;
  for (int k = 0; k < count; ++k) {
    xml += "<body pos=\"0 0 " + std::to_string(k == 0 ? 0.0 : kLength) + "\"><joint axis=\"" +
           (k % 2 == 0 ? "1 0 0" : "0 1 0") + "\" range=\"" + std::to_string(-range) + " " +
           std::to_string(range) + "\"/><geom type=\"capsule\" size=\"" + std::to_string(kRadius) +
           "\" fromto=\"0 0 0 0 0 " + std::to_string(kLength) + "\"/>";
    end += "</body>";
  }
  return Scene::FromString(xml + end + "</worldbody></mujoco>");
}

void PrintChains(int count, const Arguments& arguments) {
  const Scene scene = Chain(count, arguments.range);
  Solver solver(scene);
  std::mt19937 random(count);
  const double range = arguments.range * M_PI / 180.0;
  std::uniform_real_distribution<double> angle(-range, range);
  std::vector<double> seconds, queries, evaluations, lengths;
  int solved = 0, colliding = 0;
  for (int tries = 0; colliding < arguments.poses && tries < 1000; ++tries) {
    std::vector<double> q(count);
    for (double& a : q) a = angle(random);
    if (solver.IsFree(q)) continue;
    ++colliding;
    const double begin = CpuSeconds();
    const Result result = solver.Solve(q);
    seconds.push_back(CpuSeconds() - begin);
    queries.push_back(result.stats.collision_queries);
    evaluations.push_back(seconds.back() / EvaluationSeconds(scene, q));
    const bool ok = result.status == Status::kSolved && Verify(scene, result.q).free;
    solved += ok;
    if (ok) lengths.push_back(std::sqrt(result.sigma));
  }
  if (colliding == 0) return;
  std::printf("%6d %6d/%d %10.1f %10.1f %9.0f %9.0f %9.1f\n", count, solved, colliding,
              1e3 * Quantile(seconds, 0.5), 1e3 * Quantile(seconds, 1.0), Quantile(queries, 0.5),
              Quantile(evaluations, 0.5), lengths.empty() ? 0.0 : 1e3 * Quantile(lengths, 0.5));
  std::fflush(stdout);
}

}  // namespace
}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) try {
  using namespace mjcf_pdg::bench;
  CLI::App app("Chains of many links in random poses");
  Arguments arguments;
  app.add_option("--links", arguments.counts, "Numbers of links")->delimiter(',');
  app.add_option("--poses", arguments.poses, "Poses that overlap, of each number");
  app.add_option("--range", arguments.range, "Of each hinge, both ways [deg]");
  CLI11_PARSE(app, argc, argv);
  std::printf("%6s %9s %10s %10s %9s %9s %9s\n", "links", "solved", "ms median", "ms most",
              "queries", "evals", "mm");
  for (const int count : arguments.counts) PrintChains(count, arguments);
  return 0;
} catch (const mjcf_pdg::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
