#include "apps/html/checked_row.h"

#include <algorithm>

#include "apps/console/text.h"
#include "apps/html/joint_moves.h"
#include "apps/html/straight_motion.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMotionFrames = 40;  // on the slider, from end to end

Json Facts(const Verdict& verdict) {
  Json facts =
      Json::array({PageFact("smallest distance, mm", 1e3 * verdict.min_distance),
                   PageFact("joint limits exceeded by, rad or m", verdict.limit_excess),
                   PageFact("certified by signed distances", verdict.certified ? "yes" : "no")});
  if (verdict.equality_residual > kEqualityTolerance) {
    facts.push_back(PageFact("equalities violated by, m or rad", verdict.equality_residual));
  }
  if (verdict.tendon_excess > kEqualityTolerance) {
    facts.push_back(PageFact("tendon limits exceeded by, m", verdict.tendon_excess));
  }
  return facts;
}

}  // namespace

PageRow CheckedPageRow(const Scene& scene, double tolerance, const CheckedRow& checked) {
  const Verdict& verdict = checked.verdict;
  const auto overlaps =
      std::count_if(verdict.contacts.begin(), verdict.contacts.end(),
                    [&](const Contact& contact) { return contact.distance < -tolerance; });
  const double depth = verdict.contacts.empty() ? 0.0 : -1e3 * verdict.contacts.front().distance;
  PageRow page;
  page.of = checked.row;
  page.status = verdict.free ? "free" : "not_free";
  page.wrong = !verdict.free;
  page.values = {static_cast<double>(overlaps), std::max(0.0, depth), verdict.limit_excess};
  page.frames = {{checked.row.q, "as given"}};
  page.content = {{"facts", Facts(verdict)},
                  {"reason", verdict.reason},
                  {"contacts_in", PageContacts(scene, verdict.contacts)}};
  return page;
}

PageRow MotionPageRow(const Scene& scene, const Ends& ends, const Motion& motion,
                      const std::string& words) {
  PageRow page;
  page.of.label = "motion";
  page.status = motion.outcome == MotionOutcome::kFree ? "free" : "not_free";
  page.wrong = motion.outcome != MotionOutcome::kFree;
  const auto place = [](double t) { return "t = " + Short(t); };
  page.frames = {{ends.from, "from"}};
  for (int k = 1; k < kMotionFrames; ++k) {
    const double t = static_cast<double>(k) / kMotionFrames;
    if (t < motion.t) page.frames.push_back({OnTheWay(scene, ends.from, ends.to, t), place(t)});
  }
  const bool at_once = motion.outcome == MotionOutcome::kStartInCollision;
  PageTable stop{at_once ? "What overlaps where it starts" : "What ends the motion",
                 {"geom 1", "geom 2"},
                 Json::array(),
                 {},
                 {}};
  if (motion.outcome != MotionOutcome::kFree) {
    page.frames.push_back({motion.q, place(motion.t) + ", where it stops"});
    for (const std::array<int, 2>& pair : motion.pairs) {
      stop.rows.push_back({PageGeomName(scene, pair[0]), PageGeomName(scene, pair[1])});
      stop.frames.push_back(page.frames.size() - 1);
    }
  }
  page.frames.push_back(
      {ends.to, page.wrong ? "to, which is not reached" : "to: free all the way"});
  page.content = {{"facts", Json::array({PageFact("free up to t", motion.t),
                                         PageFact("proven", motion.certified ? "yes" : "no"),
                                         PageFact("poses", motion.poses),
                                         PageFact("distance queries", motion.distance_queries)})},
                  {"joints", PageJoints(scene, Metric::kSequential, page.frames)}};
  if (at_once) page.content["opens"] = 0;
  if (!stop.frames.empty()) {
    page.tables.push_back(stop);
  } else if (page.wrong) {
    page.content["reason"] = words;
  }
  return page;
}

}  // namespace mjcf_pdg::app
