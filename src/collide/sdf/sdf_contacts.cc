#include "collide/sdf/sdf_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

// Corners along the longest side of the box, and the most starts from them and features of a pair.
constexpr int kCorners = 9;
constexpr std::size_t kMostStarts = 8, kMostFeatures = 8;
// Steepest slope that a start is allowed for: MuJoCo's own plugins have up to 2 (nuts).
constexpr double kSteepest = 2.0;
// A descent: steps, and the trust radius at which it ends [size of the box].
constexpr int kSteps = 60;
constexpr double kLeastRadius = 1e-8;
// Normals count as parallel or opposite if their difference or sum is shorter.
constexpr double kParallel = 1e-9;

// The axis-aligned box of a geom in the world; of a plane everything.
Eigen::AlignedBox3d BoxOf(const PosedModel& posed, int geom) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  if (m.geom_type[geom] == mjGEOM_PLANE) {
    const Vector3d everything = Vector3d::Constant(mjMAXVAL);
    return {-everything, everything};
  }
  const Matrix3d R = AsMatrix(d.geom_xmat + 9 * geom);
  const Vector3d center = AsVector(d.geom_xpos + 3 * geom) + R * AsVector(m.geom_aabb + 6 * geom);
  const Vector3d half = R.cwiseAbs() * AsVector(m.geom_aabb + 6 * geom + 3);
  return {center - half, center + half};
}

struct Values {
  double f1, f2;
  double Larger() const { return std::max(f1, f2); }
};

// A step that makes both equal, as they are linearized, and goes by `radius` down the valley where
// they are: along n1 + n2, which is normal to n1 - n2.
Vector3d Step(const Values& at, const Vector3d& n1, const Vector3d& n2, double radius) {
  const Vector3d across = n1 - n2, along = n1 + n2;
  const double steep = across.norm(), falls = along.norm();
  Vector3d step = Vector3d::Zero();
  if (steep > kParallel) {
    step -= std::clamp((at.f1 - at.f2) / steep, -radius, radius) / steep * across;
  }
  if (falls > kParallel) step -= radius / falls * along;
  return step;
}

// From x down to a minimum of the larger of the two.
SignedGap Descend(const PosedField& field1, const PosedField& field2, Vector3d x, double size) {
  const auto values = [&](const Vector3d& at) { return Values{field1.At(at), field2.At(at)}; };
  Values now = values(x);
  Vector3d n1 = field1.Normal(x), n2 = field2.Normal(x);
  double radius = size / kCorners;
  for (int step = 0; step < kSteps && radius > kLeastRadius * size; ++step) {
    const Vector3d to = x + Step(now, n1, n2, radius);
    const Values there = values(to);
    if (there.Larger() < now.Larger()) {
      x = to;
      now = there;
      n1 = field1.Normal(x);
      n2 = field2.Normal(x);
      radius *= 1.5;
    } else {
      radius *= 0.4;
    }
  }
  Vector3d n = n1 - n2;
  if (!(n.norm() > 1e-9)) n = n1;
  n.normalize();
  return {now.f1 + now.f2, x - now.f1 * n, x + now.f2 * n, n};
}

}  // namespace

void SdfContacts::Features(const PosedModel& posed, int pair, double margin,
                           std::vector<SignedGap>& out) {
  const KeptPair& kept = tables_.pairs[pair];
  const double around = 0.5 * std::max(margin, 0.0);
  Eigen::AlignedBox3d box = BoxOf(posed, kept.geom1);
  box = box.intersection(BoxOf(posed, kept.geom2));
  box.min().array() -= around;
  box.max().array() += around;
  if (box.isEmpty()) return;
  const PosedField field1(posed, kept.geom1), field2(posed, kept.geom2);
  const double size = box.sizes().maxCoeff();
  Grid grid;
  grid.low = box.min();
  for (int axis = 0; axis < 3; ++axis) {
    const double share = box.sizes()[axis] / size;
    grid.corners[axis] = std::clamp(static_cast<int>(std::ceil(share * kCorners)), 3, kCorners);
    grid.cell[axis] = box.sizes()[axis] / (grid.corners[axis] - 1);
  }
  values_.resize(grid.Index(grid.corners[0] - 1, grid.corners[1] - 1, grid.corners[2] - 1) + 1);
  for (int i = 0; i < grid.corners[0]; ++i) {
    for (int j = 0; j < grid.corners[1]; ++j) {
      for (int k = 0; k < grid.corners[2]; ++k) {
        const Vector3d x = grid.Corner(i, j, k);
        values_[grid.Index(i, j, k)] = std::max(field1.At(x), field2.At(x));
      }
    }
  }
  FindStarts(grid, around + 0.5 * kSteepest * grid.cell.norm());
  found_.clear();
  for (const Start& start : starts_) {
    const SignedGap gap = Descend(field1, field2, start.x_W, size);
    const auto same = [&](const SignedGap& other) {
      return (other.p1 - gap.p1).norm() < 0.25 * grid.cell.norm();
    };
    if (!(gap.distance < margin)) continue;
    const auto known = std::find_if(found_.begin(), found_.end(), same);
    if (known == found_.end()) {
      found_.push_back(gap);
    } else if (gap.distance < known->distance) {
      *known = gap;
    }
  }
  std::sort(found_.begin(), found_.end(),
            [](const SignedGap& a, const SignedGap& b) { return a.distance < b.distance; });
  if (found_.size() > kMostFeatures) found_.resize(kMostFeatures);
  out.insert(out.end(), found_.begin(), found_.end());
}

// The lowest of those corners below the bound that are lower than the corners around them.
void SdfContacts::FindStarts(const Grid& grid, double below) {
  starts_.clear();
  for (int i = 0; i < grid.corners[0]; ++i) {
    for (int j = 0; j < grid.corners[1]; ++j) {
      for (int k = 0; k < grid.corners[2]; ++k) {
        const double value = values_[grid.Index(i, j, k)];
        if (value < below && IsLowest(grid, i, j, k))
          starts_.push_back({value, grid.Corner(i, j, k)});
      }
    }
  }
  const auto lower = [](const Start& a, const Start& b) { return a.value < b.value; };
  std::stable_sort(starts_.begin(), starts_.end(), lower);
  if (starts_.size() > kMostStarts) starts_.resize(kMostStarts);
}

bool SdfContacts::IsLowest(const Grid& grid, int i, int j, int k) const {
  const double value = values_[grid.Index(i, j, k)];
  for (int a = std::max(0, i - 1); a <= std::min(i + 1, grid.corners[0] - 1); ++a) {
    for (int b = std::max(0, j - 1); b <= std::min(j + 1, grid.corners[1] - 1); ++b) {
      for (int c = std::max(0, k - 1); c <= std::min(k + 1, grid.corners[2] - 1); ++c) {
        if (values_[grid.Index(a, b, c)] < value) return false;
      }
    }
  }
  return true;
}

}  // namespace mjcf_pdg
