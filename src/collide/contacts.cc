#include "collide/contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "collide/convex/capsule_box.h"
#include "collide/sdf/sdf_contacts.h"
#include "collide/terrain/terrain_contacts.h"

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Witness points nearer to each other than this define no normal [scene's size].
constexpr double kCoincident = 1e-11;

SignedGap CapsuleBoxInWorld(const PosedModel& posed, int capsule, int box) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  const Matrix3d R = AsMatrix(d.geom_xmat + 9 * box);
  const Vector3d origin = AsVector(d.geom_xpos + 3 * box);
  const Vector3d center = R.transpose() * (AsVector(d.geom_xpos + 3 * capsule) - origin);
  const Vector3d axis =
      R.transpose() * AsMatrix(d.geom_xmat + 9 * capsule).col(2) * m.geom_size[3 * capsule + 1];
  SignedGap gap = CapsuleBoxGap(center - axis, center + axis, m.geom_size[3 * capsule],
                                AsVector(m.geom_size + 3 * box));
  gap.p1 = origin + R * gap.p1;
  gap.p2 = origin + R * gap.p2;
  gap.n = R * gap.n;
  return gap;
}

// The signed distance of a plane geom and the bounding sphere of `geom` [m].
double SphereAbovePlane(const mjModel& m, const mjData& d, int plane, int geom) {
  const Vector3d normal = AsMatrix(d.geom_xmat + 9 * plane).col(2);
  return normal.dot(AsVector(d.geom_xpos + 3 * geom) - AsVector(d.geom_xpos + 3 * plane)) -
         m.geom_rbound[geom];
}

NearPair ToNearPair(int pair, const SignedGap& gap, const KeptPair& kept) {
  return {pair, gap.distance, gap.p1, gap.p2, gap.n, kept.kind};
}

}  // namespace

ContactFinder::ContactFinder(const SceneTables& tables, double clearance,
                             std::shared_ptr<mjData> data)
    : tables_(tables),
      model_(tables.query_model),
      posed_(&model_, tables.moving_trees, std::move(data)),
      exact_(tables, clearance),
      terrain_(std::make_unique<TerrainContacts>(tables)),
      sdf_(std::make_unique<SdfContacts>(tables)),
      convex_(tables),
      broad_phase_(tables) {
  near_.reserve(tables.pairs.size());
}

ContactFinder::~ContactFinder() = default;

std::int64_t ContactFinder::distances() const { return distances_ + terrain_->distances(); }

const std::vector<NearPair>& ContactFinder::Find(double margin, Depths depths) {
  ++queries_;
  near_.clear();
  NearPair near;
  for (const int k : broad_phase_.Near(posed_, margin, all_moved_)) {
    const BodyPair& bodies = tables_.body_pairs[k];
    for (int pair = bodies.begin; pair < bodies.end; ++pair) {
      const KeptPair& kept = tables_.pairs[pair];
      // TerrainContacts knows better than by the sphere around a whole field.
      if (kept.kind != PairKind::kTerrain && DistanceBound(pair) > margin) continue;
      if (kept.kind == PairKind::kSdf) continue;  // FindSdfs
      if (kept.kind == PairKind::kConvex) {
        if (Distance(pair, margin, near)) near_.push_back(near);
      } else if (BoundsNear(kept, margin)) {
        AppendFeatures(pair, margin, depths, near_);
      }
    }
  }
  all_moved_ = false;
  if (tables_.has_sdf_pairs) FindSdfs(margin);
  return near_;
}

void ContactFinder::AppendFeatures(int pair, double margin, Depths depths,
                                   std::vector<NearPair>& out) {
  const KeptPair& kept = tables_.pairs[pair];
  features_.clear();
  if (kept.kind == PairKind::kTerrain) {
    terrain_->Features(posed_, pair, margin, features_);
  } else {
    exact_.Features(posed_, pair, margin, depths, features_);
    SignedGap hull;
    if (!features_.empty() && HullGap(pair, features_.front().distance, hull)) {
      std::erase_if(features_, [](const SignedGap& gap) { return gap.distance < 0.0; });
      features_.insert(features_.begin(), hull);
    }
  }
  for (const SignedGap& gap : features_) out.push_back(ToNearPair(pair, gap, kept));
}

