// Scenes that are hard because of their topology: shells, rings in rings, threads.
#include <cmath>

#include "mjcf_pdg/pdg.h"
#include "tests/support/cli_test.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/oracle_check.h"
#include "tests/support/test_support.h"
#include "tests/support/trials.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

class ExactMeshScenesTest : public MujocoTest {};
using ExactMeshScenesCliTest = CliTest;

// ---- Closed shells ----

constexpr double kHollow = 0.08, kShell = 0.1;  // radii

MeshShape Ball(double radius) {
  return Globe(16, 24, [radius](const Vector3d&) { return radius; });
}

// A ball of meshes in a closed shell; `joints` are the ball's.
std::string ShellXml(double ball, const std::string& joints, const std::string& keys = {}) {
  MeshShape shell = Ball(kShell), hollow = Ball(kHollow);
  shell.Append(hollow.TurnInsideOut());
  return "<mujoco><compiler autolimits='true'/><asset>" + MeshXml("shell", shell) +
         MeshXml("ball", Ball(ball)) + "</asset><worldbody><geom name='shell' type='mesh' " +
         "mesh='shell'/><body>" + joints + "<geom name='ball' type='mesh' mesh='ball'/></body>" +
         "</worldbody><keyframe>" + keys + "</keyframe></mujoco>";
}

const char kFree[] = "<freejoint/>";
const char kSlides[] =
    "<joint type='slide' axis='1 0 0' range='-.06 .06'/>"
    "<joint type='slide' axis='0 1 0' range='-.06 .06'/>";

TEST_F(ExactMeshScenesTest, ABallGoesBackIntoTheHollowOfAShell) {
  const Scene scene = Scene::FromString(ShellXml(0.03, kFree), Exact());
  const Result result = Solver(scene).Solve(FreePose({0.06, 0.01, 0.0}));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_TRUE(FreeByBoth(scene, result.q));
  EXPECT_LT(std::sqrt(result.sigma), 0.0125);
  EXPECT_LT(Eigen::Map<const Vector3d>(result.q.data()).norm(), kHollow);
}

TEST_F(ExactMeshScenesTest, ABallTooLargeForTheHollowGoesOut) {
  const double radius = 0.085;
  const Scene scene = Scene::FromString(ShellXml(radius, kFree), Exact());
  const Result result = Solver(scene).Solve(FreePose({0.02, 0.01, 0.0}));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_TRUE(FreeByBoth(scene, result.q));
  EXPECT_GT(Eigen::Map<const Vector3d>(result.q.data()).norm(), 0.95 * (kShell + radius));
  EXPECT_LT(std::sqrt(result.sigma), 1.1 * (kShell + radius));
}

TEST_F(ExactMeshScenesTest, SlidesWithRoomInsideAreUsedAndWithoutItIsUnsolved) {
  const Scene roomy = Scene::FromString(ShellXml(0.05, kSlides), Exact());
  const Result solved = Solver(roomy).Solve({0.04, 0.005});
  ASSERT_EQ(solved.status, Status::kSolved) << solved.reason;
  EXPECT_TRUE(FreeByBoth(roomy, solved.q));
  EXPECT_LT(std::sqrt(solved.sigma), 0.0125);
  for (const double too_large : {0.082, 0.095}) {
    const Scene tight = Scene::FromString(ShellXml(too_large, kSlides), Exact());
    const Result result = Solver(tight).Solve({0.04, 0.005});
    EXPECT_EQ(result.status, Status::kUnsolved);
    EXPECT_NE(result.reason, "");
    EXPECT_FALSE(FreeByBoth(tight, result.q));
    EXPECT_LE(result.min_distance, 0.0);
    EXPECT_GE(result.min_distance, result.depth_in);
  }
}

