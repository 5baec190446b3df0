// The independent check where meshes collide as their triangles.
#include "verify/exact_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "collide/contacts.h"
#include "mjcf_pdg/pdg.h"
#include "tests/support/brute_mesh.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"
#include "verify/verifier.h"

namespace mjcf_pdg {
namespace {

using test::MeshShape;
using test::Random;

class ExactPairTest : public test::MujocoTest {};

using test::Exact;
using test::FreePose;

using test::MeshScene;

const char* const kGeoms[] = {"type='sphere' size='0.04'",
                              "type='capsule' size='0.02 0.05'",
                              "type='ellipsoid' size='0.02 0.03 0.06'",
                              "type='cylinder' size='0.03 0.04'",
                              "type='box' size='0.02 0.03 0.05'",
                              "type='mesh' mesh='moving'"};

// Two implementations that share FCL's triangle distance, but nothing of what is an overlap, agree.
TEST_F(ExactPairTest, AgreesWithTheSolversQueriesAgainstEveryType) {
  Random rng(31);
  const MeshShape fixed[] = {test::TorusKnot(0.1, 0.03, 60, 8), test::Cup(0.12, 0.2, 0.03, 16)};
  for (const MeshShape& mesh : fixed) {
    for (const char* geom : kGeoms) {
      const Scene scene = MeshScene(mesh, geom, test::Torus(0.08, 0.02, 20, 8));
      ContactFinder finder(scene.tables());
      Verifier verifier(scene.verifier_model(), {});
      int free = 0, overlapping = 0;
      for (int i = 0; i < 60; ++i) {
        const std::vector<double> q = FreePose(rng.InBox(0.2), rng.UnitQuat());
        finder.Pose(test::ToEigen(q));
        NearPair near;
        near.distance = 1.0;
        finder.Distance(0, 1.0, near);
        if (std::abs(near.distance) < 1e-5) continue;
        const Verdict& verdict = verifier.Check(q);
        EXPECT_EQ(verdict.free, near.distance > 0.0)
            << geom << " " << i << ": " << verdict.min_distance << ", solver " << near.distance;
        if (verdict.free) {
          EXPECT_NEAR(verdict.min_distance, near.distance, 1e-6) << geom;
        }
        EXPECT_EQ(verdict.contacts.empty(), verdict.free);
        EXPECT_TRUE(verdict.certified);
        ++(verdict.free ? free : overlapping);
      }
      EXPECT_GT(free, 5) << geom;
      EXPECT_GT(overlapping, 5) << geom;
    }
  }
}

// Two rings of wire: where they cross, the triangles are smaller than the tolerance, and few.
TEST_F(ExactPairTest, TrianglesSmallerThanTheToleranceHideNoOverlap) {
  Random rng(32);
  const MeshShape ring = test::Torus(0.04, 0.0005, 200, 24);
  const Scene scene = MeshScene(ring, "type='mesh' mesh='moving'", ring);
  Options coarse;
  coarse.tolerance = 2e-4;
  ContactFinder finder(scene.tables());
  Verifier verifier(scene.verifier_model(), coarse);
  int overlapping = 0;
  for (int i = 0; i < 400; ++i) {
    const std::vector<double> q = FreePose(rng.InBox(0.03), rng.UnitQuat());
    finder.Pose(test::ToEigen(q));
    NearPair near;
    near.distance = 1.0;
    finder.Distance(0, 1.0, near);
    if (near.distance > -1.5 * coarse.tolerance) continue;
    ++overlapping;
    EXPECT_FALSE(verifier.Check(q).free) << i << ": " << near.distance;
  }
  EXPECT_GT(overlapping, 10);
}

// A ring that lies on another: what is permitted parts them, straight up.
TEST_F(ExactPairTest, AnOverlapWithinTheToleranceIsFree) {
  const MeshShape ring = test::Torus(0.08, 0.02, 40, 16);
  const Scene scene = MeshScene(ring, "type='mesh' mesh='moving'", ring);
  Verifier verifier(scene.verifier_model(), {});
  for (const auto& [depth, free] : {std::pair(0.5e-6, true), {0.9e-6, true}, {1.1e-6, false}}) {
    EXPECT_EQ(verifier.Check(FreePose({0, 0, 0.04 - depth}, {1, 0, 0, 0})).free, free) << depth;
  }
}

// A third that shares nothing: every triangle, and no tree.
TEST_F(ExactPairTest, DistancesAreThoseOfEveryPairOfTriangles) {
  constexpr double kRadius = 0.04;
  Random rng(34);
  const MeshShape fixed[] = {test::TorusKnot(0.1, 0.03, 60, 8), test::Cup(0.12, 0.2, 0.03, 16)};
  const MeshShape torus = test::Torus(0.08, 0.02, 20, 8);
  const std::pair<const char*, MeshShape> moving[] = {
      {"type='sphere' size='0.04'", {}},
      {"type='box' size='0.02 0.03 0.05'", test::BoxMesh({0.02, 0.03, 0.05})},
      {"type='mesh' mesh='moving'", torus}};
  for (const MeshShape& mesh : fixed) {
    for (const auto& [geom, shape] : moving) {
      const Scene scene = MeshScene(mesh, geom, torus);
      Verifier verifier(scene.verifier_model(), {});
      int free = 0, crossing = 0;
      for (int i = 0; i < 60; ++i) {
        const Vector3d p = rng.InBox(0.2);
        const Eigen::Quaterniond r = rng.UnitQuat();
        const double surface =
            shape.faces.empty()
                ? std::max(0.0, test::BruteDistance(mesh, p) - kRadius)
                : test::BruteDistance(mesh, test::Moved(shape, r.toRotationMatrix(), p));
        const Verdict& verdict = verifier.Check(FreePose(p, r));
        if (verdict.free) {
          EXPECT_NEAR(verdict.min_distance, surface, 1e-6) << geom << " " << i;
        }
        if (surface == 0.0) {
          EXPECT_FALSE(verdict.free) << geom << " " << i;
        }
        free += verdict.free;
        crossing += surface == 0.0;
      }
      EXPECT_GT(free, 5) << geom;
      EXPECT_GT(crossing, 5) << geom;
    }
  }
}

// What is free does not depend on whether depths are asked for; how deep and how far does.
TEST_F(ExactPairTest, SkippedDepthsLeaveTheVerdictAsItIs) {
  Random rng(33);
  const MeshShape cup = test::Cup(0.12, 0.2, 0.03, 16);
  for (const char* geom : {kGeoms[0], kGeoms[4], kGeoms[5]}) {
    const Scene scene = MeshScene(cup, geom, test::Torus(0.08, 0.02, 20, 8));
    Options clear;
    clear.clearance = 0.01;
    for (const Options& options : {Options(), clear}) {
      Verifier verifier(scene.verifier_model(), options);
      int free = 0;
      for (int i = 0; i < 40; ++i) {
        const std::vector<double> q = FreePose(rng.InBox(0.2), rng.UnitQuat());
        const Verdict measured = verifier.Check(q);
        const Verdict& skipped = verifier.Check(q, {}, verify::Depths::kSkipped);
        EXPECT_EQ(skipped.free, measured.free) << geom << " " << i;
        EXPECT_EQ(skipped.contacts.size(), measured.contacts.size());
        EXPECT_GE(skipped.min_distance, measured.min_distance - 1e-9) << geom << " " << i;
        EXPECT_EQ(skipped.min_distance < 0.0, measured.min_distance < 0.0);
        free += measured.free;
      }
      EXPECT_GT(free, 5) << geom;
      EXPECT_LT(free, 35) << geom;
    }
  }
}

TEST_F(ExactPairTest, ToleranceIsKeptOnBothSides) {
  const MeshShape block = test::BoxMesh({0.1, 0.1, 0.1});
  for (const char* geom : kGeoms) {
    const Scene scene = MeshScene(block, geom, test::BoxMesh({0.03, 0.04, 0.05}));
    ContactFinder finder(scene.tables());
    finder.Pose(test::ToEigen(FreePose({0.02, 0.03, 0.3})));
    NearPair near;
    ASSERT_TRUE(finder.Distance(0, 1.0, near));
    const double touch = 0.3 - near.distance;
    for (const double overlap : {-1e-3, -1e-7, 0.0, 0.5e-6, 0.9e-6}) {
      EXPECT_TRUE(Verify(scene, FreePose({0.02, 0.03, touch - overlap})).free) << geom << overlap;
    }
    for (const double overlap : {1.2e-6, 1e-5, 1e-3}) {
      const Verdict verdict = Verify(scene, FreePose({0.02, 0.03, touch - overlap}));
      EXPECT_FALSE(verdict.free) << geom << overlap;
      EXPECT_NEAR(verdict.min_distance, -overlap, 0.1 * overlap + 1e-7) << geom;
      ASSERT_EQ(verdict.contacts.size(), 1u);
      EXPECT_GT(std::abs(verdict.contacts[0].normal_W[2]), 0.7) << geom;
    }
  }
}

TEST_F(ExactPairTest, BodiesWhollyInsideCollideAndHollowsAreFree) {
  for (const char* geom : kGeoms) {
    const Scene block = MeshScene(test::BoxMesh({0.4, 0.4, 0.4}), geom);
    EXPECT_FALSE(Verify(block, FreePose({0.1, 0.05, 0.02})).free) << geom;
    MeshShape shell = test::BoxMesh({0.4, 0.4, 0.4}), inner = test::BoxMesh({0.3, 0.3, 0.3});
    shell.Append(inner.TurnInsideOut());
    const Scene hollow = MeshScene(shell, geom);
    EXPECT_TRUE(Verify(hollow, FreePose({0.1, 0.05, 0.02})).free) << geom;
    EXPECT_FALSE(Verify(hollow, FreePose({0.35, 0.05, 0.02})).free) << geom;
  }
  const Scene around = MeshScene(test::Torus(0.05, 0.01, 16, 8), "type='box' size='0.3 0.3 0.3'");
  EXPECT_FALSE(Verify(around, FreePose({0.0, 0.0, 0.1})).free);
}

// Of a body wholly inside, too, the contact says how deep it is and which way is out, more or less:
// the nearest face, from geom 1 to geom 2.
TEST_F(ExactPairTest, OfABodyInsideTheNearestFaceIsTheWayOut) {
  MeshShape blocks = test::BoxMesh({0.4, 0.4, 0.4});  // two, so that they are no convex hull
  blocks.Append(test::BoxMesh({0.4, 0.4, 0.4}).Move(Eigen::Matrix3d::Identity(), {9.0, 0, 0}));
  for (const char* geom : kGeoms) {
    const Scene block = MeshScene(blocks, geom);
    for (int k = 0; k < 6; ++k) {
      const Vector3d out = (k < 3 ? 1.0 : -1.0) * Vector3d::Unit(k % 3);
      const Verdict verdict = Verify(block, FreePose(0.3 * out));
      ASSERT_EQ(verdict.contacts.size(), 1u) << geom;
      const Contact& contact = verdict.contacts[0];
      const double way = contact.geom[0] < contact.geom[1] ? 1.0 : -1.0;
      const Vector3d normal =
          way * Vector3d(contact.normal_W[0], contact.normal_W[1], contact.normal_W[2]);
      EXPECT_GT(normal.dot(out), 0.95) << geom << " " << out.transpose();
      EXPECT_LT(contact.distance, -0.03) << geom;  // of a point of it, 0.1 and more of the body
    }
  }
}

// An L, extruded along z; `inset` moves every wall inwards [m].
MeshShape Angle(double inset = 0.0) {
  const double low = inset, far = 0.2 - inset, mid = 0.1 - inset;
  MeshShape shape;
  for (const double z : {low, 0.1 - inset}) {
    for (const auto& [x, y] : {std::pair(low, low), std::pair(far, low), std::pair(far, mid),
                               std::pair(mid, mid), std::pair(mid, far), std::pair(low, far)}) {
      shape.vertices.emplace_back(x, y, z);
    }
  }
  for (int k = 0; k < 6; ++k) {
    const int next = (k + 1) % 6;
    shape.faces.emplace_back(k, next, next + 6);
    shape.faces.emplace_back(k, next + 6, k + 6);
  }
  for (const auto& [a, b, c] :
       {std::array{0, 3, 1}, std::array{1, 3, 2}, std::array{0, 5, 4}, std::array{0, 4, 3}}) {
    shape.faces.emplace_back(a, b, c);
    shape.faces.emplace_back(a + 6, c + 6, b + 6);
  }
  return shape;
}

TEST_F(ExactPairTest, SolidsWhoseSurfacesCoincideOverlap) {
  const Vector3d way = Vector3d(0.36, -0.48, 0.8);
  for (const MeshShape& shape :
       {Angle(), test::Torus(0.1, 0.03, 24, 12), test::Cup(0.05, 0.1, 0.01, 24)}) {
    const Scene scene = MeshScene(shape, "type='mesh' mesh='moving'", shape);
    for (const double offset : {0.0, 1e-13, 1e-9, 1e-7, 5e-7, 7e-7, 2e-6}) {
      EXPECT_FALSE(Verify(scene, FreePose(offset * way)).free) << offset;
      EXPECT_FALSE(Verify(scene, FreePose(Vector3d(0, 0, offset))).free) << offset;
    }
  }
}

TEST_F(ExactPairTest, ABodyInACavityOfItsOwnShapeOverlapsHoweverSmallTheGap) {
  for (const double gap : {1e-7, 5e-7, 8e-7, 2e-6, 1e-4}) {
    const Scene scene = MeshScene(Angle(), "type='mesh' mesh='moving'", Angle(gap));
    EXPECT_FALSE(Verify(scene, FreePose({0, 0, 0})).free) << gap;
    MeshShape cavity = test::BoxMesh({0.5, 0.5, 0.5});
    cavity.Append(Angle().TurnInsideOut());
    const Scene hollow = MeshScene(cavity, "type='mesh' mesh='moving'", Angle(gap));
    EXPECT_TRUE(Verify(hollow, FreePose({0, 0, 0})).free) << gap;
  }
}

// Where parts of a mesh overlap or touch, inside is still inside.
TEST_F(ExactPairTest, PartsOfAMeshMayOverlapOrTouch) {
  MeshShape cross = test::BoxMesh({0.4, 0.12, 0.12}), touching = test::BoxMesh({0.2, 0.2, 0.2}),
            nested = test::BoxMesh({0.4, 0.4, 0.4});
  cross.Append(test::BoxMesh({0.121, 0.4, 0.119}));
  touching.Append(test::BoxMesh({0.2, 0.2, 0.2}).Move(Eigen::Matrix3d::Identity(), {0.4, 0, 0}));
  nested.Append(test::BoxMesh({0.3, 0.3, 0.3}));
  for (const char* geom : kGeoms) {
    for (const Vector3d& at : {Vector3d(0.01, 0.02, 0.03), Vector3d(-0.03, 0.04, 0.0)}) {
      EXPECT_FALSE(Verify(MeshScene(cross, geom), FreePose(at)).free) << geom;
      EXPECT_FALSE(Verify(MeshScene(touching, geom), FreePose(at)).free) << geom;
      EXPECT_FALSE(Verify(MeshScene(nested, geom), FreePose(at)).free) << geom;
    }
    EXPECT_FALSE(Verify(MeshScene(touching, geom), FreePose({0.2, 0.01, 0.02})).free) << geom;
    EXPECT_TRUE(Verify(MeshScene(cross, geom), FreePose({0.3, 0.3, 0.3})).free) << geom;
  }
}

TEST_F(ExactPairTest, LinkedRingsAreFree) {
  const MeshShape ring = test::Torus(0.1, 0.02, 48, 16);
  const Scene scene = MeshScene(ring, "type='mesh' mesh='moving'", ring);
  const Eigen::Quaterniond upright(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()));
  const Verdict linked = Verify(scene, FreePose({0.1, 0, 0}, upright));
  EXPECT_TRUE(linked.free);
  EXPECT_NEAR(linked.min_distance, 0.06, 1e-3);
  const Verdict crossed = Verify(scene, FreePose({0.17, 0, 0}, upright));
  EXPECT_FALSE(crossed.free);
  EXPECT_NE(crossed.reason.find("overlap by"), std::string::npos);
}

TEST_F(ExactPairTest, CoplanarAndCrossedTouchesAreFree) {
  const MeshShape box = test::BoxMesh({0.125, 0.125, 0.125});
  const Scene scene = MeshScene(box, "type='mesh' mesh='moving'", box);
  for (const Vector3d& at : {Vector3d(0.25, 0, 0), Vector3d(0.1, 0.05, 0.25),
                             Vector3d(0.25, 0.25, 0.1), Vector3d(0.25, 0.25, 0.25)}) {
    EXPECT_TRUE(Verify(scene, FreePose(at)).free) << at.transpose();
  }
  EXPECT_FALSE(Verify(scene, FreePose({0, 0, 0})).free) << "the same place";
  // A plug that fills the bore of a tube is free; in a block without bore it shares all four sides.
  const Scene plug =
      MeshScene(box, "type='mesh' mesh='moving'", test::BoxMesh({0.125, 0.125, 0.05}));
  EXPECT_FALSE(Verify(plug, FreePose({0, 0, 0.125})).free);
  EXPECT_TRUE(Verify(plug, FreePose({0, 0, 0.175})).free);
}

// Crossing by no more than rounding, corners just below the other's face.
TEST_F(ExactPairTest, FacesThatRestOnEachOtherAreFree) {
  Random rng(37);
  static constexpr double h = 0.0625;  // no rounding
  const auto ring = [](double inner, double outer) {
    return test::Revolution({{inner, -h}, {outer, -h}, {outer, h}, {inner, h}}, 8);
  };
  const Scene scene = MeshScene(ring(0.05, 0.2), "type='mesh' mesh='moving'", ring(0.06, 0.18));
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(rng.Uniform(-3.0, 3.0), Eigen::Vector3d::UnitZ()));
    const auto at = [&](double depth) { return FreePose({0, 0, 2 * h - depth}, turn); };
    const Verdict resting = Verify(scene, at(rng.Uniform(0.0, 2e-9)));
    EXPECT_TRUE(resting.free) << i << ": " << resting.reason;
    EXPECT_FALSE(Verify(scene, at(1.2e-6)).free) << i;
  }
}

TEST_F(ExactPairTest, AnOpenMeshHasASurfaceOnly) {
  MeshShape open = test::BoxMesh({0.2, 0.2, 0.2});
  open.faces.resize(10);
  const Scene scene = MeshScene(open, "type='box' size='0.05 0.05 0.05'");
  EXPECT_TRUE(Verify(scene, FreePose({0, 0, 0})).free);
  EXPECT_FALSE(Verify(scene, FreePose({-0.2, 0, 0})).free);
}

}  // namespace
}  // namespace mjcf_pdg
