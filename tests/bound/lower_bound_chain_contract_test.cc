// What lower_bound_chain.h promises of movers and paths, against motions of the model.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bound/lower_bound_chain.h"
#include "tests/bound/bound_check.h"
#include "tests/bound/parting.h"
#include "tests/support/scaled_model.h"

namespace mjcf_pdg::test {
namespace {

class LowerBoundChainContractTest : public MujocoTest {};

// ---- Made-up movers ----

// Where the limb's motion z takes the point x.
Vector3d Moved(const Limb& limb, const VectorXd& z, const Vector3d& x) {
  const Vector3d w = limb.turns * z, r = x - limb.mover.anchor;
  const double c = std::sqrt(std::max(0.0, 1.0 - 0.25 * w.squaredNorm()));
  return x + limb.slides * z + c * w.cross(r) + 0.5 * w.cross(w.cross(r));
}

TEST_F(LowerBoundChainContractTest, NoMotionTakesAPointFartherThanItsReachAndSomeAsFar) {
  Random rng(1);
  for (int trial = 0; trial < 400; ++trial) {
    const Moves moves = static_cast<Moves>(trial % 4);
    const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
    const Limb limb = RandomLimb(moves, scale, rng);
    const double radius = trial % 8 < 4 ? 0.0 : scale * rng.Uniform(0.0, 0.5);
    const Vector3d x = scale * rng.InBox(1.0);
    const double reach = std::sqrt(ReachSquared(limb.mover, x, radius));
    double farthest = 0.0;
    for (int k = 0; k < 2000; ++k) {
      const VectorXd d = rng.Normals(limb.size()).normalized();
      // Half of the turns are small: the chord of a large one is no more per √S.
      const double turn = (limb.turns * d).norm();
      const double length = (k % 2 ? 1.0 : 1e-3) * (turn > 0.0 ? 2.0 / turn : scale);
      const Vector3d at = x + radius * rng.UnitVector();
      farthest = std::max(farthest, (Moved(limb, length * d, at) - at).norm() / length);
    }
    EXPECT_LE(farthest, reach * (1.0 + 1e-7)) << trial;
    if (moves != Moves::kFree) {
      EXPECT_GE(farthest, (radius > 0.0 ? 0.5 : 0.95) * reach) << trial;
    }
    const Vector3d r = x - limb.mover.anchor;
    const Matrix3d compliance = TurnCompliance(limb.mover, x);
    const Matrix3d expected = Skew(r) * limb.mover.C * Skew(r).transpose();
    EXPECT_LT((compliance - expected).norm(), 1e-9 * (reach * reach)) << trial;
  }
}

// ---- Movers of a model ----

// A scene of a scaled model at a random q_in, and its movers.
struct AtInput {
  AtInput(const std::string& xml, const SceneOptions& options, Metric m, double log_scale,
          Random& rng)
      : scale(std::pow(10.0, log_scale)),
        metric(m),
        model(Scaled(*Scene::FromString(xml, options).model(), scale)),
        scene(Scene::FromModel(model.get(), options)),
        norm(scene.tables(), metric),
        before(&scene.tables().query_model),
        after(&scene.tables().query_model),
        q_in(Normalized(scene.tables(), RandomConfiguration(scene, rng, 0.5 * scale))),
        required(VectorXd::Zero(static_cast<Eigen::Index>(scene.tables().pairs.size()))) {
    norm.SetReference(q_in);
    before.Pose(q_in);
    chains.Fill(input);
  }
  AtInput(const AtInput&) = delete;