TEST_F(ExactMeshScenesCliTest, WhatCannotBeSolvedHasItsExitCode) {
  Write("tight.xml", ShellXml(0.085, kSlides, "<key name='in' qpos='.04 .005'/>"));
  Write("roomy.xml", ShellXml(0.05, kSlides, "<key name='in' qpos='.04 .005'/>"));
  const Outcome tight = Run({"solve", "tight.xml", "--exact-mesh", "--json", "-"});
  EXPECT_EQ(tight.exit_code, 3) << tight.err;
  const auto rows = ParseLines(tight.out);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0]["status"], "unsolved");
  EXPECT_NE(rows[0]["reason"].get<std::string>().find("'ball'"), std::string::npos) << rows[0];
  EXPECT_EQ(Run({"solve", "roomy.xml", "--exact-mesh"}).exit_code, 0);
}

// ---- Rings in rings ----

// How often a ring about the z axis of the body's frame goes through another one: crossings of its
// middle circle with the other one's disc.
int LinkingNumber(double radius, const Quaterniond& turn, const Vector3d& at, double other) {
  int crossings = 0;
  const int sectors = 1000;
  Vector3d before;
  for (int k = 0; k <= sectors; ++k) {
    const double a = 2.0 * M_PI * k / sectors;
    const Vector3d p = at + turn * Vector3d(radius * std::cos(a), radius * std::sin(a), 0.0);
    if (k > 0 && (before.z() > 0.0) != (p.z() > 0.0)) {
      const Vector3d x = before + before.z() / (before.z() - p.z()) * (p - before);
      if (x.norm() < other) crossings += p.z() > 0.0 ? 1 : -1;
    }
    before = p;
  }
  return crossings;
}

TEST_F(ExactMeshScenesTest, OverlappingRingsStayLinked) {
  const double radius = 0.1, tube = 0.02;
  const MeshShape ring = Torus(radius, tube, 48, 16);
  const Scene scene = MeshScene(ring, "type='mesh' mesh='moving'", ring);
  Random rng(53);
  int solved = 0;
  for (int i = 0; i < 12; ++i) {
    const Quaterniond turn = Quaterniond(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX())) *
                             Quaterniond(Eigen::AngleAxisd(0.3, rng.UnitVector()));
    const Vector3d at(rng.Uniform(0.165, 0.18) * (i % 2 ? 1.0 : -1.0), 0.0, rng.Uniform(-.02, .02));
    const std::vector<double> q = FreePose(at, turn);
    const int linked = LinkingNumber(radius, turn, at, radius);
    ASSERT_EQ(std::abs(linked), 1) << "not what the test is about";
    const Result result = Solver(scene).Solve(q);
    if (result.status == Status::kAlreadyFree) continue;
    ASSERT_EQ(result.status, Status::kSolved) << i << ": " << result.reason;
    EXPECT_TRUE(FreeByBoth(scene, result.q)) << i;
    const Quaterniond turned(result.q[3], result.q[4], result.q[5], result.q[6]);
    EXPECT_EQ(LinkingNumber(radius, turned, Eigen::Map<const Vector3d>(result.q.data()), radius),
              linked)
        << i << ", rms " << std::sqrt(result.sigma);
    ++solved;
  }
  EXPECT_GE(solved, 8);
}

// ---- The generated models ----

struct Known {
  const char* key;
  // A pose whose freedom follows from the shapes' measures: the answer is no farther.
  Vector3d position;
  Quaterniond turn = Quaterniond::Identity();
};

Quaterniond Turn(double degrees, const Vector3d& axis) {
  return Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180.0, axis));
}

// All keyframes that penetrate are solved, no farther than the known pose and than by the paper's
// steps.
void ExpectNearAsKnown(const std::string& name, const std::vector<Known>& keys) {
  const Scene scene = Scene::FromFile(MJCF_PDG_MODEL_DIR "/rigid/" + name + ".xml", Exact());
  Options paper;
  paper.method = Method::kPaper;
  for (const Known& known : keys) {
    SCOPED_TRACE(name + " " + known.key);
    const std::vector<double> q = scene.KeyQpos(mj_name2id(scene.model(), mjOBJ_KEY, known.key));
    const std::vector<double> there = FreePose(known.position, known.turn);
    ASSERT_TRUE(FreeByBoth(scene, there));
    const Result ours = Solver(scene).Solve(q), theirs = Solver(scene, paper).Solve(q);
    ASSERT_EQ(ours.status, Status::kSolved) << ours.reason;
    EXPECT_TRUE(FreeByBoth(scene, ours.q));
    EXPECT_LE(ours.sigma, ObjectNorm(scene, Metric::kSequential, q).Sigma(there));
    if (theirs.status == Status::kSolved) {
      EXPECT_TRUE(FreeByBoth(scene, theirs.q));
      EXPECT_LE(ours.sigma, 1.05 * theirs.sigma);
    }
  }
}

