#include "collide/exact/exact_contacts.h"

#include <algorithm>
#include <limits>

#include "collide/exact/bvh_overlap.h"
#include "collide/exact/sdf_mesh.h"

namespace mjcf_pdg {
namespace {

// Where surfaces cross, features that are apart are sought only with a margin of at least this
// share of the smaller mesh's radius.
constexpr double kBeside = 1e-2;

SignedGap Unmeasured(SignedGap gap) {
  gap.distance = -std::numeric_limits<double>::infinity();
  return gap;
}

// The answer for two triangle meshes, in tree units (triangle_bvh.h) and the frame of mesh a.
// `rough`: the first feature need not be the nearest (BvhPair::RoughlyNearest). `warm` is where the
// search starts, and receives the triangles it finds.
void AskBvhs(const BvhPair& pair, double margin, ExactQuery query, bool rough,
             NearestTriangles& warm, std::vector<SignedGap>& out) {
  const bool nearest_alone = query == ExactQuery::kNearest;
  const double cutoff = std::max(margin, BvhPair::kTouching);
  const NearestTriangles near =
      rough && !nearest_alone ? pair.RoughlyNearest(cutoff, &warm) : pair.Nearest(cutoff, &warm);
  if (near.a >= 0) warm = near;
  const bool crossing = near.a >= 0 && near.distance < BvhPair::kTouching;
  const std::optional<SignedGap> graze = crossing ? Graze(pair, near) : std::nullopt;
  if (graze) {
    out.push_back(*graze);
    if (nearest_alone) return;
  } else if (crossing || Contained(pair)) {
    if (query == ExactQuery::kUnmeasuredFeatures) {
      return out.push_back(Unmeasured(crossing ? TriangleGap(pair, near) : SignedGap()));
    }
    AppendOverlaps(pair, query == ExactQuery::kSearchedFeatures ? kManyParts : kFewParts, out);
    if (nearest_alone) return;
  }
  if (near.a < 0 || near.distance >= margin) return;
  // Close to where the surfaces cross, all triangles are nearer to each other than a small margin:
  // such features tell nothing that the overlap does not.
  if (crossing && margin < kBeside * std::min(pair.a().radius(), pair.b().radius())) return;
  if (nearest_alone) return out.push_back({near.distance, near.pa, near.pb, pair.Normal(near)});
  pair.Features(margin, near, out);
}

// The answer for a primitive and a mesh, in tree units and the mesh's frame. `warm`, a triangle of
// the mesh or -1, is where the search starts, and receives the triangle it finds.
void AskField(const SdfMesh& pair, double margin, ExactQuery query, int& warm,
              std::vector<SignedGap>& out) {
  const bool nearest_alone = query == ExactQuery::kNearest;
  const SdfNearest near = pair.Nearest(std::max(margin, 0.0), warm);
  if (near.triangle >= 0) warm = near.triangle;
  const bool crossing = near.triangle >= 0 && near.f < 0.0;
  if (crossing || pair.Contained()) {
    if (query == ExactQuery::kUnmeasuredFeatures) {
      return out.push_back(Unmeasured(crossing ? pair.Gap(near) : SignedGap()));
    }
    pair.AppendOverlaps(out);
    if (nearest_alone) return;
  }
  if (near.triangle < 0 || near.f >= margin) return;
  if (nearest_alone) return out.push_back(pair.Gap(near));
  pair.Features(margin, near, out);
}

}  // namespace

void ExactContacts::Ask(const PosedModel& posed, int pair, double margin, ExactQuery query,
                        std::vector<SignedGap>& out) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  const int g1 = tables_.pairs[pair].geom1, g2 = tables_.pairs[pair].geom2;
  const Matrix3d R1 = AsMatrix(d.geom_xmat + 9 * g1), R2 = AsMatrix(d.geom_xmat + 9 * g2);
  const Vector3d p1 = AsVector(d.geom_xpos + 3 * g1), p2 = AsVector(d.geom_xpos + 3 * g2);
  const RelativePose second_in_first{R1.transpose() * R2,
                                     tables_.tree_units * (R1.transpose() * (p2 - p1))};
  const double reach = tables_.tree_units * margin;
  const std::size_t begin = out.size();
  const bool both_have_bvhs = tables_.bvhs[g1] != nullptr;
  if (both_have_bvhs) {
    const BvhPair bvhs(*tables_.bvhs[g1], *tables_.bvhs[g2], second_in_first);
    AskBvhs(bvhs, reach, query, rough_, warm_[pair], out);
    box_tests_ += bvhs.box_tests();
  } else {  // geom 2 is the mesh, since MuJoCo orders a pair by geom type
    const PrimitiveSdf field{m.geom_type[g1], tables_.tree_units * AsVector(m.geom_size + 3 * g1)};
    AskField({field, *tables_.bvhs[g2], second_in_first}, reach, query, warm_[pair].b, out);
  }
  const Matrix3d& R = both_have_bvhs ? R1 : R2;
  const Vector3d& origin = both_have_bvhs ? p1 : p2;
  for (std::size_t k = begin; k < out.size(); ++k) {
    out[k].distance /= tables_.tree_units;
    out[k].p1 = origin + R * out[k].p1 / tables_.tree_units;
    out[k].p2 = origin + R * out[k].p2 / tables_.tree_units;
    out[k].n = R * out[k].n;
  }
}

bool ExactContacts::Distance(const PosedModel& posed, int pair, double cutoff, SignedGap& gap) {
  scratch_.clear();
  Ask(posed, pair, cutoff, ExactQuery::kNearest, scratch_);
  if (scratch_.empty() || scratch_.front().distance >= cutoff) return false;
  gap = scratch_.front();
  return true;
}

void ExactContacts::Features(const PosedModel& posed, int pair, double margin, Depths depths,
                             std::vector<SignedGap>& out) {
  const ExactQuery query = depths == Depths::kMeasured   ? ExactQuery::kFeatures
                           : depths == Depths::kSearched ? ExactQuery::kSearchedFeatures
                                                         : ExactQuery::kUnmeasuredFeatures;
  Ask(posed, pair, margin, query, out);
}

}  // namespace mjcf_pdg
