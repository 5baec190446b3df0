// What collide/sdf and the verifier's sdf_pair.h promise, by the definition of a signed distance
// and of its least value: all points of a grid.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "collide/sdf/posed_field.h"
#include "collide/sdf/sdf_contacts.h"
#include "tests/support/brute_distance.h"
#include "tests/support/brute_mesh.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"
#include "verify/sdf_pair.h"

namespace mjcf_pdg::test {
namespace {

class SdfContractTest : public MujocoTest {};

const MeshShape& Ring() {
  static const MeshShape ring = Torus(0.35, 0.15, 24, 16);
  return ring;
}

// A ring as an SDF in a tilted frame, and free bodies of all other types next to it.
Scene RingScene(Random& rng) {
  std::string bodies, assets = MeshXml("ring", Ring());
  for (const int type : ConvexTypes()) {
    if (type == mjGEOM_PLANE) continue;
    const Shape shape = RandomShape(type, rng);
    std::string geom = "type='" + TypeName(type) + "' size='" + Join(shape.size) + "'";
    if (type == mjGEOM_MESH) {
      std::string vertices;
      for (const Vector3d& v : shape.vertices) vertices += Join(v) + " ";
      assets += "<mesh name='hull' vertex='" + vertices + "'/>";
      geom = "type='mesh' mesh='hull'";
    }
    bodies += "<body><freejoint/><geom " + geom + " pos='" + Join(rng.InBox(0.1)) +
              "' euler='.3 .2 .1'/></body>";
  }
  return Scene::FromString(
      "<mujoco><compiler angle='radian'/><asset>" + assets + "</asset><worldbody>" +
      "<geom type='plane' size='0 0 1' pos='0 0 -1' euler='.2 .1 0'/>"
      "<geom name='ring' type='sdf' mesh='ring' pos='.1 0 -.2' euler='.4 .5 .2'/>" +
      bodies + "</worldbody></mujoco>");
}

struct Posed {
  explicit Posed(Random& random)
      : rng(random), scene(RingScene(rng)), tables(scene.tables()), posed(&tables.query_model) {}

  void Pose(double spread) {
    Eigen::VectorXd q(scene.nq());
    for (int k = 0; k < scene.nq(); k += 7) {
      const Vector3d p = Vector3d(0.1, 0.0, -0.2) + rng.InBox(spread);
      const Eigen::Quaterniond turn = rng.UnitQuat();
      q.segment<7>(k) << p, turn.w(), turn.x(), turn.y(), turn.z();
    }
    posed.Pose(q);
  }
  int ring() const { return mj_name2id(scene.model(), mjOBJ_GEOM, "ring"); }

