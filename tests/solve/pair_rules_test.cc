// Pairs that do not count because the options say so: excluded, allowed to overlap, permanent;
// joints that are fixed; contacts that are kept.
#include <gmock/gmock.h>

#include "mjcf_pdg/pdg.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Q = std::vector<double>;

// A finger on a slide, 3 cm deep in a pad and 1 cm in a post.
constexpr char kFinger[] = R"(<mujoco><worldbody>
  <geom name="pad" type="box" size=".1 .5 .5" pos="-.1 0 0"/>
  <geom name="post" type="box" size=".1 .1 .1" pos=".06 .09 0"/>
  <body name="finger"><joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/>
    <geom name="tip" type="box" size=".03 .01 .03"/></body></worldbody></mujoco>)";

TEST(PairRules, ExcludedPairsDoNotCount) {
  SceneOptions options;
  options.exclude = {{"pad", "finger"}};
  const Scene scene = Scene::FromString(kFinger, options);
  EXPECT_EQ(scene.num_kept_pairs(), 1);
  EXPECT_TRUE(Verify(scene, Q{-.2, -.2}).free);
  EXPECT_FALSE(Verify(scene, Q{0, 0}).free);
  const Result result = Solver(scene).Solve(Q{0, 0});
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_NEAR(result.q[1], -.02, 1e-5);
  EXPECT_NEAR(result.q[0], 0, 1e-5);
}

TEST(PairRules, AnOverlapIsAllowedSoDeepAndNoDeeper) {
  SceneOptions options;
  options.exclude = {{"post", "tip"}};
  options.allow = {{{"tip", "pad"}, .01}};
  const Scene scene = Scene::FromString(kFinger, options);
  const Result result = Solver(scene).Solve(Q{0, 0});
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_NEAR(result.q[0], .02, 1e-5);
  EXPECT_TRUE(Verify(scene, Q{.0201, 0}).free);
  EXPECT_FALSE(Verify(scene, Q{.0199, 0}).free);
}

TEST(PairRules, BadNamesAndDepthsAreRefused) {
  SceneOptions options;
  options.exclude = {{"tip", "nobody"}};
  EXPECT_THAT(ErrorOf([&] { Scene::FromString(kFinger, options); }),
              AllOf(HasSubstr("'nobody'"), HasSubstr("finger")));
  options = {};
  options.allow = {{{"tip", "pad"}, -1.0}};
  EXPECT_THAT(ErrorOf([&] { Scene::FromString(kFinger, options); }), HasSubstr("allowed overlap"));
  options = {};
  options.fixed = {"nobody"};
  EXPECT_THAT(ErrorOf([&] { Scene::FromString(kFinger, options); }), HasSubstr("'nobody'"));
}

// Legs and arms but not the pelvis: a fixed body's own joints stay, those below it move.
TEST(PairRules, FixedBodiesKeepTheirOwnJoints) {
  constexpr char kPelvis[] = R"(<mujoco><worldbody>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="pelvis" pos="0 0 .3"><freejoint name="root"/><geom name="pelvis" size=".05"/>
      <body name="leg"><joint name="hip" axis="0 1 0"/>
        <geom name="leg" type="capsule" fromto="0 0 -.06 0 0 -.35" size=".03"/></body></body>
    </worldbody></mujoco>)";
  SceneOptions options;
  options.fixed = {"pelvis"};
  const Scene scene = Scene::FromString(kPelvis, options);
  EXPECT_EQ(scene.dof(), 1);
  const Q q_in = scene.DefaultQpos();
  const Result result = Solver(scene).Solve(q_in);
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_TRUE(std::equal(q_in.begin(), q_in.begin() + 7, result.q.begin()));
  EXPECT_NE(result.q[7], 0.0);
}

// The hub is always in the shaft, whichever way they turn.
constexpr char kHub[] = R"(<mujoco><worldbody>
  <geom name="wall" type="box" size=".1 1 1" pos=".55 0 0"/>
  <body name="shaft"><joint name="a" axis="0 0 1"/><geom name="shaft" size=".1"/>
    <body name="link"><joint name="b" axis="0 0 1"/><geom name="link" type="capsule" fromto=".2 0 0 .5 0 0" size=".03"/>
      <body name="hub"><joint name="c" axis="0 0 1"/><geom name="hub" size=".08"/></body></body></body>
  </worldbody></mujoco>)";

TEST(PairRules, PermanentOverlapsAreSetAsideWhereThatIsAskedFor) {
  const Scene all = Scene::FromString(kHub);
  EXPECT_TRUE(all.IgnoredPairs().empty());
  const Result unsolved = Solver(all).Solve(Q{0, 0, 0});
  EXPECT_EQ(unsolved.status, Status::kUnsolved);
  EXPECT_EQ(unsolved.cause, Cause::kPermanent);

  SceneOptions options;
  options.ignore_permanent = true;
  const Scene scene = Scene::FromString(kHub, options);
  const mjModel* m = scene.model();
  const int shaft = mj_name2id(m, mjOBJ_GEOM, "shaft"), hub = mj_name2id(m, mjOBJ_GEOM, "hub");
  EXPECT_THAT(scene.IgnoredPairs(), ElementsAre(std::array<int, 2>{shaft, hub}));
  const Result result = Solver(scene).Solve(Q{0, 0, 0});
  EXPECT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_TRUE(Verify(scene, result.q).free);
}

// What cannot be solved stays where it was if moving does not help.
TEST(PairRules, UnsolvedIsNotMovedForNothing) {
  const Scene scene = Scene::FromString(kHub);
  const Q q_in = {2.0, 0, 0};  // the link is clear of the wall: only the hub is left
  const Result result = Solver(scene).Solve(q_in);
  EXPECT_EQ(result.status, Status::kUnsolved);
  EXPECT_EQ(result.q, q_in);
  EXPECT_EQ(result.sigma, 0.0);
}

TEST(PairRules, KeptContactsAreCounted) {
  // The tip leaves the post sideways and slides along the pad, which it is allowed to press.
  SceneOptions options;
  options.allow = {{{"tip", "pad"}, .03}};
  Options report;
  report.report_contacts = true;
  const Result result = Solver(Scene::FromString(kFinger, options), report).Solve(Q{0, 0});
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_EQ(result.contacts_in.size(), 2u);
  EXPECT_EQ(result.contacts_kept, 2);  // the post is touched still
  const Result far = Solver(Scene::FromString(kFinger), report).Solve(Q{-.4, .9});
  EXPECT_EQ(far.contacts_in.size(), static_cast<std::size_t>(far.contacts_kept));
}

}  // namespace
}  // namespace mjcf_pdg::test
