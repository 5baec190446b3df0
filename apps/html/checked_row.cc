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

// The pairs or the joint; a click leads to the frame where it stops.
PageTable WhatEnds(const Scene& scene, const Motion& motion, std::size_t stop) {
  const bool limit = motion.outcome == MotionOutcome::kLimit;
  PageTable table{"What ends the motion", {}, Json::array(), {}, {}};
  table.columns = limit ? std::vector<std::string>{"joint", "rad or m, at its limit"}
                        : std::vector<std::string>{"geom 1", "geom 2"};
  if (limit) {
    const int at = scene.model()->jnt_qposadr[motion.joint];
    table.rows.push_back({scene.JointName(motion.joint), motion.q[static_cast<std::size_t>(at)]});
  }
  for (const std::array<int, 2>& pair : motion.pairs) {
    table.rows.push_back({PageGeomName(scene, pair[0]), PageGeomName(scene, pair[1])});
  }
  table.frames.assign(table.rows.size(), stop);
  return table;
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

PageRow MotionPageRow(const Scene& scene, const CheckedMotion& checked) {
  const auto& [ends, motion, contacts] = checked;
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
  if (page.wrong && !at_once) {
    page.frames.push_back({motion.q, place(motion.t) + ", where it stops"});
  }
  const std::size_t stop = page.frames.size() - 1;
  page.frames.push_back(
      {ends.to, page.wrong ? "to, which is not reached" : "to: free all the way"});
  page.content = {{"facts", Json::array({PageFact("free up to t", motion.t),
                                         PageFact("proven", motion.certified ? "yes" : "no"),
                                         PageFact("poses", motion.poses),
                                         PageFact("distance queries", motion.distance_queries)})},
                  {"joints", PageJoints(scene, Metric::kSequential, page.frames,
                                        page.wrong ? stop : page.frames.size() - 1)}};
  if (!page.wrong) return page;
  page.content["opens"] = stop;
  page.content["contacts_stop"] = PageContacts(scene, contacts);
  const PageTable table = WhatEnds(scene, motion, stop);
  if (table.rows.size() > contacts.size()) page.tables.push_back(table);
  return page;
}

}  // namespace mjcf_pdg::app
