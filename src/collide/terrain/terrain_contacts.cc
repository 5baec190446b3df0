#include "collide/terrain/terrain_contacts.h"

#include <algorithm>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// How far a geom is moved beyond its way out, so that contact normals exist [scene's size], and how
// exactly distances are measured: the angle by which a normal errs is about the square root of
// twice the share [rad].
constexpr double kAside = 1e-4;
constexpr double kMeet = 1e-8, kMeetShare = 1e-7, kLastShare = 1e-4;
// A prism that reaches above the plane of a known contact by no more than this gets no contact of
// its own [margin]: what it adds is seen when steps, and the margin with them, have become short.
// With 0 descents on waves take half as many steps again; with 0.8 a quadruped on noise takes 9 %
// fewer queries, but some boxes on noise end 0.1 mm above it.
constexpr double kAbovePlane = 0.5;

// The way itself as a feature: the geom's farthest point against it.
SignedGap AlongWay(const OnTerrain& on, const Way& way) {
  const Vector3d p2 = on.Support(-way.u) - on.radius() * way.u;
  return {-way.length, p2 + way.length * way.u, p2, way.u};
}

}  // namespace

TerrainContacts::TerrainContacts(const SceneTables& tables) : tables_(tables) {
  for (const KeptPair& pair : tables.pairs) {
    if (pair.kind != PairKind::kTerrain || blocks_.count(pair.geom1)) continue;
    blocks_.emplace(pair.geom1, HighestBlocks(tables.query_model, pair.geom1));
  }
}

// Whether the geom is farther than `margin` above all of the field that is so near in level
// directions. Most geoms of a robot are: three of four on bench/terrain_bench.
bool TerrainContacts::IsAbove(const PosedModel& posed, const KeptPair& pair, double margin) const {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  const Matrix3d R = AsMatrix(d.geom_xmat + 9 * pair.geom1);
  const Vector3d at = R.transpose() * (AsVector(d.geom_xpos + 3 * pair.geom2) -
                                       AsVector(d.geom_xpos + 3 * pair.geom1));
  const double apart = std::max(margin, 0.0);
  const HighestBlocks& blocks = blocks_.at(pair.geom1);
  // Most of those that are above: farther above all of the field, by the sphere around them.
  if (at.z() - m.geom_rbound[pair.geom2] - blocks.highest() > apart) return true;
  const Vector3d up = AsMatrix(d.geom_xmat + 9 * pair.geom2).transpose() * R.col(2);
  const double radius = CoreRadius(m, pair.geom2);
  const Vector3d half = (AsVector(m.geom_aabb + 6 * pair.geom2 + 3).array() - radius).cwiseMax(0.0);
  const double lowest =
      at.z() + up.dot(AsVector(m.geom_aabb + 6 * pair.geom2)) - up.cwiseAbs().dot(half) - radius;
  const Eigen::Vector2d around = Eigen::Vector2d::Constant(m.geom_rbound[pair.geom2] + apart);
  const Eigen::Vector2d level = at.head<2>();
  return lowest - blocks.Above({level - around, level + around}) > apart;
}

void TerrainContacts::Features(const PosedModel& posed, int pair, double margin,
                               std::vector<SignedGap>& out) {
  if (IsAbove(posed, tables_.pairs[pair], margin)) return;
  const OnTerrain on(tables_, posed, tables_.pairs[pair]);
  scratch_.clear();
  if (!AppendApart(on, Vector3d::Zero(), margin, Blocks::kFour)) {
    const Way way = way_out_.Find(on, WayOut::Effort::kRough, near_);
    scratch_.clear();
    AppendApart(on, (way.length + kAside * on.size()) * way.u, margin, Blocks::kFour);
    if (scratch_.empty()) scratch_.push_back(AlongWay(on, way));
  }
  std::sort(scratch_.begin(), scratch_.end(),
            [](const SignedGap& a, const SignedGap& b) { return a.distance < b.distance; });
  for (const SignedGap& gap : scratch_) out.push_back(ToWorld(on, gap));
  distances_ += on.asked();
}

bool TerrainContacts::Distance(const PosedModel& posed, int pair, double cutoff, SignedGap& gap) {
  if (IsAbove(posed, tables_.pairs[pair], cutoff)) return false;
  const OnTerrain on(tables_, posed, tables_.pairs[pair]);
  scratch_.clear();
  const bool apart = AppendApart(on, Vector3d::Zero(), std::max(cutoff, 0.0), Blocks::kOne);
  SignedGap found;
  found.distance = kInfinity;
  if (!apart || (!scratch_.empty() && scratch_.front().distance < 0.0)) {
    found = AlongWay(on, way_out_.Find(on, WayOut::Effort::kShortest, near_));
  } else if (!scratch_.empty()) {
    found = scratch_.front();
  }
  distances_ += on.asked();
  if (!(found.distance < cutoff)) return false;
  gap = ToWorld(on, found);
  return true;
}