constexpr double kHair = 2e-5;  // off what touches [m]

// A torus of radii 50 and 10 mm around a post of 20 mm. Straight, its middle may lie 20 mm beside
// the post's. Turned by α about y, the middle of its tube passes 50 cos α before and after its own:
// that may lie 50 cos α - 30 mm beside; α = 45° is near the best between 60° and 0.
TEST_F(ExactMeshScenesTest, ARingOnAPost) {
  const double tilted = 0.05 * std::cos(M_PI / 4) - 0.03;
  ExpectNearAsKnown("ring_on_post",
                    {{"off_centre", {0.02 - kHair, 0, 0.06}},
                     {"tilted", {tilted - kHair, 0, 0.06}, Turn(45, Vector3d::UnitY())}});
}

// A ball of 30 mm. The bottom lies at 8 mm. The wall within leans outward, from 29.75 mm at that
// height to 39.65 mm at 60 mm; the cup has 20 sides, which come as near as cos 9° of that. Off the
// two sides next to x the shortest way is across them, up and in.
TEST_F(ExactMeshScenesTest, ABallInACup) {
  const double nine = M_PI / 20, lean = std::atan2((0.03965 - 0.02975) * std::cos(nine), 0.052);
  const double distance = (0.03965 * std::cos(nine) - 0.02 * std::cos(nine)) * std::cos(lean);
  // Both sides turn away from x by 9°, which the way along x sees.
  const double way =
      (0.03 - distance) / std::hypot(std::cos(nine) * std::cos(lean), std::sin(lean));
  const double up = std::atan2(std::sin(lean), std::cos(nine) * std::cos(lean));
  ExpectNearAsKnown(
      "ball_in_cup",
      {{"through_wall",
        {0.02 - (way + kHair) * std::cos(up), 0, 0.06 + (way + kHair) * std::sin(up)}},
       {"through_bottom", {0, 0, 0.038 + kHair}}});
}

// Two tori of radii 50 and 10 mm, one upright with its middle at x = 50 mm: their tubes pass each
// other at 20 mm.
TEST_F(ExactMeshScenesTest, LinksOfAChain) {
  ExpectNearAsKnown("linked_rings",
                    {{"pulled_apart", {-0.03 + kHair, 0, 0}},
                     {"pushed_together", {0.03 - kHair, 0, 0}, Turn(10, Vector3d::UnitX())}});
}

// A thread 3 mm deep on half a pitch of 4 mm: the play of 0.6 mm across is 0.8 mm along. A quarter
// of a turn is 2 mm of pitch; lifted is 3 mm. Coarse steps outward lift the nut off.
TEST_F(ExactMeshScenesTest, ANutOnABolt) {
  ExpectNearAsKnown(
      "nut_on_bolt",
      {{"quarter_turn", {0, 0, 0.016 + 0.002 - 0.0008 + kHair}, Turn(90, Vector3d::UnitZ())},
       {"lifted", {0, 0, 0.016 + 0.0008 - kHair}}});
}