  const mjModel& m() const { return *scene.model(); }
  std::vector<int> Path(int body) {
    std::vector<int> path = {-7};
    chains.Path(body, path);
    return path;
  }
  MoverPool Along(const std::vector<int>& path) const {
    MoverPool pool;
    for (const int i : path) chains.AppendAlong({&i, 1}, pool);
    return pool;
  }
  // The displacement metric's movers are rigid pieces: up to the next body with a movable joint.
  int PieceOf(int body) const {
    const std::vector<JointEntry>& joints = scene.tables().joints;
    const auto moves = [&](const JointEntry& joint) { return joint.body == body; };
    while (std::none_of(joints.begin(), joints.end(), moves)) body = m().body_parentid[body];
    return body;
  }
  // √S at q of each mover.
  std::vector<double> Roots(const VectorXd& q) {
    VectorXd r;
    norm.Residual(q, r);
    const std::vector<NormTerm>& terms = norm.terms();
    const bool pieces = metric == Metric::kDisplacement;
    std::vector<double> S(pieces ? m().nbody : terms.size(), 0.0);
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (pieces && terms[i].joint >= 0) continue;
      const int mover = pieces ? PieceOf(terms[i].body) : static_cast<int>(i);
      S[mover] += norm.total_mass() * norm.TermSigma(terms[i], r);
    }
    for (double& s : S) s = std::sqrt(s);
    return S;
  }
  // Where a point that is at x when posed at q_in is at q, if it is fixed to the body.
  Vector3d Carried(int body, const Vector3d& x) const {
    const mjData &d0 = *before.data(), &d1 = *after.data();
    const Matrix3d R = AsMatrix(d1.xmat + 9 * body) * AsMatrix(d0.xmat + 9 * body).transpose();
    return AsVector(d1.xpos + 3 * body) + R * (x - AsVector(d0.xpos + 3 * body));
  }

