// What Solver::IsFree takes, for python/bench.py to compare with: a line "MODEL microseconds"
// for each argument MODEL. The median of eleven runs; keyframe 0, or qpos0 where there is none.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::bench {
namespace {

double Microseconds(Solver& solver, const std::vector<double>& q, int calls) {
  std::array<double, 11> runs;
  for (double& run : runs) {
    const auto begin = std::chrono::steady_clock::now();
    for (int call = 0; call < calls; ++call) solver.IsFree(q);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
    run = took.count() / calls;
  }
  std::nth_element(runs.begin(), runs.begin() + 5, runs.end());
  return runs[5];
}

void PrintLine(const std::string& path) {
  const Scene scene = Scene::FromFile(path);
  Solver solver(scene);
  const bool keys = !scene.KeyNames().empty();
  const std::vector<double> q = keys ? scene.KeyQpos(0) : scene.DefaultQpos();
  const int calls = 1 + static_cast<int>(2e4 / Microseconds(solver, q, 100));
  std::printf("%s %.3f\n", path.c_str(), Microseconds(solver, q, calls));
}

}  // namespace
}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) try {
  for (int k = 1; k < argc; ++k) mjcf_pdg::bench::PrintLine(argv[k]);
  return 0;
} catch (const mjcf_pdg::Error& error) {
  std::fprintf(stderr, "is_free_bench: %s\n", error.what());
  return 2;
}
