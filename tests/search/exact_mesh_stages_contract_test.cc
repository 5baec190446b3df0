// What hull_stage.h and exact_mesh_starts.h promise, on scenes of a cup whose hollow its hull
// fills.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/tuning.h"
#include "search/exact_mesh_starts.h"
#include "search/hull_stage.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class ExactMeshStagesContractTest : public MujocoTest {};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A cup, whose wall reaches from 0.08 to 0.1 m, and in it a box that joints move.
std::string BoxInCup(const std::string& joints) {
  return "<mujoco><asset>" + MeshXml("cup", Cup(0.1, 0.2, 0.02, 40)) +
         "</asset><worldbody><geom type='mesh' mesh='cup'/><body pos='0 0 .1'>" + joints +
         "<geom type='box' size='.02 .02 .02'/></body><body mocap='true' pos='5 0 0'>"
         "<geom size='.1'/></body></worldbody></mujoco>";
}
const std::string kSlide = "<joint type='slide' axis='1 0 0'/>";

// ---- The search on hulls ----

TEST_F(ExactMeshStagesContractTest, TheHullsAnswerIsNearestForHullsAndFreeForTriangles) {
  const Scene scene = Scene::FromString(BoxInCup(kSlide), Exact());
  const Options options;
  Workspace work(scene.tables(), options);
  HullStage stage;
  EXPECT_EQ(stage.queries(), 0);
  std::int64_t queries = 0;
  for (const double x : {0.07, -0.06001, 0.09, 0.02}) {
    work.Begin(VectorXd::Constant(1, x));
    const std::int64_t own = work.finder.queries();
    const VectorXd* const q = stage.Run(work);
    ASSERT_NE(q, nullptr);
    EXPECT_EQ(work.finder.queries(), own);
    EXPECT_EQ(work.problem().q_in[0], x);
    EXPECT_GT(stage.queries(), queries);
    queries = stage.queries();
    // Of the hull, a prism of 40 sides, the box is free beyond the wall only.
    const double out = std::copysign(0.12, x);
    EXPECT_NEAR((*q)[0], out, 1e-3);
    EXPECT_TRUE(work.Free(*q));
  }
}

TEST_F(ExactMeshStagesContractTest, WhereNothingIsFreeOfTheHullThereIsNoAnswer) {
  const Scene scene =
      Scene::FromString(BoxInCup("<joint type='slide' axis='1 0 0' range='-.07 .07'/>"), Exact());
  const Options options;
  Workspace work(scene.tables(), options);
  HullStage stage;
  work.Begin(VectorXd::Constant(1, 0.07));
  EXPECT_FALSE(work.Free(work.problem().q_in));
  EXPECT_TRUE(work.Free(VectorXd::Constant(1, 0.05))) << "of the triangles";
  EXPECT_EQ(stage.Run(work), nullptr);
  EXPECT_GT(stage.queries(), 0);
}

// ---- Which pairs there are ----

TEST_F(ExactMeshStagesContractTest, MeshesOverlapAndRigidBodiesAreTold) {
  for (const bool rigid : {true, false}) {
    for (const bool exact : {true, false}) {
      const Scene scene = Scene::FromString(BoxInCup(rigid ? "<freejoint/>" : kSlide),
                                            exact ? Exact() : SceneOptions());
      const Options options;
      Workspace work(scene.tables(), options);
      VectorXd q = ToEigen(scene.DefaultQpos());
      q[0] = 0.07;
      work.Begin(q);
      const std::vector<NearPair>& overlaps = work.OverlapsAtInput();
      ASSERT_FALSE(overlaps.empty());
      EXPECT_EQ(MeshesOverlap(overlaps), exact);
      EXPECT_EQ(AllRigid(scene.tables(), overlaps), rigid);
      EXPECT_FALSE(MeshesOverlap({}));
      EXPECT_TRUE(AllRigid(scene.tables(), {}));
    }
  }
}

// ---- Frames of a trajectory ----

struct Frames {
  explicit Frames(const std::string& joints, bool trajectory = true)
      : scene(Scene::FromString(BoxInCup(joints), Exact())),
        options(Of(trajectory)),
        work(scene.tables(), options),
        trials(work),
        starts(work, trials) {}

  static Options Of(bool trajectory) {
    Options options;
    options.trajectory = trajectory;
    return options;
  }
  // The frame whose box is at x; its answer is that of a descent from `from`.
  void Frame(double x, double from, const MocapPoses& mocap = {}) {
    VectorXd q = ToEigen(scene.DefaultQpos());
    q[0] = x;
    work.Begin(q, mocap);
    const StrategyInput input{.overlaps = work.OverlapsAtInput()};
    trials.Begin(plan, input, 0.01, true);
    starts.Begin();
    q[0] = from;
    trials.Try(q, Component::kUserPose, ExactMeshStarts::FromHint());
    ASSERT_TRUE(trials.HasFree());
  }
  // The box is 0.01 m in the wall; the way back is the nearest.
  void Searched() {
    Frame(0.07, 0.059);
    starts.FrameSearched(trials.BestSigma());
  }

