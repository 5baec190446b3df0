// The scenes of models/ that are made to be planned in: they are what they are said to be, and are
// passed.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "mjcf_pdg/motion.h"
#include "tests/plan/plan_test_support.h"
#include "tests/support/trials.h"

namespace mjcf_pdg {
namespace {

// The scenes of Table IV are what they are said to be: links, degrees of freedom, triangles, and
// ends that are free.
TEST(PlanScenesTest, ScenesAreAsInThePaper) {
  struct Paper {
    const char* name;
    int links, dof, triangles;
  };
  for (const Paper& paper : {Paper{"placement", 15, 41, 52000}, {"bridge", 13, 40, 31000}}) {
    SCOPED_TRACE(paper.name);
    const std::string path =
        std::string(MJCF_PDG_MODEL_DIR) + "/" + paper.name + "/" + paper.name + ".xml";
    const Scene scene = Scene::FromFile(path);
    const mjModel& m = *scene.model();
    EXPECT_EQ(scene.dof(), paper.dof);
    EXPECT_EQ(std::count_if(m.body_dofnum, m.body_dofnum + m.nbody, [](int n) { return n > 0; }),
              paper.links);
    int triangles = 0;
    for (int g = 0; g < m.ngeom; ++g) {
      if (m.geom_type[g] == mjGEOM_MESH) triangles += m.mesh_facenum[m.geom_dataid[g]];
    }
    EXPECT_NEAR(triangles, paper.triangles, 1000);
    EXPECT_EQ(scene.KeyNames(), (std::vector<std::string>{"start", "goal"}));
    Solver solver(scene);
    EXPECT_TRUE(solver.IsFree(scene.KeyQpos(0)));
    EXPECT_TRUE(solver.IsFree(scene.KeyQpos(1)));
    // There is something in the way.
    EXPECT_EQ(CheckMotion(scene, scene.KeyQpos(0), scene.KeyQpos(1)).outcome,
              MotionOutcome::kContact);
  }
}

// Without beginning anew, three of eight searches found nothing in more samples.
TEST(PlanScenesTest, TheBridgeIsPassedWhateverTheSeed) {
  const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/bridge/bridge.xml");
  for (int seed = 0; seed < test::Trials(8); ++seed) {
    PlanOptions options = With("birrt-pdg", static_cast<std::uint64_t>(seed));
    options.max_samples = 5000;
    EXPECT_TRUE(Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1), options).found) << seed;
  }
}

TEST(PlanScenesTest, NarrowPassagesOfKnownWidthArePassed) {
  for (const std::string name : {"gap", "slot", "socket", "peg", "piano"}) {
    SCOPED_TRACE(name);
    const Scene scene =
        Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/passages/" + name + ".xml",
                        {.exact_mesh = name == "piano"});
    ExpectFree(scene, Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1), With("birrt-pdg", 1)),
               scene.KeyQpos(0), scene.KeyQpos(1));
  }
}

TEST(PlanScenesTest, TheFigurePutsTheToolIntoTheShelf) {
  const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/placement/placement.xml");
  ExpectFree(scene, Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1), With("birrt-pdg")),
             scene.KeyQpos(0), scene.KeyQpos(1));
}

}  // namespace
}  // namespace mjcf_pdg
