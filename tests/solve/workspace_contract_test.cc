// What a workspace calls free and what overlaps, by looking at all pairs however far they are.
#include <string>

#include "problem/workspace.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class WorkspaceTest : public MujocoTest {};

// A free box of half size `half` whose triangles hang `gap` above a block; a ball that overlaps the
// block for good.
struct Hanging {
  Hanging(double half, double clearance)
      : scene(Scene::FromString(Xml(half), Exact())),
        options{.clearance = clearance},
        work(scene.tables(), options) {}

  static std::string Xml(double half) {
    const MeshShape box = BoxMesh(Vector3d::Constant(half));
    MeshShape dented = box;  // no longer its own hull
    dented.Append(MeshShape(BoxMesh(Vector3d::Constant(0.3 * half)))
                      .Move(Matrix3d::Identity(), Vector3d(0, 0, 1.2 * half)));
    const double at = 3 * half;
    const Vector3d low(at, 0, -half), high(at, 0, half);
    return "<mujoco><asset>" + MeshXml("box", dented) + "</asset><worldbody><geom size='" +
           Join(&half, 1) + "' pos='-99 0 0'/><geom type='box' size='" +
           Join(Vector3d::Constant(half)) + "' pos='" + Join(low) + "'/><body pos='" + Join(high) +
           "'><freejoint/><geom type='mesh' mesh='box'/></body></worldbody></mujoco>";
  }
  VectorXd At(double gap) const {
    VectorXd q = ToEigen(scene.DefaultQpos());
    q[2] += gap;
    return q;
  }
  // The pair's distance less what it must keep.
  double Excess(const VectorXd& q) {
    ContactFinder finder(scene.tables(), work.problem().clearance);
    finder.Pose(q);
    const std::vector<NearPair>& near = finder.Find(0.1 + work.problem().clearance);
    EXPECT_FALSE(near.empty());
    return near.empty() ? 1.0 : near[0].distance - work.problem().required[near[0].pair];
  }

  Scene scene;
  Options options;
  Workspace work;
};

TEST_F(WorkspaceTest, FreeMeansThatNoPairIsNearerThanRequired) {
  int free = 0, overlapping = 0;
  for (const double half : {0.05, 0.3, 1.0}) {
    for (const double clearance : {0.0, 0.02}) {
      Hanging p(half, clearance);
      const double accept = p.work.problem().tolerances.accept;
      for (double gap = -3e-6; gap < 5e-6; gap += 0.11e-6) {
        const VectorXd q = p.At(clearance + gap);
        const double excess = p.Excess(q);
        if (std::abs(excess + accept) > 2e-8) {
          EXPECT_EQ(p.work.Free(q), excess > -accept) << half << " " << clearance << " " << gap;
        }
        p.work.Begin(q);
        if (std::abs(excess) > 2e-8) {
          EXPECT_EQ(p.work.OverlapsAtInput().empty(), excess > 0.0)
              << half << " " << clearance << " " << gap;
        }
        free += excess > 0.0;
        overlapping += excess < -accept;
      }
    }
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(overlapping, 50);
}

}  // namespace
}  // namespace mjcf_pdg::test