  Scene scene;
  Options options;
  Workspace work;
  Trials trials;
  ExactMeshStarts starts;
  EffortPlan plan;
};

TEST_F(ExactMeshStagesContractTest, AFrameFollowsWhileItsAnswerIsCloseToTheLeast) {
  Frames frames("<freejoint/>");
  frames.Frame(0.07, 0.059);
  EXPECT_FALSE(frames.starts.Follows(frames.plan)) << "nothing has been searched";
  frames.Searched();
  EXPECT_FALSE(frames.starts.following());
  for (int k = 0; k < tuning::exact_meshes::kFramesFollowed; ++k) {
    frames.Frame(0.0701, 0.059);
    EXPECT_TRUE(frames.starts.Follows(frames.plan)) << k;
    EXPECT_TRUE(frames.starts.following());
  }
  frames.Frame(0.0701, 0.059);
  EXPECT_FALSE(frames.starts.Follows(frames.plan)) << "too many in a row";
  frames.Searched();
  EXPECT_FALSE(frames.starts.following());
  frames.Frame(0.0701, 0.04);
  const double least = 0.01 - 1e-4, far = std::sqrt(frames.trials.BestSigma());
  EXPECT_EQ(frames.starts.Follows(frames.plan), far < tuning::exact_meshes::kFollowed * least);
  frames.Frame(0.078, 0.059);  // has moved by nearly as much as the answer was away
  EXPECT_FALSE(frames.starts.Follows(frames.plan));
}

TEST_F(ExactMeshStagesContractTest, NothingIsFollowedWhereThatProvesNothing) {
  Frames frames("<freejoint/>");
  const auto follows = [&frames](const MocapPoses& mocap = {}) {
    frames.Frame(0.0701, 0.059, mocap);
    return frames.starts.Follows(frames.plan);
  };
  frames.Searched();
  EXPECT_TRUE(follows());
  EXPECT_FALSE(follows({.pos = {4, 0, 0}, .quat = {1, 0, 0, 0}})) << "an obstacle has moved";
  frames.plan.follows = false;
  EXPECT_FALSE(follows()) << "by its effort";
  frames.plan.follows = true;
  EXPECT_TRUE(follows());
  frames.starts.Forget();
  EXPECT_FALSE(follows()) << "forgotten";
  frames.Searched();
  frames.starts.FrameSearched(kInfinity);
  EXPECT_FALSE(follows()) << "the last frame had no answer";
  Frames linked(kSlide), alone("<freejoint/>", false);
  for (Frames* other : {&linked, &alone}) {
    other->Searched();
    other->Frame(0.0701, 0.059);
    EXPECT_FALSE(other->starts.Follows(other->plan));
  }
}

TEST_F(ExactMeshStagesContractTest, AHintIsDescendedFromAsCoarselyAsAStartWithFewLastChances) {
  LocalOptions coarse = Coarse();
  const LocalOptions hint = ExactMeshStarts::FromHint();
  EXPECT_EQ(hint.last_chances, tuning::exact_meshes::kHintChances);
  EXPECT_EQ(hint.max_iterations, coarse.max_iterations);
  EXPECT_EQ(hint.depths, coarse.depths);
}

// The kinds of starts for a box in the wall, in order, each once.
std::vector<std::string> KindsOfStarts(const std::string& joints) {
  Frames frames(joints, false);
  std::vector<std::string> kinds;
  Recorder recorder;
  recorder.Set([&kinds](const Iteration& it) {
    if (it.step == 0 && (kinds.empty() || kinds.back() != it.start)) kinds.push_back(it.start);
  });
  frames.work.recorder = &recorder;
  VectorXd q = ToEigen(frames.scene.DefaultQpos());
  q[0] = 0.07;
  frames.work.Begin(q);
  const StrategyInput input{.overlaps = frames.work.OverlapsAtInput()};
  frames.trials.Begin(frames.plan, input, 0.01, true);
  frames.starts.Begin();
  mjcf_pdg::Random random(1);
  frames.starts.Try(input, q, 0.01, random);
  EXPECT_TRUE(frames.trials.HasFree());
  EXPECT_TRUE(frames.work.Free(frames.trials.Best()));
  EXPECT_LT(std::sqrt(frames.trials.BestSigma()), 0.02) << joints;
  return kinds;
}

TEST_F(ExactMeshStagesContractTest, LinksArePartedFirstAndADescentFromTheInputComesLastIfAtAll) {
  const std::vector<std::string> rigid = KindsOfStarts("<freejoint/>");
  EXPECT_EQ(rigid, std::vector<std::string>{"constrained_translation"}) << "which found it near";
  const std::vector<std::string> linked = KindsOfStarts(kSlide);
  const std::vector<std::string> in_order = {"pair_by_pair", "constrained_translation", "direct"};
  EXPECT_EQ(linked, in_order);
}

}  // namespace
}  // namespace mjcf_pdg::test
