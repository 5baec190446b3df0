// What bystanders.h promises: which trees are put back, and that nothing else is.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "problem/bystanders.h"
#include "problem/workspace.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class BystandersContractTest : public MujocoTest {};

enum class Trouble { kNone, kOverlap, kLimit, kCoupled, kAlone, kFrozen, kCount };

// Trees of a free or fixed base with a hinge, a slide and a ball, far from each other.
struct Trees {
  Trees(int count, Random& rng) : trouble(count, Trouble::kNone) {
    std::string world, equality;
    SceneOptions options;
    for (int i = 0; i < count; ++i) {
      if (rng.Chance(0.6)) {
        trouble[i] = static_cast<Trouble>(rng.Index(static_cast<int>(Trouble::kCount)));
      }
      if (i < 2 && trouble[i] == Trouble::kFrozen) trouble[i] = Trouble::kNone;
      if (i > 0 && trouble[i - 1] == Trouble::kCoupled && trouble[i] != Trouble::kFrozen) {
        trouble[i] = Trouble::kAlone;
      }
      const std::string n = std::to_string(i), pos = " pos='" + std::to_string(10 * i) + " 0 0'";
      world += "<body name='base" + n + "'" + pos + ">" + (i % 2 ? "<freejoint/>" : "") +
               "<geom size='.1'/><body name='link" + n + "'><joint name='h" + n +
               "' range='-60 60'/><joint type='slide' axis='1 0 0'/><geom size='.1' pos='1 0 0'/>"
               "<body name='end" +
               n +
               "'><joint type='ball' pos='1 0 0'/><geom size='.1' pos='2 0 0'/></body></body>"
               "</body>";
      if (trouble[i] == Trouble::kOverlap) world += "<geom type='box' size='3 3 .05'" + pos + "/>";
      if (trouble[i] != Trouble::kFrozen) continue;
      options.fixed.insert(options.fixed.end(), {"link" + n, "end" + n});
      if (i % 2) options.fixed.push_back("base" + n);
    }
    for (int i = 0; i < count; ++i) {
      const std::string n = std::to_string(i), next = std::to_string(i + 1);
      const bool partner = i + 1 < count && trouble[i + 1] == Trouble::kAlone;
      if (trouble[i] == Trouble::kCoupled && partner) {
        equality += "<joint joint1='h" + n + "' joint2='h" + next + "'/>";
      } else if (trouble[i] == Trouble::kAlone || trouble[i] == Trouble::kCoupled) {
        equality += "<joint joint1='h" + n + "' polycoef='0 0 0 0 0'/>";
      }
    }
    const std::string xml = "<mujoco><worldbody>" + world + "</worldbody><equality>" + equality +
                            "</equality></mujoco>";
    scene = std::make_unique<Scene>(Scene::FromString(xml, options));
  }
  std::vector<Trouble> trouble;
  std::unique_ptr<Scene> scene;
};

TEST_F(BystandersContractTest, TreesWithNothingWrongAreExactlyWhereTheUserPutThem) {
  Random rng(1);
  int put_back = 0, left = 0, unchanged = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const int count = 2 + rng.Index(5);
    const Trees trees(count, rng);
    const Scene& scene = *trees.scene;
    const std::vector<JointEntry>& joints = scene.tables().joints;
    const auto tree_of = [](const JointEntry& joint) { return (joint.body - 1) / 3; };
    std::vector<double> q_in = scene.DefaultQpos();
    for (const JointEntry& joint : joints) {
      if (joint.type == mjJNT_BALL) q_in[joint.qadr] = 2.0;  // a quaternion as users give them
      if (joint.type == mjJNT_HINGE && trees.trouble[tree_of(joint)] == Trouble::kLimit) {
        q_in[joint.qadr] = rng.Chance(0.5) ? 1.2 : -1.2;
      }
    }
    const Options options;
    Workspace work(scene.tables(), options);
    work.Begin(ToEigen(q_in));
    std::vector<double> q = q_in;
    const bool moves = trial % 10 != 0;
    for (double& entry : q) entry += moves && rng.Chance(0.7) ? rng.Normal() : 0.0;
    std::vector<double> expected = q;
    for (const JointEntry& joint : joints) {
      if (trees.trouble[tree_of(joint)] != Trouble::kNone) {
        ++left;
        continue;
      }
      ++put_back;
      std::copy_n(q_in.begin() + joint.qadr, QposEntries(joint), expected.begin() + joint.qadr);
    }
    const bool changes = expected != q;
    unchanged += !changes;
    Bystanders bystanders(scene.tables());
    const auto& overlaps = work.OverlapsAtInput();
    for (int again = 0; again < 2; ++again) {
      const bool changed = bystanders.PutBack(work.problem(), overlaps, q_in, q);
      EXPECT_EQ(changed, again == 0 && changes) << "trial " << trial;
      EXPECT_EQ(q, expected) << "trial " << trial;
    }
  }
  EXPECT_GT(put_back, 300);
  EXPECT_GT(left, 300);
  EXPECT_GT(unchanged, 20);
}

TEST_F(BystandersContractTest, AnOnlyTreeStays) {
  const Scene scene = Scene::FromString(
      "<mujoco><worldbody><body><joint/><geom size='.1' pos='1 0 0'/></body></worldbody></mujoco>");
  const Options options;
  Workspace work(scene.tables(), options);
  work.Begin(VectorXd::Zero(1));
  std::vector<double> q = {0.5};
  Bystanders bystanders(scene.tables());
  EXPECT_FALSE(bystanders.PutBack(work.problem(), work.OverlapsAtInput(), {0.0}, q));
  EXPECT_EQ(q, std::vector<double>{0.5});
}

}  // namespace
}  // namespace mjcf_pdg::test