  const double scale;
  const Metric metric;
  ModelPtr model;
  Scene scene;
  NormEvaluator norm;
  PosedModel before, after;
  VectorXd q_in, required;
  std::vector<NearPair> none;
  LowerBoundInput input{scene.tables(), norm, before, none, required, metric};
  Chains chains;
};

struct Model {
  std::string xml;
  SceneOptions options = {};
};
std::vector<Model> Models(Random& rng) {
  std::vector<Model> models = {{ArmXml()}, {TwoTreesXml()}, {OffCentreXml()}, {BallChainXml(true)}};
  models.push_back({ArmXml(), {.fixed = {"fore"}}});
  for (const char* root : {"tip", "pad", "cart"})
    models.push_back({OffCentreXml(), {.root = root}});
  models.push_back({TwoTreesXml(), {.root = "a2", .armature = 0.1}});
  for (int k = 0; k < 4; ++k) {
    Model& model = models.emplace_back();
    model.xml = RandomRobotXml(rng, {.free_base = k % 2 == 0});
    if (k > 1) model.options.root = "b5";
    if (k == 3) model.options.armature = 0.05;
  }
  return models;
}

VectorXd Near(const AtInput& at, double length, Random& rng) {
  VectorXd dq = length * rng.Normals(at.scene.tables().n), q;
  for (const JointEntry& joint : at.scene.tables().joints) {
    for (int k = 0; k < joint.ndof; ++k) dq[joint.col + k] *= joint.Slides(k) ? at.scale : 1.0;
  }
  Integrate(at.scene.tables(), at.q_in, dq, q);
  return q;
}

TEST_F(LowerBoundChainContractTest, ABodyIsTakenNoFartherThanTheMoversOfItsPathReach) {
  Random rng(2);
  int held = 0, still = 0;
  std::vector<double> ratios;
  for (int trial = 0; trial < 8; ++trial) {
    const Metric metric = trial % 2 ? Metric::kDisplacement : Metric::kSequential;
    for (const Model& model : Models(rng)) {
      AtInput at(model.xml, model.options, metric, rng.Uniform(-3.0, 3.0), rng);
      const VectorXd q = Near(at, std::pow(10.0, rng.Uniform(-3.0, 0.0)), rng);
      const std::vector<double> roots = at.Roots(q);
      at.after.Pose(q);
      for (int body = 0; body < at.m().nbody; ++body) {
        const Vector3d x = AsVector(at.before.data()->xpos + 3 * body) + at.scale * rng.InBox(0.3);
        const double way = (at.Carried(body, x) - x).norm();
        const std::vector<int> path = at.Path(body);
        const MoverPool pool = at.Along(path);
        EXPECT_EQ(path.empty(), !at.scene.tables().body_moves[body]);
        double reach = 0.0;
        for (std::size_t k = 0; k < path.size(); ++k) {
          reach += roots[path[k]] * std::sqrt(ReachSquared(pool[k], x, 0.0));
        }
        EXPECT_LE(way, reach * (1.0 + 1e-6) + 1e-9 * at.scale) << "body " << body;
        ++(path.empty() ? still : held);
        if (!path.empty()) ratios.push_back(way / reach);
      }
    }
  }
  EXPECT_GT(held, 300);
  EXPECT_GT(still, 100);
  std::sort(ratios.begin(), ratios.end());
  EXPECT_GT(ratios[ratios.size() / 2], 0.1);
}

// Each joint alone: S is what T and C say, by slide and turn of what it moves.
TEST_F(LowerBoundChainContractTest, WhatAMoverCostsIsWhatItsCompliancesSay) {
  Random rng(3);
  std::vector<int> seen(4, 0);
  for (int trial = 0; trial < 8; ++trial) {
    for (const Model& model : Models(rng)) {
      if (!model.options.root.empty()) continue;
      AtInput at(model.xml, model.options, Metric::kSequential, rng.Uniform(-3.0, 3.0), rng);
      for (std::size_t i = 0; i < at.norm.terms().size(); ++i) {
        const JointEntry& joint = at.scene.tables().joints[at.norm.terms()[i].joint];
        VectorXd q = at.q_in;
        const VectorXd other = Near(at, 0.3, rng);
        q.segment(joint.qadr, QposEntries(joint)) = other.segment(joint.qadr, QposEntries(joint));
        at.after.Pose(q);
        const Mover mover = at.Along({static_cast<int>(i)}).at(0);
        const mjData &d0 = *at.before.data(), &d1 = *at.after.data();
        const Eigen::AngleAxisd turn(Matrix3d(AsMatrix(d1.xmat + 9 * joint.body) *
                                              AsMatrix(d0.xmat + 9 * joint.body).transpose()));
        const Vector3d w = 2.0 * std::sin(0.5 * turn.angle()) * turn.axis();
        const Vector3d slide = at.Carried(joint.body, mover.anchor) - mover.anchor;
        double S = 0.0;
        if (mover.slide > 0.0) S += slide.squaredNorm() / (mover.slide * mover.slide);
        if (mover.hinge) S += w.squaredNorm() / (mover.turn * mover.turn);
        if (!mover.hinge && mover.turn > 0.0) S += w.dot(mover.C.inverse() * w);
        const double root = at.Roots(q)[i];
        EXPECT_NEAR(std::sqrt(S), root, 1e-6 * root) << "joint of type " << joint.type;
        EXPECT_EQ(mover.hinge, joint.type == mjJNT_HINGE);
        EXPECT_NEAR(mover.slide, std::sqrt(mover.T.operatorNorm()), 1e-9 * mover.slide);
        EXPECT_NEAR(mover.turn, std::sqrt(mover.C.operatorNorm()), 1e-9 * mover.turn);
        ++seen[joint.type];
      }
    }
  }
  for (const int type : seen) EXPECT_GT(type, 7);
}

// Joints between two bodies: those above one of them alone.
std::vector<int> JointsAbove(const mjModel& m, int body) {
  std::vector<int> joints;
  for (int b = body; b > 0; b = m.body_parentid[b]) {
    for (int k = m.body_jntnum[b] - 1; k >= 0; --k) joints.push_back(m.body_jntadr[b] + k);
  }
  return joints;  // falling: MuJoCo numbers the joints of a tree from its top down
}

TEST_F(LowerBoundChainContractTest, APathGoesFromTheBaseThroughAllJointsBetween) {
  Random rng(4);
  int rooted = 0, other_tree = 0, plain = 0;
  for (int trial = 0; trial < 6; ++trial) {
    for (const Model& model : Models(rng)) {
      AtInput at(model.xml, model.options, Metric::kSequential, rng.Uniform(-3.0, 3.0), rng);
      const int root = at.scene.tables().root_body;
      const std::vector<NormTerm>& terms = at.norm.terms();
      const bool posed = std::any_of(terms.begin(), terms.end(), [](const NormTerm& term) {
        return term.kind == NormTerm::Kind::kBodyPose;
      });
      for (int body = 0; body < at.m().nbody; ++body) {
        std::vector<int> joints, expected = JointsAbove(at.m(), body);
        const bool from_root = posed && at.scene.tables().body_moves[body] &&
                               at.m().body_treeid[body] == at.m().body_treeid[root];
        std::vector<int> above = from_root ? JointsAbove(at.m(), root) : std::vector<int>();
        while (!above.empty() && !expected.empty() && above.back() == expected.back()) {
          above.pop_back();
          expected.pop_back();
        }
        std::reverse(expected.begin(), expected.end());
        expected.insert(expected.begin(), above.begin(), above.end());
        std::erase_if(expected, [&](int joint) {
          return at.scene.tables().column_of_dof[at.m().jnt_dofadr[joint]] < 0;
        });
        bool first = true;
        for (const int i : at.Path(body)) {
          const bool pose = terms[i].kind == NormTerm::Kind::kBodyPose;
          EXPECT_EQ(pose, first && from_root);
          if (!pose) joints.push_back(at.scene.tables().joints[terms[i].joint].id);
          first = false;
        }
        EXPECT_EQ(joints, expected) << "body " << body << " root " << model.options.root;
        ++(from_root ? rooted : posed ? other_tree : plain);
      }
    }
  }
  EXPECT_GT(rooted, 50);
  EXPECT_GT(other_tree, 50);
  EXPECT_GT(plain, 50);
}

TEST_F(LowerBoundChainContractTest, OfTheDisplacementMetricAPathIsTheRigidPiece) {
  Random rng(5);
  int merged = 0, moved = 0;
  for (int trial = 0; trial < 6; ++trial) {
    for (const Model& model : Models(rng)) {
      AtInput at(model.xml, model.options, Metric::kDisplacement, rng.Uniform(-3.0, 3.0), rng);
      const VectorXd q = Near(at, 0.3, rng);
      const std::vector<double> roots = at.Roots(q);
      at.after.Pose(q);
      for (int body = 1; body < at.m().nbody; ++body) {
        if (!at.scene.tables().body_moves[body]) continue;
        const int piece = at.PieceOf(body);
        EXPECT_EQ(at.Path(body), std::vector<int>{piece});
        merged += piece != body;
        const Mover mover = at.Along({piece}).at(0);
        const mjData &d0 = *at.before.data(), &d1 = *at.after.data();
        const Eigen::AngleAxisd turn(
            Matrix3d(AsMatrix(d1.xmat + 9 * body) * AsMatrix(d0.xmat + 9 * body).transpose()));
        const Vector3d w = 2.0 * std::sin(0.5 * turn.angle()) * turn.axis();
        const Vector3d slide = at.Carried(body, mover.anchor) - mover.anchor;
        const double S =
            slide.squaredNorm() / (mover.slide * mover.slide) + w.dot(mover.C.inverse() * w);
        EXPECT_NEAR(std::sqrt(S), roots[piece], 1e-6 * roots[piece]) << "body " << body;
        ++moved;
      }
    }
  }
  EXPECT_GT(merged, 20);
  EXPECT_GT(moved, 100);
}

// ---- Pools ----

const std::string kSlides = R"(<mujoco><worldbody><geom size=".1"/><body name="x">
    <joint type="slide" axis="1 0 0"/><joint type="slide" axis="1 1 0"/><geom size=".1"/>
    <body name="y"><joint type="slide" axis="0 1 1"/><joint axis="0 0 1" pos="1 0 0"/>
    <joint type="slide" axis="0 0 1"/><geom size=".1"/></body></body></worldbody></mujoco>)";

