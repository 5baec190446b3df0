// How a TrackerCore whose steps are limited goes where its optimum is: straight, or round what is in
// the way; until a way is known it follows the optimum on its own side.
#include "track/tracker_core.h"

namespace mjcf_pdg {

namespace tune = tuning::track;

namespace {

// A straight way of no more ticks than this is tried without looking ahead.
constexpr double kStraight = 8.0;

}  // namespace

// `at` stays free.
void TrackerCore::GoOn() {
  if (detour->planted()) detour->Ends(at, optimum);
  if (detour->found()) {
    if (GoAlong()) return;
    detour->Reset();
  }
  if (approach.Ticks(at, optimum) <= kStraight && GoTowards(optimum)) {
    detour->Reset();
    return;
  }
  GoBeside();
  if (work.norm.Sigma(at) <= work.norm.Sigma(optimum)) {
    optimum = at;
    detour->Reset();
    return;
  }
  if (blocked > 0) return;
  if (!detour->planted()) detour->Ends(at, optimum);
  if (detour->Search(static_cast<int>(Left()))) {
    switched = true;
  } else if (detour->failed()) {
    detour->Reset();
    optimum = at;
    blocked = tune::kBlocked;
  }
}

// The way that was found; what queries are left make it shorter. Returns whether that leads
// anywhere.
bool TrackerCore::GoAlong() {
  const VectorXd& next = detour->Next(at);
  if (!GoTowards(next) && !SlideTowards(next)) return false;
  if (at == optimum) {
    detour->Reset();
  } else {
    detour->Shorten(static_cast<int>(Left()));
  }
  return true;
}

// Follows the optimum on this side, where it stands or where max_step lets it go.
void TrackerCore::GoBeside() {
  if (work.Spent()) return;
  const LocalResult& found = own_side->Follow({at, true, Obstacles(), side_reach});
  const bool cut = found.free && approach.Cut(at, found.q) < 1.0;
  if (cut || !found.free) {
    side_reach *= 0.5;
  } else if (found.length > 0.5 * side_reach) {
    side_reach *= 2.0;
  }
  if (found.free) GoTowards(found.q);
}

// Returns whether that leads anywhere.
bool TrackerCore::GoTowards(const VectorXd& target) {
  const double share =
      options.certify_motion ? approach.CutToProof(at, target) : approach.Cut(at, target);
  if (share < tune::kLeastShare) return false;
  const bool known = approach.q() == optimum;  // the verifier has called it free
  if (!known && !Free(approach.q())) return false;
  at = approach.q();
  return true;
}

// Where the straight way is blocked: along the obstacle, to what is nearest to the next point of
// the straight way. Returns whether that comes nearer to the target.
bool TrackerCore::SlideTowards(const VectorXd& target) {
  if (work.Spent()) return false;
  approach.Cut(at, target);
  work.Begin(approach.q(), core.mocap, Rest());
  const double before = follower.Apart(at, target);
  candidate = own_side->Follow({at, true, Obstacles(), std::numeric_limits<double>::infinity()}).q;
  work.Begin(command, core.mocap, Rest());
  last_at = at;
  if (GoTowards(candidate) && follower.Apart(at, target) < before) return true;
  at = last_at;
  return false;
}

}  // namespace mjcf_pdg
