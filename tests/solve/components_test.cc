#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mjcf_pdg/pdg.h"
#include "solve/options.h"
#include "tests/support/paper_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ComponentsTest : public MujocoTest {};

// All of `all` but `kept`.
std::vector<std::string> AllBut(std::vector<std::string> all, const std::string& kept) {
  all.erase(std::find(all.begin(), all.end(), kept));
  return all;
}

const std::vector<std::string> kStarts = {
    "direct", "mirror",       "noise",    "hop",       "constrained_translation",
    "hulls",  "pair_by_pair", "anywhere", "user_pose", "motion_coherence"};

// A free sphere sunk into a box, by more than half of the box.
const std::string kSphereInBox = InWorld(
    "<geom type='box' size='.2 .3 .4'/><body pos='.01 0 0'><freejoint/><geom size='.1'/></body>");
const std::vector<double> kInside = {0.01, 0, 0, 1, 0, 0, 0}, kOutside = {0.5, 0, 0, 1, 0, 0, 0};

TEST_F(ComponentsTest, UnknownNamesAreAnsweredWithTheKnownOnesOfTheMethod) {
  const Scene scene = Scene::FromString(kSphereInBox);
  Options options;
  options.without = {"noise", "nois"};
  EXPECT_THAT(ErrorOf([&] { Solver(scene, options); }),
              AllOf(HasSubstr("'nois'"), HasSubstr("direct, mirror"), HasSubstr("damping")));
  options.method = Method::kPaper;
  options.without = {"noise"};
  EXPECT_THAT(ErrorOf([&] { Solver(scene, options); }),
              AllOf(HasSubstr("'noise'"), HasSubstr("successive_perturbation, constrained"),
                    HasSubstr("corrections, reverse_projection")));
}

TEST_F(ComponentsTest, EveryNameIsTakenAndNoneTwice) {
  const Scene scene = Scene::FromString(kSphereInBox);
  for (const Method method : {Method::kAuto, Method::kPaper}) {
    Options options;
    options.method = method;
    options.without = Components(method);
    EXPECT_GE(options.without.size(), 8u);
    Solver solver(scene, options);
    EXPECT_EQ(solver.Solve(kInside).status, Status::kUnsolved) << "no start is left";
    std::sort(options.without.begin(), options.without.end());
    EXPECT_EQ(std::unique(options.without.begin(), options.without.end()), options.without.end());
  }
}

TEST_F(ComponentsTest, NoStartOfMethodAutoIsMissingHere) {
  std::vector<std::string> starts = Components(Method::kAuto);
  for (const char* step : {"polish", "early_exit", "witness_memory", "damping", "boxes"}) {
    starts = AllBut(starts, step);
  }
  EXPECT_THAT(starts, ::testing::UnorderedElementsAreArray(kStarts));
}

TEST_F(ComponentsTest, AStartLeftAloneSolvesByItself) {
  const Scene scene = Scene::FromString(kSphereInBox);
  for (const std::string start :
       {"direct", "noise", "constrained_translation", "anywhere", "user_pose"}) {
    Options options;
    options.without = AllBut(kStarts, start);
    const Result result = Solver(scene, options).Solve(kInside, kOutside);
    EXPECT_EQ(result.status, Status::kSolved) << start << ": " << result.reason;
    EXPECT_EQ(result.start, start);
  }
}

TEST_F(ComponentsTest, MotionCoherenceLeftAloneStartsFromTheLastAnswer) {
  const Scene scene = Scene::FromString(kSphereInBox);
  Options options;
  options.without = AllBut(kStarts, "motion_coherence");
  options.trajectory = true;
  Solver solver(scene, options);
  EXPECT_EQ(solver.Solve(kInside).status, Status::kUnsolved) << "nothing to start from yet";
  EXPECT_EQ(solver.Solve(kOutside).status, Status::kAlreadyFree);
  const Result result = solver.Solve(kInside);
  EXPECT_EQ(result.status, Status::kSolved);
  EXPECT_EQ(result.start, "motion_coherence");

  options.without = kStarts;
  Solver none(scene, options);
  EXPECT_EQ(none.Solve(kOutside).status, Status::kAlreadyFree);
  EXPECT_EQ(none.Solve(kInside, kOutside).status, Status::kUnsolved);
}

