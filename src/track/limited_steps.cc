// How a TrackerCore whose steps are limited goes where its optimum is: straight, or round what is
// in the way; until a way is known it follows the optimum on its own side.
#include <algorithm>
#include <limits>

#include "track/tracker_core.h"

namespace mjcf_pdg {

namespace tune = tuning::track;
namespace limited = tuning::limited;

// `at` stays free.
void TrackerCore::GoOn() {
  if (detour->planted() && !going) detour->Ends(at, optimum);
  advanced = true;
  if (going && GoAlong()) return;
  if (approach.Ticks(at, optimum) <= limited::kStraight && GoTowards(optimum)) {
    detour->Reset();
    return;
  }
  unslid = std::max(0, unslid - 1);
  if (unslid == 0 && approach.Ticks(at, optimum) <= limited::kSlides) {
    if (SlideTowards(optimum)) return;
    unslid = tune::kBlocked;
  }
  advanced = false;
  GoBeside();
  if (work.norm.Sigma(at) <= work.norm.Sigma(optimum)) {
    optimum = at;
    detour->Reset();
    return;
  }
  if (blocked > 0) return;
  // A way round is taken in steps of max_step; where there is none it would be taken by leaps.
  if (options.max_step < std::numeric_limits<double>::infinity()) return SeekWay();
  optimum = at;
  blocked = tune::kBlocked;
}

// Seeks a way to the optimum, and sets off where that pays.
void TrackerCore::SeekWay() {
  if (!detour->planted()) detour->Ends(at, optimum);
  const double stay = work.norm.Sigma(at);
  if (detour->found()) {
    detour->Shorten(static_cast<int>(Left()));
  } else if (!detour->Search(static_cast<int>(Left()))) {
    const double kept = 1.0 - options.switch_gain;
    if (!detour->EndsNearer(kept * kept * stay)) {
      if (!detour->failed()) return;
      detour->Reset();
      optimum = at;
      blocked = tune::kBlocked;
      return;
    }
  }
  double on_way = 0.0;
  detour->Ticks(on_way);
  const double there = work.norm.Sigma(detour->end());
  going = on_way - stay < limited::kPays * (stay - there);
  switched = switched || going;
}

// The way that was found; what queries are left make it shorter. Returns whether that leads
// anywhere.
bool TrackerCore::GoAlong() {
  detour->EndAt(optimum);
  bool leads = detour->found();
  if (leads) {
    const VectorXd& next = detour->Next(at);
    leads = GoTowards(next) || SlideTowards(next);
  }
  going = leads && at != detour->end();
  if (going) {
    detour->Shorten(static_cast<int>(Left()));
  } else if (leads) {
    detour->Reset();
  } else {
    detour->Blocked();
  }
  return leads;
}

// Follows the optimum on this side, where it stands or where max_step lets it go.
void TrackerCore::GoBeside() {
  if (work.Spent()) return;
  const LocalResult& found = own_side->Follow({at, true, Obstacles(), side_reach});
  const bool cut = found.free && approach.Cut(at, found.q) < 1.0;
  const bool far = found.length > 0.5 * side_reach;
  if (cut || !found.free) {
    side_reach *= 0.5;
  } else if (far) {
    side_reach *= 2.0;
  }
  lags = cut || far;
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
  const double share = approach.Cut(at, target);
  work.Begin(approach.q(), core.mocap, Rest());
  const double enough = (1.0 - limited::kNearer * share) * follower.Apart(at, target);
  candidate = own_side->Follow({at, true, Obstacles(), std::numeric_limits<double>::infinity()}).q;
  work.Begin(command, core.mocap, Rest());
  last_at = at;
  if (GoTowards(candidate) && follower.Apart(at, target) < enough) return true;
  at = last_at;
  return false;
}

}  // namespace mjcf_pdg
