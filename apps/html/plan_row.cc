#include "apps/html/plan_row.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "apps/console/text.h"
#include "apps/html/joint_moves.h"
#include "apps/html/straight_motion.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFrames = 120.0;  // on the slider along a path, besides its configurations

Json Facts(const PlannedPath& planned) {
  const Path& path = planned.path;
  const auto end = [](const Result& result) {
    const std::string words = StatusName(result.status);
    if (result.status != Status::kSolved) return words;
    return "repaired, rms " + Short(1e3 * std::sqrt(result.sigma)) + " mm";
  };
  Json facts = Json::array();
  if (path.found) {
    facts = Json::array({PageFact("length (Σ√σ), mm", 1e3 * path.length),
                         PageFact("configurations", path.q.size()),
                         PageFact("every edge proven free", path.certified ? "yes" : "no")});
  }
  if (!planned.times.empty()) facts.push_back(PageFact("duration, s", planned.times.back()));
  for (const Json& fact :
       {PageFact("start", end(path.start)), PageFact("goal", end(path.goal)),
        PageFact("nodes of the trees", path.nodes), PageFact("samples", path.samples),
        PageFact("collision queries", path.collision_queries)}) {
    facts.push_back(fact);
  }
  return facts;
}

// Appends the way along each edge to the frames, and its proof to the table.
void AddEdges(const Scene& scene, const Path& path, PageTable& edges, PageRow& row) {
  for (std::size_t e = 0; e < path.edges.size(); ++e) {
    const EdgeProof& edge = path.edges[e];
    const std::string name =
        "edge " + std::to_string(e + 1) + " of " + std::to_string(path.edges.size());
    edges.rows.push_back(
        {e + 1, 1e3 * edge.length, edge.certified ? "proven free" : "sampled", edge.poses});
    edges.frames.push_back(row.frames.size());
    const double share = path.length > 0.0 ? edge.length / path.length : 0.0;
    const int steps = 1 + static_cast<int>(share * kFrames);
    for (int k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      row.frames.push_back(
          {OnTheWay(scene, path.q[e], path.q[e + 1], t), name + ", t = " + Short(t)});
    }
  }
}

}  // namespace

PageRow PathPageRow(const Scene& scene, const PlannedPath& planned) {
  const Path& path = planned.path;
  PageRow row;
  row.of = planned.start;
  row.of.label = "path";
  row.status = path.found ? "found" : "not_found";
  row.wrong = !path.found;
  PageTable edges{"Edges of the path", {"edge", "√σ mm", "", "poses"}, Json::array(), {}, {}};
  if (!path.found || path.start.status != Status::kAlreadyFree) {
    row.frames.push_back({planned.start.q, "the start as given"});
  }
  AddEdges(scene, path, edges, row);
  const std::size_t end = row.frames.size();
  if (path.found) row.frames.push_back({path.q.back(), "the end of the path"});
  if (!path.found || path.goal.status != Status::kAlreadyFree) {
    row.frames.push_back({planned.goal.q, "the goal as given"});
  }
  if (path.found) row.tables.push_back(edges);
  row.content = {{"facts", Facts(planned)},
                 {"reason", path.reason},
                 {"contacts_in", PageContacts(scene, path.start.contacts_in)},
                 {"contacts_goal", PageContacts(scene, path.goal.contacts_in)}};
  const bool searched = !path.found && path.samples > 0;
  if (searched) row.content["note"] = "A clock may have ended it, and another run get further.";
  row.content["before"] = "the start";
  // Where there is none, start and goal are all the slider has, and nothing moved between them.
  if (!path.found) return row;
  row.content["opens"] = end;
  row.content["joints"] = PageJoints(scene, Metric::kSequential, row.frames, end);
  return row;
}

}  // namespace mjcf_pdg::app