  Random& rng;
  Scene scene;
  const SceneTables& tables;
  PosedModel posed;
};

TEST_F(SdfContractTest, FieldsOfConvexGeomsAreTheirGreatestPlanes) {
  Random rng(1);
  Posed posed(rng);
  const mjModel& m = *posed.scene.model();
  const mjData* d = posed.posed.data();
  int inside = 0, outside = 0;
  for (int trial = 0; trial < 20; ++trial) {
    posed.Pose(0.3);
    for (int geom = 0; geom < m.ngeom; ++geom) {
      if (geom == posed.ring()) continue;
      const bool plane = m.geom_type[geom] == mjGEOM_PLANE;
      const PosedField field(posed.posed, geom);
      for (int k = 0; k < 10; ++k) {
        const Vector3d x_W = AsVector(d->geom_xpos + 3 * geom) + rng.InBox(k % 2 ? 0.3 : 0.06);
        const double f = field.At(x_W);
        const Vector3d n_W = field.Normal(x_W);
        EXPECT_NEAR(n_W.norm(), 1.0, 1e-12);
        const double reach =
            plane ? n_W.dot(AsVector(d->geom_xpos + 3 * geom)) : Support(&m, d, geom, n_W);
        EXPECT_NEAR(n_W.dot(x_W) - reach, f, 1e-6) << m.geom_type[geom];
        if (plane) {
          EXPECT_LT((n_W - AsMatrix(d->geom_xmat + 9 * geom).col(2)).norm(), 1e-12);
          continue;
        }
        ++(f < 0.0 ? inside : outside);
        // Of a mesh the planes of its faces alone count outside.
        if (m.geom_type[geom] == mjGEOM_MESH && f > 0.0) continue;
        for (int i = 0; i < 20; ++i) {
          const Vector3d other = (n_W + rng.Uniform(0.0, 1.0) * rng.UnitVector()).normalized();
          EXPECT_LE(other.dot(x_W) - Support(&m, d, geom, other), f + 1e-9) << m.geom_type[geom];
        }
      }
    }
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(outside, 100);
}

TEST_F(SdfContractTest, TheFieldOfAnSdfIsAboutItsDistanceAndTheNormalItsGradient) {
  Random rng(2);
  Posed posed(rng);
  posed.Pose(0.3);
  const PosedField field(posed.posed, posed.ring());
  const mjModel& m = *posed.scene.model();
  const mjData* d = posed.posed.data();
  MeshShape ring = Ring();  // in the world, by the mesh's own frame in that of the geom
  const int geom = posed.ring(), mesh = m.geom_dataid[geom];
  for (int v = 0; v < m.mesh_vertnum[mesh]; ++v) {
    const float* p = m.mesh_vert + 3 * (m.mesh_vertadr[mesh] + v);
    ring.vertices[v] = AsVector(d->geom_xpos + 3 * geom) +
                       AsMatrix(d->geom_xmat + 9 * geom) * Vector3d(p[0], p[1], p[2]);
  }
  int inside = 0;
  for (int k = 0; k < 300; ++k) {
    const Vector3d x_W = AsVector(d->geom_xpos + 3 * geom) + rng.InBox(0.5);
    const bool in = InsideBySolidAngle(ring, x_W);
    inside += in;
    const double brute = (in ? -1.0 : 1.0) * BruteDistance(ring, x_W);
    EXPECT_NEAR(field.At(x_W), brute, 0.02 + 0.3 * std::max(brute, 0.0)) << "inexact far outside";
    const Vector3d n_W = field.Normal(x_W);
    EXPECT_NEAR(n_W.norm(), 1.0, 1e-12);
    Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d by = 1e-6 * Vector3d::Unit(axis);
      gradient[axis] = field.At(x_W + by) - field.At(x_W - by);
    }
    if (gradient.norm() > 1e-6) {
      EXPECT_GT(n_W.dot(gradient.normalized()), 0.99);
    }
  }
  EXPECT_GT(inside, 20);
}

// The least of max(f1, f2) over a grid of the box around both geoms' bounding boxes.
double LeastOfGrid(const PosedField& f1, const PosedField& f2, const Vector3d& middle,
                   double half) {
  constexpr int kParts = 18;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      for (int k = 0; k <= kParts; ++k) {
        const Vector3d x = middle + half * (2.0 * Vector3d(i, j, k) / kParts - Vector3d::Ones());
        least = std::min(least, std::max(f1.At(x), f2.At(x)));
      }
    }
  }
  return least;
}

TEST_F(SdfContractTest, FeaturesAreWhereTheLargerFieldIsLeast) {
  Random rng(3);
  Posed posed(rng);
  SdfContacts contacts(posed.tables);
  int apart = 0, overlapping = 0, several = 0, checked = 0;
  for (int trial = 0; trial < 8; ++trial) {
    posed.Pose(trial % 2 ? 0.7 : 0.4);
    for (int pair = 0; pair < static_cast<int>(posed.tables.pairs.size()); ++pair) {
      const KeptPair& kept = posed.tables.pairs[pair];
      if (kept.kind != PairKind::kSdf) continue;
      const PosedField f1(posed.posed, kept.geom1), f2(posed.posed, kept.geom2);
      const int other = kept.geom1 == posed.ring() ? kept.geom2 : kept.geom1;
      const Vector3d middle = AsVector(posed.posed.data()->geom_xpos + 3 * other);
      const double grid = LeastOfGrid(f1, f2, middle, 0.5), margin = 0.2;
      std::vector<SignedGap> gaps(1);
      gaps[0].distance = 42.0;
      contacts.Features(posed.posed, pair, margin, gaps);
      ASSERT_EQ(gaps.front().distance, 42.0) << "it appends";
      gaps.erase(gaps.begin());
      ASSERT_LE(gaps.size(), 8u);
      if (2.0 * grid < margin - 0.01) {
        ASSERT_FALSE(gaps.empty());
      }
      if (gaps.empty()) continue;
      ++(gaps.front().distance > 0.0 ? apart : overlapping);
      several += gaps.size() > 1;
      EXPECT_LE(gaps.front().distance, 2.0 * grid + 1e-4 + 0.05 * std::abs(grid));
      for (std::size_t k = 0; k < gaps.size(); ++k) {
        const SignedGap& gap = gaps[k];
        EXPECT_LT(gap.distance, margin);
        if (k > 0) {
          EXPECT_GE(gap.distance, gaps[k - 1].distance);
        }
        EXPECT_NEAR(gap.n.norm(), 1.0, 1e-12);
        EXPECT_NEAR(gap.n.dot(gap.p2 - gap.p1), gap.distance, 1e-9);
        EXPECT_NEAR((gap.p2 - gap.p1).norm(), std::abs(gap.distance), 1e-9);
        if (gap.distance < -0.05) continue;  // deeper, one field alone may have its least there
        ++checked;
        const Vector3d x = 0.5 * (gap.p1 + gap.p2);
        EXPECT_NEAR(f1.At(x), 0.5 * gap.distance, 1e-3);
        EXPECT_NEAR(f2.At(x), 0.5 * gap.distance, 1e-3);
        EXPECT_GT(gap.n.dot(f1.Normal(x) - f2.Normal(x)), -1e-9) << "from geom 1 to geom 2";
      }
      // A smaller margin leaves out what is beyond it, whatever its finer grid finds.
      const double less = gaps.front().distance - 0.01;
      std::vector<SignedGap> fewer;
      contacts.Features(posed.posed, pair, less, fewer);
      for (const SignedGap& gap : fewer) EXPECT_LT(gap.distance, less);
    }
  }
  EXPECT_GT(apart, 5);
  EXPECT_GT(overlapping, 15);
  EXPECT_GT(several, 3);
  EXPECT_GT(checked, 15);
}

