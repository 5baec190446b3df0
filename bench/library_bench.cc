// Our own collision code and LCP compared with the libraries that could replace them: the time on
// the same inputs as a ratio to ours, the differences of the answers, and what each fails at.
// README.md beside this file says what the columns mean.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "library/questions.h"
#include "mjcf_pdg/pdg.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

void Run(const SetArguments& arguments) {
  SetArguments hulls = arguments, triangles = arguments;
  if (arguments.models.empty()) {
    for (const char* name : {"spoon_cup", "linked_rings", "l_shape_torus_knot", "pawn_cad",
                             "hammer_bumpy_sphere", "ball_in_cup", "ring_on_post"}) {
      triangles.models.push_back(std::string(MJCF_PDG_MODEL_DIR "/rigid/") + name + ".xml");
    }
  }
  triangles.exact_mesh = true;
  Table convex, meshes, lcp;
  int infeasible = 0;
  for (const Workload& workload : LoadSoundWorkloads(hulls)) {
    const auto questions = ConvexQuestions(*workload.scene, convex);
    for (const BenchProblem& problem : workload.set.problems) {
      const VectorXd q = Normalized(workload.scene->tables(), ToEigen(problem.q_in));
      questions->Ask(q);
      AskLcp(*workload.scene, q, lcp, infeasible);
    }
  }
  convex.Print({kOurs, kOursWarm, kMujoco, "FCL", "Coal"});
  Options fast;
  fast.effort = Effort::kFast;
  for (const Workload& workload : LoadSoundWorkloads(triangles)) {
    const SceneTables& tables = workload.scene->tables();
    const auto questions = TriangleQuestions(*workload.scene, 0.05, meshes);
    Solver solver(*workload.scene, fast);
    for (const BenchProblem& problem : workload.set.problems) {
      const VectorXd q_in = Normalized(tables, ToEigen(problem.q_in));
      VectorXd dq, q;
      Difference(tables, q_in, ToEigen(solver.Solve(problem.q_in).q), dq);
      for (const double times : {0.0, 1.0, 1.05, 1.5}) {
        Integrate(tables, q_in, times * dq, q);
        questions->Ask(q);
      }
    }
  }
  meshes.Print({kOurs, kOursWarm, "FCL", "Coal"});
  lcp.Print({kOurs, "DAQP", "DAQP, setup", "Gauss-Seidel"});
  std::printf("%d steps whose rows conflict, which have only an elastic answer, are left out\n",
              infeasible);
}

// Prints which of the optional libraries this program was built without.
void ReportMissing() {
#ifndef MJCF_PDG_HAVE_COAL
  std::printf("no Coal: built without it (README.md)\n");
#endif
#ifndef MJCF_PDG_HAVE_DAQP
  std::printf("no DAQP: built without it (README.md)\n");
#endif
}

}  // namespace

int Main(int argc, char** argv) {
  SetArguments arguments;
  CLI::App app("Our own collision code and LCP beside libraries.", "library_bench");
  AddSetArguments(app, arguments);
  return RunProgram(app, argc, argv, [&] {
    ReportMissing();
    Run(arguments);
  });
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) {
  const int status = mjcf_pdg::bench::Main(argc, argv);
  std::fflush(nullptr);
  // Skips static destructors, because FCL and Coal bring two versions of OctoMap that would both
  // free the same map.
  std::quick_exit(status);
}