double ContactFinder::DistanceBound(int pair) const {
  const mjModel& m = model_;
  const mjData& d = *posed_.data();
  const int g1 = tables_.pairs[pair].geom1, g2 = tables_.pairs[pair].geom2;
  if (m.geom_type[g1] == mjGEOM_PLANE) return SphereAbovePlane(m, d, g1, g2);
  if (m.geom_rbound[g1] <= 0.0 || m.geom_rbound[g2] <= 0.0) return -kInfinity;
  return (AsVector(d.geom_xpos + 3 * g1) - AsVector(d.geom_xpos + 3 * g2)).norm() -
         m.geom_rbound[g1] - m.geom_rbound[g2];
}

// A separating-axis test of the geoms' oriented boxes that tries only the six face normals: it may
// take boxes for near that are not. Most pairs that it is asked about part at one of the first.
bool ContactFinder::BoxesNear(int geom1, int geom2, double margin) const {
  const mjModel& m = model_;
  const mjData& d = *posed_.data();
  const auto R1 = AsMatrix(d.geom_xmat + 9 * geom1), R2 = AsMatrix(d.geom_xmat + 9 * geom2);
  const auto half1 = AsVector(m.geom_aabb + 6 * geom1 + 3);
  const auto half2 = AsVector(m.geom_aabb + 6 * geom2 + 3);
  const Vector3d t = AsVector(d.geom_xpos + 3 * geom2) + R2 * AsVector(m.geom_aabb + 6 * geom2) -
                     AsVector(d.geom_xpos + 3 * geom1) - R1 * AsVector(m.geom_aabb + 6 * geom1);
  Matrix3d overlap;  // |R1ᵀ R2|
  for (int k = 0; k < 3; ++k) {
    overlap.row(k) = (R1.col(k).transpose() * R2).cwiseAbs();
    if (std::abs(R1.col(k).dot(t)) - half1[k] - overlap.row(k).dot(half2) > margin) return false;
  }
  for (int k = 0; k < 3; ++k) {
    if (std::abs(R2.col(k).dot(t)) - half2[k] - overlap.col(k).dot(half1) > margin) return false;
  }
  return true;
}

bool ContactFinder::BoundsNear(const KeptPair& kept, double margin) const {
  // TerrainContacts looks at the ground below the geom first, which is lower than the field's box.
  return model_.geom_type[kept.geom1] == mjGEOM_PLANE || kept.kind == PairKind::kTerrain ||
         BoxesNear(kept.geom1, kept.geom2, margin);
}

bool ContactFinder::Distance(int pair, double cutoff, NearPair& near) {
  const KeptPair& kept = tables_.pairs[pair];
  if (kept.kind == PairKind::kSdf || !BoundsNear(kept, cutoff)) return false;
  SignedGap gap, hull;
  const bool exact = kept.kind == PairKind::kExact;
  const bool found = kept.kind == PairKind::kTerrain ? terrain_->Distance(posed_, pair, cutoff, gap)
                     : exact                         ? exact_.Distance(posed_, pair, cutoff, gap)
                                                     : GeomGap(pair, cutoff, gap);
  if (found && exact && HullGap(pair, gap.distance, hull)) gap = hull;
  if (found) near = ToNearPair(pair, gap, kept);
  return found;
}