TEST_F(LowerBoundChainContractTest, ConsecutiveSlidesBecomeOneMoverButNotThoseOfTwoChains) {
  Random rng(6);
  AtInput at(kSlides, {}, Metric::kSequential, 0.0, rng);
  const std::vector<int> path = at.Path(2);
  ASSERT_EQ(path.size(), 5u);
  const MoverPool alone = at.Along(path);
  ASSERT_EQ(alone.size(), 5u);
  MoverPool pool;
  at.chains.AppendAlong(path, pool);
  ASSERT_EQ(pool.size(), 3u);
  const Matrix3d T = alone[0].T + alone[1].T + alone[2].T;
  EXPECT_LT((pool[0].T - T).norm(), 1e-12 * T.norm());
  EXPECT_NEAR(pool[0].slide, std::sqrt(T.operatorNorm()), 1e-9 * pool[0].slide);
  EXPECT_TRUE(pool[1].hinge);
  EXPECT_EQ(pool[2].T, alone[4].T);
  at.chains.AppendAlong(std::span(path).subspan(1, 2), pool);
  ASSERT_EQ(pool.size(), 4u) << "the last chain's slide is not this one's";
  EXPECT_EQ(pool[2].T, alone[4].T);
  EXPECT_LT((pool[3].T - alone[1].T - alone[2].T).norm(), 1e-12 * T.norm());
  EXPECT_TRUE(Finite(pool));
}