TEST_F(SdfContractTest, TheVerifiersLeastIsTheLeastOfAllPoints) {
  Random rng(4);
  Posed posed(rng);
  const VerifierModel& model = *posed.scene.verifier_model();
  int apart = 0, overlapping = 0, beyond = 0;
  for (int trial = 0; trial < 8; ++trial) {
    posed.Pose(trial % 2 ? 0.8 : 0.4);
    for (const verify::CheckedPair& checked : model.pairs) {
      if (!checked.sdf) continue;
      const verify::PosedPair pair{model, *posed.posed.data(), checked};
      const PosedField f1(posed.posed, checked.geom1), f2(posed.posed, checked.geom2);
      const int other = checked.geom1 == posed.ring() ? checked.geom2 : checked.geom1;
      const Vector3d middle = AsVector(posed.posed.data()->geom_xpos + 3 * other);
      const double grid = LeastOfGrid(f1, f2, middle, 0.5), cutoff = 0.1;
      const verify::Reading reading = verify::SdfPair(pair).Measure(cutoff);
      if (!std::isfinite(reading.distance)) {
        ++beyond;
        EXPECT_GT(2.0 * grid, cutoff);
        continue;
      }
      ++(reading.distance > 0.0 ? apart : overlapping);
      EXPECT_LT(reading.distance, cutoff);
      EXPECT_LE(reading.distance, 2.0 * grid + 1e-4 + 0.05 * std::abs(grid));
      // Deep overlaps are where one field alone may have its least.
      const double off = 1e-3 + 0.05 * std::max(0.0, -reading.distance);
      EXPECT_NEAR(reading.n_W.norm(), 1.0, 1e-12);
      EXPECT_NEAR(reading.n_W.dot(reading.p2_W - reading.p1_W), reading.distance, off);
      const Vector3d x = 0.5 * (reading.p1_W + reading.p2_W);
      EXPECT_NEAR(2.0 * std::max(f1.At(x), f2.At(x)), reading.distance, off);
      EXPECT_GT(reading.n_W.dot(f1.Normal(x) - f2.Normal(x)), 0.0);
    }
  }
  EXPECT_GT(apart, 2);
  EXPECT_GT(overlapping, 15);
  EXPECT_GT(beyond, 1);
}

// The bounding boxes of the two are apart, but by less than the margin.
TEST_F(SdfContractTest, ASphereAboveTheRingIsAsFarAsItIsAbove) {
  const Scene scene = Scene::FromString(
      "<mujoco><asset>" + MeshXml("ring", Ring()) +
      "</asset><worldbody><geom size='.1' pos='9 9 9'/><geom type='sdf' mesh='ring'/>"
      "<body><freejoint/><geom size='.1'/></body></worldbody></mujoco>");
  PosedModel posed(&scene.tables().query_model);
  for (const double above : {0.02, 0.06}) {
    posed.Pose(ToEigen(FreePose({0.35, 0.0, 0.25 + above})));
    int pairs = 0;
    for (int pair = 0; pair < scene.num_kept_pairs(); ++pair) {
      if (scene.tables().pairs[pair].kind != PairKind::kSdf) continue;
      ++pairs;
      std::vector<SignedGap> gaps;
      SdfContacts(scene.tables()).Features(posed, pair, 0.1, gaps);
      ASSERT_FALSE(gaps.empty());
      EXPECT_NEAR(gaps[0].distance, above, 0.01);
      EXPECT_GT(std::abs(gaps[0].n.z()), 0.99);
    }
    EXPECT_EQ(pairs, 1);
    const VerifierModel& model = *scene.verifier_model();
    for (const verify::CheckedPair& checked : model.pairs) {
      if (!checked.sdf) continue;
      const verify::PosedPair pair{model, *posed.data(), checked};
      EXPECT_NEAR(verify::SdfPair(pair).Measure(0.1).distance, above, 0.01);
      EXPECT_TRUE(std::isinf(verify::SdfPair(pair).Measure(above - 0.015).distance));
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