// Appends to scratch_ the features of each block of the cells near the geom moved by `shift`, as
// they are without the shift, if they are nearer than `margin` then; of one block only the nearest.
// Returns false if the moved core overlaps the field. near_ are the prisms within the margin.
bool TerrainContacts::AppendApart(const OnTerrain& on, const Vector3d& shift, double margin,
                                  Blocks blocks) {
  const double reach = std::max(margin, 0.0) + kAside * on.size() + on.radius();
  const CellRange cells = on.CellsNear(shift, reach);
  on.CollectPrisms(cells, shift, reach, near_);
  answers_.clear();
  if (near_.empty()) return true;
  // The one that seems to be overlapped most is likely to be, if any is.
  const NearPrism& most = *std::min_element(
      near_.begin(), near_.end(),
      [](const NearPrism& a, const NearPrism& b) { return a.at_least < b.at_least; });
  if (most.at_least < 0.0 && on.CoreOverlaps(most.prism, shift)) return false;
  // A core that is shorter than a cell along a side is not divided along it.
  const int row = (cells.row_begin + cells.row_end) / 2;
  const int col = (cells.col_begin + cells.col_end) / 2;
  const bool by_rows = blocks == Blocks::kFour && on.core_box().sizes().y() > on.dy();
  const bool by_cols = blocks == Blocks::kFour && on.core_box().sizes().x() > on.dx();
  for (Block& block : in_blocks_) block.clear();
  for (NearPrism& near : near_) {
    in_blocks_[2 * (by_rows && near.row >= row) + (by_cols && near.col >= col)].push_back(&near);
  }
  for (Block& block : in_blocks_) {
    if (!AppendBlock(on, shift, margin, reach, blocks == Blocks::kOne, block)) return false;
  }
  return true;
}

// The nearest of the prisms in the block; then, unless only that is wanted, the nearest of those
// that reach above the plane of the first contact; and so on. What is below a plane adds nothing to
// it. In a valley the walls on both sides have contacts; with the nearest one alone, descents would
// go from one to the other and back.
bool TerrainContacts::AppendBlock(const OnTerrain& on, const Vector3d& shift, double margin,
                                  double reach, bool only_nearest, Block& block) {
  const double above = kMeet * on.size() + kAbovePlane * std::max(margin, 0.0);
  planes_.clear();
  while (!block.empty()) {
    int nearest = -1;
    if (!Nearest(on, shift, reach, block, nearest)) return false;
    if (nearest < 0) return true;
    const GjkNearest& found = answers_[nearest];
    const double distance = found.distance - on.radius() - found.n.dot(shift);
    if (distance < margin) {
      const Vector3d p2 = found.corner.p2 - shift - on.radius() * found.n;
      scratch_.push_back({distance, found.corner.p1, p2, found.n});
      if (only_nearest) return true;
    }
    const double level = found.n.dot(found.corner.p1) + above;
    std::erase_if(block, [&](const NearPrism* near) {
      return near->answer == nearest || near->prism.Farthest(found.n) <= level;
    });
  }
  return true;
}

// Which of answers_ is that of the nearest of the prisms in the block; stays -1 if none is within
// reach. The ones with the least bounds are asked first. Returns false if the moved core overlaps
// one.
bool TerrainContacts::Nearest(const OnTerrain& on, const Vector3d& shift, double reach,
                              Block& block, int& nearest) {
  const GjkAccuracy accuracy{
      .gap = kMeet * on.size(), .share = kMeetShare, .zero = on.radius(), .last = kLastShare};
  const double slack = kMeet * on.size();  // a prism that is no nearer than this much is not
  GjkNearest found;
  double measured = reach;  // the least of those that are
  for (;;) {
    NearPrism* next = nullptr;
    double least = reach;
    for (NearPrism* near : block) {
      if (near->answer >= 0) {
        if (near->at_least >= measured) continue;
        measured = near->at_least;
        nearest = near->answer;
      } else if (near->at_least < std::min(least, measured)) {
        Raise(*near);
        if (near->at_least >= least) continue;
        least = near->at_least;
        next = near;
      }
    }
    if (!next || least >= measured - slack) return true;
    const GjkEnding ending = on.Ask(next->prism, shift, reach, accuracy, found);
    if (ending != GjkEnding::kApart && ending != GjkEnding::kBeyond) return false;
    next->answer = static_cast<int>(answers_.size());
    next->at_least = ending == GjkEnding::kApart ? found.distance : reach;
    answers_.push_back(found);
    planes_.push_back({found.n, found.n.dot(on.Support(-found.n) + shift)});
  }
}

// Raises the bound of a prism by the planes that it does not know.
void TerrainContacts::Raise(NearPrism& near) const {
  for (; near.planes < static_cast<int>(planes_.size()); ++near.planes) {
    const Plane& plane = planes_[near.planes];
    near.at_least = std::max(near.at_least, plane.begin - near.prism.Farthest(plane.n));
  }
}

SignedGap TerrainContacts::ToWorld(const OnTerrain& on, const SignedGap& gap) {
  return {gap.distance, on.ToWorld(gap.p1), on.ToWorld(gap.p2), on.DirectionToWorld(gap.n)};
}

}  // namespace mjcf_pdg