// The model of a running program may have bodies without mass.
TEST_F(LowerBoundChainContractTest, WhereSomethingMovesForFreeNothingIsFinite) {
  Random rng(7);
  ModelPtr model = LoadModel(kSlides);
  for (const int massless : {0, 1, 2}) {
    if (massless > 0) {
      for (int body = 3 - massless; body < 3; ++body) {
        model->body_mass[body] = 0.0;
        std::fill_n(model->body_inertia + 3 * body, 3, 0.0);
      }
    }
    const Scene scene = Scene::FromModel(model.get());
    NormEvaluator norm(scene.tables(), Metric::kSequential);
    PosedModel posed(&scene.tables().query_model);
    const VectorXd q = VectorXd::Zero(5), required = VectorXd::Zero(2);
    norm.SetReference(q);
    posed.Pose(q);
    const std::vector<NearPair> none;
    const LowerBoundInput input{scene.tables(), norm, posed, none, required};
    Chains chains;
    chains.Fill(input);
    for (const int body : {1, 2}) {
      std::vector<int> path;
      chains.Path(body, path);
      MoverPool pool;
      chains.AppendAlong(path, pool);
      EXPECT_EQ(Finite(pool), body < 3 - massless) << massless << " " << body;
      // The first slides, which no turn follows.
      pool.clear();
      chains.AppendAlong(std::span(path).first(body + 1), pool);
      EXPECT_EQ(Finite(pool), body < 3 - massless) << massless << " " << body;
    }
  }
}

// A wall, a heavy slide across and a slide without mass out of it: the way out costs nothing.
TEST_F(LowerBoundChainContractTest, AWayOutForFreeIsBoundByZero) {
  const ModelPtr model = LoadModel(R"(<mujoco><worldbody><geom type="box" size=".1 1 1"/>
    <body><joint type="slide" axis="0 1 0"/><geom size=".01" pos="1 0 0"/>
    <body><joint type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/></body>
    </body></worldbody></mujoco>)");
  model->body_mass[2] = 0.0;
  std::fill_n(model->body_inertia + 6, 3, 0.0);
  AtStart at(Scene::FromModel(model.get()), VectorXd::Zero(2));
  const VectorXd out = Vector3d(0.0, 0.21, 0.0).head(2);
  ASSERT_EQ(at.near.size(), 1u);
  EXPECT_TRUE(at.Free(out));
  EXPECT_EQ(at.norm.Sigma(out), 0.0);
  EXPECT_EQ(at.Bound(), 0.0);
}

}  // namespace
}  // namespace mjcf_pdg::test