// Shifted across and tilted it has no straight way out but off the bolt, ten times as far. (Of
// 120 such nuts five go there.)
TEST_F(ExactMeshScenesTest, ATiltedNutStaysOnItsBolt) {
  const Scene scene = Scene::FromFile(MJCF_PDG_MODEL_DIR "/rigid/nut_on_bolt.xml", Exact());
  const std::vector<double> home = scene.KeyQpos(mj_name2id(scene.model(), mjOBJ_KEY, "home"));
  Random rng(54);
  int stays = 0;
  for (int i = 0; i < Trials(10); ++i) {
    std::vector<double> q = home;
    const Vector3d shift = 1e-3 * rng.Normals(3);
    for (int k = 0; k < 3; ++k) q[k] += shift[k];
    const Quaterniond turn(Eigen::AngleAxisd(0.1, rng.UnitVector()));
    q[3] = turn.w();
    Eigen::Map<Vector3d>(q.data() + 4) = turn.vec();
    const Result result = Solver(scene).Solve(q);
    ASSERT_EQ(result.status, Status::kSolved) << i << ": " << result.reason;
    EXPECT_TRUE(FreeByBoth(scene, result.q)) << i;
    stays += result.sigma < ObjectNorm(scene, Metric::kSequential, q).Sigma(home);
  }
  EXPECT_GE(stays, Trials(8));
}

// ---- A splined shaft in its bore ----

// Below radius 0.02 the solid of revolution is wavy: five teeth about z.
MeshShape Splined(const std::vector<Eigen::Vector2d>& profile) {
  MeshShape shape = Revolution(profile, 50);
  for (Vector3d& p : shape.vertices) {
    if (p.head<2>().norm() > 0.02) continue;
    p.head<2>() *= 1.0 + 0.3 * std::cos(5.0 * std::atan2(p.y(), p.x()));
  }
  return shape;
}

// Half a millimetre of play; straight ways lead out along the axis alone, many times as far.
TEST_F(ExactMeshScenesTest, AShaftStaysInItsBore) {
  const MeshShape shaft = Splined({{0.004, -0.01}, {0.01, -0.01}, {0.01, 0.01}, {0.004, 0.01}});
  const MeshShape bore =
      Splined({{0.0105, -0.005}, {0.03, -0.005}, {0.03, 0.005}, {0.0105, 0.005}});
  const Scene scene = Scene::FromString(
      "<mujoco><asset>" + MeshXml("shaft", shaft) + MeshXml("bore", bore, "inertia='exact'") +
          "</asset><worldbody><geom type='mesh' mesh='bore'/><body><freejoint/>"
          "<geom type='mesh' mesh='shaft'/></body></worldbody></mujoco>",
      Exact());
  const std::vector<double> home = FreePose(Vector3d::Zero());
  ASSERT_TRUE(FreeByBoth(scene, home));
  Random rng(5);
  int overlapping = 0;
  for (int i = 0; i < Trials(12); ++i) {
    const Vector3d shift = 8e-4 * rng.Normals(3);
    const std::vector<double> q =
        FreePose(shift, Quaterniond(Eigen::AngleAxisd(0.08, rng.UnitVector())));
    Options options;
    options.seed = i;
    const Result result = Solver(scene, options).Solve(q);
    if (result.status == Status::kAlreadyFree) continue;
    ++overlapping;
    ASSERT_EQ(result.status, Status::kSolved) << i << ": " << result.reason;
    EXPECT_TRUE(FreeByBoth(scene, result.q)) << i;
    EXPECT_LE(result.sigma, ObjectNorm(scene, Metric::kSequential, q).Sigma(home)) << i;
  }
  EXPECT_GE(overlapping, Trials(10));
}

// The hint overlaps by 6e-8 m, which the verifier accepts.
TEST_F(ExactMeshScenesTest, NoAnswerIsWorseThanAFreeHint) {
  const Scene scene = Scene::FromFile(MJCF_PDG_MODEL_DIR "/rigid/nut_on_bolt.xml", Exact());
  const std::vector<double> q = scene.KeyQpos(mj_name2id(scene.model(), mjOBJ_KEY, "lifted"));
  Options paper;
  paper.method = Method::kPaper;
  paper.seed = 3;
  const Result hint = Solver(scene, paper).Solve(q);
  ASSERT_TRUE(FreeByBoth(scene, hint.q));
  EXPECT_LE(Solver(scene).Solve(q, hint.q).sigma, 1.001 * hint.sigma);
}

}  // namespace
}  // namespace mjcf_pdg::test