TEST_F(ComponentsTest, MirrorAndHopsFollowTheDirectStartAndComeOnlyWhenUsed) {
  const Scene scene = Scene::FromString(kSphereInBox);
  auto starts = [&scene](const std::string& kept) {
    Options options;
    options.without = AllBut(AllBut(kStarts, "direct"), kept);
    return Solver(scene, options).Solve(kInside).stats.starts;
  };
  EXPECT_EQ(starts("user_pose"), 1) << "direct alone";
  EXPECT_EQ(starts("mirror"), 2);
  EXPECT_GT(starts("hop"), 10) << "hops agree with nothing: the budget ends them";
}

// The paper's selections, without its other steps.
std::vector<std::string> PaperSelections() {
  return AllBut(AllBut(Components(Method::kPaper), "corrections"), "reverse_projection");
}

// A selection of the paper's, a scene and a configuration that it solves.
struct Selected {
  const char* name;
  std::string xml;
  std::optional<std::vector<double>> hint;
};

TEST_F(ComponentsTest, ASelectionOfThePaperLeftAloneSolvesByItself) {
  const std::string hinges = TwoLinksXml(1.5);
  const Selected all[] = {{"centroid_difference", kSphereInBox, {}},
                          {"successive_perturbation", hinges, {}},
                          {"user_pose", hinges, std::vector<double>{1.5, 0.0}},
                          {"maximally_clear", hinges, {}}};
  for (const Selected& selected : all) {
    const Scene scene = Scene::FromString(selected.xml);
    Options options;
    options.method = Method::kPaper;
    options.without = AllBut(PaperSelections(), selected.name);
    const Result result = Solver(scene, options).Solve(scene.DefaultQpos(), selected.hint);
    EXPECT_EQ(result.status, Status::kSolved) << selected.name;
    EXPECT_EQ(result.start, selected.name);
    EXPECT_EQ(result.stats.starts, 1);
  }
}

// The penetrating ones of a few random configurations; all of them can be solved.
std::vector<Result> SolveSome(Method method, const std::vector<std::string>& without) {
  std::vector<Result> results;
  Random rng(21);
  for (int model = 0; model < 6; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, robot));
    Options options;
    options.method = method;
    options.without = without;
    Solver solver(scene, options);
    for (int k = 0; k < 6; ++k) {
      Result result = solver.Solve(ToVector(RandomConfiguration(scene, rng)));
      if (result.status == Status::kAlreadyFree) continue;
      EXPECT_EQ(result.status, Status::kSolved) << result.reason;
      results.push_back(std::move(result));
    }
  }
  EXPECT_GT(results.size(), 20u);
  return results;
}

double Queries(const std::vector<Result>& results) {
  double sum = 0.0;
  for (const Result& result : results) sum += result.stats.collision_queries;
  return sum;
}

TEST_F(ComponentsTest, StepsThatAreToSaveQueriesDo) {
  const double all = Queries(SolveSome(Method::kAuto, {}));
  for (const std::string step : {"early_exit", "witness_memory", "damping"}) {
    EXPECT_GT(Queries(SolveSome(Method::kAuto, {step})), 1.03 * all) << step;
  }
}

TEST_F(ComponentsTest, PolishLowersSigma) {
  const std::vector<Result> with = SolveSome(Method::kAuto, {});
  const std::vector<Result> without = SolveSome(Method::kAuto, {"polish"});
  ASSERT_EQ(with.size(), without.size());
  int lower = 0, higher = 0;
  for (std::size_t k = 0; k < with.size(); ++k) {
    lower += with[k].sigma < without[k].sigma;
    higher += with[k].sigma > without[k].sigma;
  }
  EXPECT_GE(lower, 10);
  EXPECT_LE(higher, 2) << "another candidate was nearer after all";
}

TEST_F(ComponentsTest, StepsOfThePaperLowerSigma) {
  const std::vector<Result> with = SolveSome(Method::kPaper, {});
  for (const std::string step : {"corrections", "reverse_projection"}) {
    const std::vector<Result> without = SolveSome(Method::kPaper, {step});
    ASSERT_EQ(with.size(), without.size());
    double logs = 0.0;  // of σ without over σ with
    for (std::size_t k = 0; k < with.size(); ++k)
      logs += std::log(without[k].sigma / with[k].sigma);
    EXPECT_GT(logs / static_cast<double>(with.size()), 0.05) << step;
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
