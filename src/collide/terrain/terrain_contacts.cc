#include "collide/terrain/terrain_contacts.h"

#include <algorithm>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The cells near a geom are divided into so many blocks: two along each side.
constexpr int kBlocks = 4;
// How far a geom is moved beyond its way out, so that contact normals exist [scene's size], and how
// exactly distances are measured: the angle by which a normal errs is about the square root of
// twice the share [rad].
constexpr double kAside = 1e-4;
constexpr double kMeet = 1e-8, kMeetShare = 1e-7, kLastShare = 1e-4;

// The way itself as a feature: the geom's farthest point against it.
SignedGap AlongWay(const OnTerrain& on, const Way& way) {
  const Vector3d p2 = on.Support(-way.u) - on.radius() * way.u;
  return {-way.length, p2 + way.length * way.u, p2, way.u};
}

}  // namespace

void TerrainContacts::Features(const PosedModel& posed, int pair, double margin,
                               std::vector<SignedGap>& out) {
  const OnTerrain on(tables_, posed, tables_.pairs[pair]);
  scratch_.clear();
  if (!AppendApart(on, Vector3d::Zero(), margin, kBlocks)) {
    const Way way = way_out_.Find(on, WayOut::Effort::kRough, near_);
    scratch_.clear();
    AppendApart(on, (way.length + kAside * on.size()) * way.u, margin, kBlocks);
    if (scratch_.empty()) scratch_.push_back(AlongWay(on, way));
  }
  std::sort(scratch_.begin(), scratch_.end(),
            [](const SignedGap& a, const SignedGap& b) { return a.distance < b.distance; });
  for (const SignedGap& gap : scratch_) out.push_back(ToWorld(on, gap));
  distances_ += on.asked();
}

bool TerrainContacts::Distance(const PosedModel& posed, int pair, double cutoff, SignedGap& gap) {
  const OnTerrain on(tables_, posed, tables_.pairs[pair]);
  scratch_.clear();
  const bool apart = AppendApart(on, Vector3d::Zero(), std::max(cutoff, 0.0), 1);
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

// Appends to scratch_ the nearest feature of each block to the geom moved by `shift`, as it is
// without the shift, if it is nearer than `margin` then. Returns false if the moved core overlaps
// the field. near_ are the prisms within the margin.
bool TerrainContacts::AppendApart(const OnTerrain& on, const Vector3d& shift, double margin,
                                  int blocks) {
  const double reach = std::max(margin, 0.0) + kAside * on.size() + on.radius();
  const CellRange cells = on.CellsNear(shift, reach);
  on.CollectPrisms(cells, shift, reach, near_);
  if (near_.empty()) return true;
  // The one that seems to be overlapped most is likely to be, if any is.
  const NearPrism& most = *std::min_element(
      near_.begin(), near_.end(),
      [](const NearPrism& a, const NearPrism& b) { return a.at_least < b.at_least; });
  if (most.at_least < 0.0 && on.CoreOverlaps(most.prism, shift)) return false;
  const int row = (cells.row_begin + cells.row_end) / 2;
  const int col = (cells.col_begin + cells.col_end) / 2;
  const auto block_of = [&](const NearPrism& near) {
    return blocks == 1 ? 0 : 2 * (near.row >= row) + (near.col >= col);
  };
  for (int block = 0; block < blocks; ++block) {
    block_.clear();
    for (NearPrism& near : near_) {
      if (block_of(near) == block) block_.push_back(&near);
    }
    GjkNearest found;
    found.distance = reach;
    if (!Nearest(on, shift, found)) return false;
    if (found.distance >= reach) continue;
    const double distance = found.distance - on.radius() - found.n.dot(shift);
    if (distance >= margin) continue;
    const Vector3d p2 = found.corner.p2 - shift - on.radius() * found.n;
    scratch_.push_back({distance, found.corner.p1, p2, found.n});
  }
  return true;
}

// Lowers `best` to the nearest of the prisms in block_, if one is nearer. The ones with the least
// bounds are asked first. Returns false if the moved core overlaps one.
bool TerrainContacts::Nearest(const OnTerrain& on, const Vector3d& shift, GjkNearest& best) {
  const GjkAccuracy accuracy{
      .gap = kMeet * on.size(), .share = kMeetShare, .zero = on.radius(), .last = kLastShare};
  const double slack = kMeet * on.size();  // a prism that is no nearer than this much is not
  const auto nearer = [](const NearPrism* a, const NearPrism* b) {
    return a->at_least < b->at_least;
  };
  GjkNearest found;
  while (!block_.empty()) {
    const auto next = std::min_element(block_.begin(), block_.end(), nearer);
    if ((*next)->at_least >= best.distance - slack) return true;
    const GjkEnding ending = on.Ask((*next)->prism, shift, best.distance, accuracy, found);
    if (ending != GjkEnding::kApart && ending != GjkEnding::kBeyond) return false;
    if (ending == GjkEnding::kApart && found.distance < best.distance) best = found;
    *next = block_.back();
    block_.pop_back();
    // What parts the core from this prism parts it from most of its neighbours, too.
    const double begin = found.n.dot(on.Support(-found.n) + shift);
    std::erase_if(block_, [&](NearPrism* near) {
      near->at_least = std::max(near->at_least, begin - near->prism.Farthest(found.n));
      return near->at_least >= best.distance - slack;
    });
  }
  return true;
}

SignedGap TerrainContacts::ToWorld(const OnTerrain& on, const SignedGap& gap) {
  return {gap.distance, on.ToWorld(gap.p1), on.ToWorld(gap.p2), on.DirectionToWorld(gap.n)};
}

}  // namespace mjcf_pdg
