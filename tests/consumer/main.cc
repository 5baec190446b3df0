// Uses the installed library as README and docs/consumers.md show it: a ball stuck in the floor.
#include <cstdio>
#include <vector>

#include "follow.h"
#include "mjcf_pdg/pdg.h"

namespace {

// An Error thrown inside the library arrives as one.
bool CatchesErrors(mjcf_pdg::Solver& solver) {
  try {
    solver.IsFree(std::vector<double>(2, 0.0));
  } catch (const mjcf_pdg::Error& error) {
    std::printf("error, as it should be: %s\n", error.what());
    return true;
  }
  return false;
}

}  // namespace

int main() {
  const mjcf_pdg::Scene scene = mjcf_pdg::Scene::FromString(R"(
      <mujoco>
        <worldbody>
          <geom name="floor" type="plane" size="1 1 0.1"/>
          <body pos="0 0 0.08">
            <joint type="slide" axis="0 0 1"/>
            <geom name="ball" size="0.1"/>
          </body>
        </worldbody>
      </mujoco>)");
  mjcf_pdg::Solver solver(scene);
  const mjcf_pdg::Result result = solver.Solve(std::vector<double>(1, 0.0));
  std::printf("up by %g m (expected 0.02)\n", result.q[0]);
  if (result.status != mjcf_pdg::Status::kSolved) return 1;

  // As a control loop does: however small the budget, a free hint makes the answer free.
  solver.SetHint(result.q);
  solver.SetBudget({.queries = 1, .seconds = 0.0});
  mjcf_pdg::Result again;
  solver.Solve(std::vector<double>(1, -0.01), again);
  if (!solver.IsFree(again.q)) return 1;

  if (!FollowsCommandsWithoutTouching(scene.model())) return 1;
  return CatchesErrors(solver) ? 0 : 1;
}