// The depth of an exact pair is that of single points (bvh_overlap.h): a translation by it need not
// separate the meshes. A translation by the penetration depth of their hulls does. So the hulls'
// gap makes the better contact row, unless their depth is much larger, as where one mesh reaches
// into a hollow of the other. The hulls' depth cannot truly be smaller than that of the triangles:
// if it is smaller than kShorter times that, it is wrong and not used (mj_geomDistance can tell too
// small a depth of an ellipsoid).
bool ContactFinder::HullGap(int pair, double overlap, SignedGap& gap) {
  constexpr double kShorter = 0.9, kLonger = 2.0;  // shares of the depth that the triangles tell
  if (!(overlap < 0.0) || std::isinf(overlap)) return false;
  if (!GeomGap(pair, 0.0, gap)) return false;
  return gap.distance <= kShorter * overlap && gap.distance >= kLonger * overlap;
}

bool ContactFinder::GeomGap(int pair, double cutoff, SignedGap& gap) {
  ++distances_;
  const int geom1 = tables_.pairs[pair].geom1, geom2 = tables_.pairs[pair].geom2;
  const int type1 = model_.geom_type[geom1], type2 = model_.geom_type[geom2];
  if (type1 == mjGEOM_CAPSULE && type2 == mjGEOM_BOX) {
    gap = CapsuleBoxInWorld(posed_, geom1, geom2);
    return gap.distance < cutoff;
  }
  const ConvexDistance::Answer answer = convex_.Ask(posed_, pair, cutoff, gap);
  if (answer != ConvexDistance::Answer::kUnknown) return answer == ConvexDistance::Answer::kNear;
  mjtNum fromto[6];
  gap.distance = mj_geomDistance(&model_, posed_.data(), geom1, geom2, cutoff, fromto);
  if (gap.distance >= cutoff) return false;
  gap.p1 = AsVector(fromto);
  gap.p2 = AsVector(fromto + 3);
  Vector3d n = (gap.p2 - gap.p1) * (gap.distance > 0.0 ? 1.0 : -1.0);
  if (n.norm() < kCoincident * tables_.size) {
    n = AsVector(posed_.data()->geom_xpos + 3 * geom2) -
        AsVector(posed_.data()->geom_xpos + 3 * geom1);
  }
  gap.n = n.norm() > 0.0 ? Vector3d(n.normalized()) : Vector3d::UnitZ();
  return true;
}

// By the geoms' own functions, and as mj_collision sees them: what is free is free for both.
void ContactFinder::FindSdfs(double margin) {
  model_.opt.enableflags |= mjENBL_OVERRIDE;
  model_.opt.o_margin = margin;
  mj_collision(&model_, posed_.data());
  model_.opt.enableflags &= ~mjENBL_OVERRIDE;
  auto same = [](const KeptPair& p, const mjContact& c) {
    return std::minmax(p.geom1, p.geom2) == std::minmax(c.geom[0], c.geom[1]);
  };
  const mjData& d = *posed_.data();
  for (int pair = 0; pair < static_cast<int>(tables_.pairs.size()); ++pair) {
    const KeptPair& kept = tables_.pairs[pair];
    if (kept.kind != PairKind::kSdf) continue;
    AppendSdfFeatures(pair, margin);
    for (int c = 0; c < d.ncon; ++c) {
      const mjContact& contact = d.contact[c];
      if (!same(kept, contact) || contact.dist >= margin) continue;
      NearPair near;
      near.pair = pair;
      near.kind = kept.kind;
      near.distance = contact.dist;
      near.n_W = AsVector(contact.frame) * (contact.geom[0] == kept.geom1 ? 1.0 : -1.0);
      near.p1_W = AsVector(contact.pos) - 0.5 * contact.dist * near.n_W;
      near.p2_W = AsVector(contact.pos) + 0.5 * contact.dist * near.n_W;
      near_.push_back(near);
    }
  }
}

void ContactFinder::AppendSdfFeatures(int pair, double margin) {
  const KeptPair& kept = tables_.pairs[pair];
  if (DistanceBound(pair) > margin || !BoundsNear(kept, margin)) return;
  features_.clear();
  sdf_->Features(posed_, pair, margin, features_);
  for (const SignedGap& gap : features_) near_.push_back(ToNearPair(pair, gap, kept));
}

}  // namespace mjcf_pdg
