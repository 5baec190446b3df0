#include "paper/free_configuration.h"

#include "tests/support/paper_support.h"

namespace mjcf_pdg::test {
namespace {

class FreeConfigurationTest : public MujocoTest {};

Options Paper() {
  Options options;
  options.method = Method::kPaper;
  return options;
}

struct Selector : PosedProblem {
  explicit Selector(const std::string& xml)
      : PosedProblem(xml, Paper()), selection(work, coherence) {
    selection.Begin(nullptr, 0);
  }

  // A free configuration by one selection alone.
  std::optional<VectorXd> Select(Component one) {
    Options alone = options;
    for (const Component other : ComponentsOf(Method::kPaper)) {
      if (other != one) alone.without.push_back(NameOf(other));
    }
    Workspace own(scene.tables(), alone);
    own.Begin(work.problem().q_in);
    FreeConfigurationSelection selects(own, coherence);
    selects.Begin(hint.size() > 0 ? &hint : nullptr, 0);
    std::optional<FreeConfiguration> found = selects.SelectInPaperOrder();
    if (!found) return std::nullopt;
    EXPECT_EQ(found->start, one);
    return found->q;
  }

  // Names of the selections that find a configuration, each checked to be free.
  std::vector<std::string> Solving() {
    std::vector<std::string> names;
    for (const Component component : ComponentsOf(Method::kPaper)) {
      const std::optional<VectorXd> q = Select(component);
      if (!q) continue;
      EXPECT_TRUE(Free(*q)) << NameOf(component) << " " << Join(*q);
      EXPECT_LE(LimitExcess(scene.tables(), *q), 0.0) << NameOf(component);
      names.push_back(NameOf(component));
    }
    return names;
  }

  VectorXd hint;  // empty: none
  MotionCoherence coherence;
  FreeConfigurationSelection selection;
};

std::string Box(double x, double y, double half_x, double half_y) {
  const double pos[] = {x, y, 0.0}, size[] = {half_x, half_y, 1.0};
  return "<geom type='box' size='" + Join(size, 3) + "' pos='" + Join(pos, 3) + "'/>";
}

// Everything is solid but a pocket of half-width h about (x, y).
std::string PocketXml(double start_x, double start_y) {
  const double x = 0.83, y = 0.71, h = 0.125, pos[] = {start_x, start_y, 0.0};
  return InWorld(Box(x - h - 2, 0, 2, 4) + Box(x + h + 2, 0, 2, 4) + Box(0, y - h - 2, 4, 2) +
                 Box(0, y + h + 2, 4, 2) + "<body pos='" + Join(pos, 3) + "'>" +
                 "<joint type='slide' axis='1 0 0' range='-1 1'/>"
                 "<joint type='slide' axis='0 1 0' range='-1 1'/><geom size='.1'/></body>");
}

// Two long bars along x and y, between a floor and a ceiling.
const char kCross[] =
    "<geom type='box' size='60 .02 .015'/><geom type='box' size='.02 60 .015'/>"
    "<geom type='plane' size='0 0 1' pos='0 0 -.011'/>"
    "<geom type='plane' size='0 0 1' pos='0 0 .011' zaxis='0 0 -1'/>";
const char kExtent[] = "<statistic extent='1'/>";

TEST_F(FreeConfigurationTest, MotionCoherenceAloneKnowsAHiddenPocket) {
  Selector s(PocketXml(0, 0));
  s.SetInput(Eigen::Vector2d(0.4, 0.3));
  EXPECT_EQ(s.Solving(), std::vector<std::string>{});
  s.coherence.AddFree(Eigen::Vector2d(0.83, 0.71));
  EXPECT_EQ(s.Solving(), std::vector<std::string>{"motion_coherence"});
}

TEST_F(FreeConfigurationTest, CentroidDifferenceAloneMovesARigidPlateAlongTheDiagonal) {
  Selector s(InWorld(std::string(kCross) + "<body pos='.05 .05 0'><freejoint/>"
                                           "<geom type='box' size='.3 .3 .01'/></body>",
                     kExtent));
  std::vector<std::string> solving = s.Solving();
  std::erase(solving, "maximally_clear");  // random: may draw a quadrant of the cross
  EXPECT_EQ(solving, std::vector<std::string>{"centroid_difference"});
  const std::optional<FreeConfiguration> q = s.selection.SelectInPaperOrder();
  ASSERT_TRUE(q);
  EXPECT_EQ(q->start, Component::kCentroidDifference);
}

TEST_F(FreeConfigurationTest, SuccessivePerturbationAloneTurnsTheTipOutsideANarrowChannel) {
  std::string chain =
      "<body pos='.2 0 0'><joint axis='0 1 0'/>"
      "<geom type='capsule' size='.01' fromto='.05 0 0 .2 0 0'/></body>";
  for (int i = 0; i < 11; ++i) {
    chain =
        "<body pos='.2 0 0'><joint axis='0 0 1'/>"
        "<geom type='capsule' size='.01' fromto='.02 0 0 .18 0 0'/>" +
        chain + "</body>";
  }
  Selector s(
      InWorld("<geom type='plane' size='5 5 1' pos='0 .011 0' zaxis='0 -1 0'/>"
              "<geom type='plane' size='5 5 1' pos='0 -.011 0' zaxis='0 1 0'/>"
              "<geom size='.05' pos='2.55 0 0'/>" +
              chain));
  EXPECT_EQ(s.Solving(), std::vector<std::string>{"successive_perturbation"});
}

TEST_F(FreeConfigurationTest, ConstrainedTranslationAloneCarriesABranchingBodyAway) {
  const std::string finger =
      "<joint axis='0 1 0' range='-3 3'/>"
      "<geom type='box' size='.3 .02 .01' pos='.4 0 0'/>";
  Selector s(InWorld(std::string(kCross) +
                         "<body pos='.05 .05 0'><joint type='slide' axis='1 0 0'/>"
                         "<joint type='slide' axis='0 1 0'/><geom type='box' size='.2 .2 .01'/>"
                         "<body pos='.15 .1 0'>" +
                         finger +
                         "</body>"
                         "<body pos='.15 .2 0'>" +
                         finger + "</body></body>",
                     kExtent));
  EXPECT_EQ(s.Solving(), std::vector<std::string>{"constrained_translation"});
}

TEST_F(FreeConfigurationTest, TheUsersPoseAloneKnowsAHiddenPocketThatNothingElseSaw) {
  Selector s(PocketXml(0.83, 0.71));
  s.SetInput(Eigen::Vector2d(-0.4, -0.4));
  EXPECT_EQ(s.Solving(), std::vector<std::string>{"user_pose"});
  Selector hinted(PocketXml(0, 0));
  hinted.SetInput(Eigen::Vector2d(0.4, 0.3));
  hinted.hint = Eigen::Vector2d(0.83, 0.71);
  EXPECT_EQ(hinted.Solving(), std::vector<std::string>{"user_pose"});
}

TEST_F(FreeConfigurationTest, MaximallyClearAloneFindsTheMiddleOfAQuadrant) {
  std::string posts;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) posts += Box(x, y, 0.06, 0.06);
  }
  Selector s(InWorld(Box(0, 0, 4, 0.1) + Box(0, 0, 0.1, 4) + posts +
                     "<body><joint type='slide' axis='1 0 0' range='-.5 .5'/>"
                     "<joint type='slide' axis='0 1 0' range='-.5 .5'/><geom size='.02'/></body>"));
  EXPECT_EQ(s.Solving(), std::vector<std::string>{"maximally_clear"});
}

// A hand-like body that collides with itself and with what it floats over.
TEST_F(FreeConfigurationTest, TranslationOfASelfCollidingBodyTakesASelfCollisionFreePose) {
  const std::string finger =
      "<joint axis='0 0 1'/><geom type='box' size='.2 .02 .05' pos='.22 0 0'/>";
  Selector s(
      InWorld("<geom type='plane' size='5 5 1'/><body pos='0 0 0'><freejoint/>"
              "<geom type='box' size='.1 .2 .05'/><body pos='.1 .12 0'>" +
              finger + "</body><body pos='.1 -.12 0'>" + finger + "</body></body>"));
  VectorXd q_in = ToEigen(s.scene.DefaultQpos());
  q_in[7] = -0.6;
  q_in[8] = 0.6;
  s.SetInput(q_in);
  ASSERT_FALSE(s.Free(q_in));
  const std::optional<VectorXd> by_user = s.Select(Component::kConstrainedTranslation);
  ASSERT_TRUE(by_user);  // qpos0's fingers
  EXPECT_EQ((*by_user)[7], 0.0);
  VectorXd seen = q_in;  // under the ground, but free of self-collision
  seen[7] = 0.5;
  ASSERT_TRUE(s.selection.SelfCollisionFree(seen));
  s.coherence.AddSelfCollisionFree(seen);
  const std::optional<VectorXd> by_memory = s.Select(Component::kConstrainedTranslation);
  ASSERT_TRUE(by_memory);
  EXPECT_EQ((*by_memory)[7], 0.5);
}

TEST_F(FreeConfigurationTest, CoherenceComesFirstAndTheNearestRememberedFirst) {
  Selector s(
      InWorld("<geom size='.1'/><body><joint type='slide' axis='1 0 0'/><geom size='.1'/>"
              "</body>"));
  for (const double x : {2.0, -0.5, 0.8, 0.05}) s.coherence.AddFree(VectorXd::Constant(1, x));
  s.SetInput(VectorXd::Constant(1, 0.02));
  const std::optional<FreeConfiguration> q = s.selection.SelectInPaperOrder();
  ASSERT_TRUE(q);
  EXPECT_EQ(q->start, Component::kMotionCoherence);
  EXPECT_EQ(q->q[0], -0.5);
}

TEST_F(FreeConfigurationTest, TheCacheKeepsTheLatest) {
  PosedProblem p(InWorld("<body><joint type='slide' axis='1 0 0'/><geom size='.1'/></body>"));
  ConfigurationCache cache(3);
  for (int i = 1; i <= 5; ++i) cache.Add(VectorXd::Constant(1, i));
  const std::vector<VectorXd> entries = cache.NearestFirst(p.work, 10);
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[0][0], 3.0);
  EXPECT_EQ(entries[2][0], 5.0);
}

}  // namespace
}  // namespace mjcf_pdg::test
