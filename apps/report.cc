#include "apps/report.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "apps/text.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

const char* StatusName(Status status) {
  switch (status) {
    case Status::kAlreadyFree:
      return "already_free";
    case Status::kSolved:
      return "solved";
    case Status::kUnsolved:
      break;
  }
  return "unsolved";
}

// An answer counts as proven to be the nearest if its σ is at most this multiple of the lower
// bound.
constexpr double kProvenRatio = 1.01;

const char* CauseName(Cause cause) {
  switch (cause) {
    case Cause::kBudget:
      return "budget";
    case Cause::kPermanent:
      return "permanent";
    case Cause::kFrozen:
      return "frozen";
    case Cause::kEquality:
      return "equality";
    case Cause::kNotVerified:
      return "not_verified";
    case Cause::kNotFound:
    case Cause::kNone:
      break;
  }
  return "not_found";
}

// The JSON name of what meshes collide as.
const char* GeometryName(const Scene& scene) { return scene.HasExactMeshes() ? "exact" : "hull"; }

Json ContactsJson(const Scene& scene, const std::vector<Contact>& contacts) {
  Json list = Json::array();
  for (const Contact& contact : contacts) {
    list.push_back({{"geom1", GeomJson(scene, contact.geom[0])},
                    {"geom2", GeomJson(scene, contact.geom[1])},
                    {"normal", contact.normal_W},
                    {"position", contact.position_W},
                    {"distance", contact.distance}});
  }
  return list;
}

Json RowJson(std::size_t index, const Configuration& row) {
  Json json = {{"index", index}};
  if (!row.name.empty()) json["name"] = row.name;
  return json;
}

Json ResultJson(const Scene& scene, std::size_t index, const Configuration& row,
                const Result& result) {
  Json json = RowJson(index, row);
  json["status"] = StatusName(result.status);
  json["qpos_in"] = row.q;
  json["qpos"] = result.q;
  json["sigma"] = result.sigma;
  json["rms"] = std::sqrt(result.sigma);
  json["sigma_lower_bound"] = result.sigma_lower_bound;
  json["depth_in"] = result.depth_in;
  json["min_distance"] = result.min_distance;
  json["iterations"] = result.stats.iterations;
  json["collision_queries"] = result.stats.collision_queries;
  json["time_us"] = std::round(result.stats.seconds * 1e9) / 1e3;
  json["start"] = result.start;
  json["contacts_in"] = ContactsJson(scene, result.contacts_in);
  json["contacts"] = ContactsJson(scene, result.contacts);
  json["certified"] = result.certified;
  json["geometry"] = GeometryName(scene);
  json["proven"] =
      result.status != Status::kUnsolved && result.sigma <= kProvenRatio * result.sigma_lower_bound;
  if (result.status == Status::kUnsolved) {
    json["reason"] = result.reason;
    json["cause"] = CauseName(result.cause);
  }
  return json;
}

std::string GeometryNote(const Scene& scene) {
  return scene.HasExactMeshes() ? " (exact meshes)" : "";
}

std::string Thousandths(double value) { return Short(value * 1e3); }

// A length in mm; lengths below a picometre are noise and shown as 0.
std::string Millimetres(double metres) {
  return Thousandths(std::abs(metres) < 1e-12 ? 0.0 : metres);
}

std::string Depth(double signed_distance) { return Millimetres(std::max(0.0, -signed_distance)); }

std::string DepthIn(const Result& result) {
  const bool limits = result.status != Status::kAlreadyFree && result.limit_excess_in > 1e-6;
  return Depth(result.depth_in) + (limits ? " limits" : "");
}

std::string ReasonLine(std::size_t index, const Configuration& row, const std::string& reason) {
  return "row " + std::to_string(index) + " (" + OneLine(row.label) + "): " + OneLine(reason) +
         "\n";
}

std::string Plural(std::size_t n, const std::string& noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

}  // namespace

std::string JsonLine(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json GeomJson(const Scene& scene, int geom) {
  const char* name = mj_id2name(scene.model(), mjOBJ_GEOM, geom);
  return name && *name ? Json(name) : Json(geom);
}

std::string SolveJson(const Scene& scene, const std::vector<Configuration>& rows,
                      const std::vector<Result>& results) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += JsonLine(ResultJson(scene, i, rows[i], results[i]));
  }
  return text;
}

std::string SolveTable(const Scene& scene, const std::vector<Configuration>& rows,
                       const std::vector<Result>& results) {
  Table table({"row", "name", "status", "depth mm", "rms mm", "sigma m^2", "distance mm", "start",
               "time ms"});
  std::size_t count[3] = {};
  std::string reasons;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Result& result = results[i];
    ++count[static_cast<int>(result.status)];
    table.AddRow({std::to_string(i), rows[i].label, StatusName(result.status), DepthIn(result),
                  Millimetres(std::sqrt(result.sigma)), Short(result.sigma),
                  Millimetres(result.min_distance), result.start,
                  Thousandths(result.stats.seconds)});
    if (result.status != Status::kUnsolved) continue;
    reasons += ReasonLine(i, rows[i], result.reason);
  }
  return table.ToString() + reasons + Plural(rows.size(), "configuration") + ": " +
         std::to_string(count[static_cast<int>(Status::kAlreadyFree)]) + " already free, " +
         std::to_string(count[static_cast<int>(Status::kSolved)]) + " solved, " +
         std::to_string(count[static_cast<int>(Status::kUnsolved)]) + " unsolved" +
         GeometryNote(scene) + "\n";
}

std::string CheckJson(const Scene& scene, const std::vector<Configuration>& rows,
                      const std::vector<Verdict>& verdicts) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Verdict& verdict = verdicts[i];
    Json json = RowJson(i, rows[i]);
    json["free"] = verdict.free;
    json["qpos"] = rows[i].q;
    json["min_distance"] = verdict.min_distance;
    json["limit_excess"] = verdict.limit_excess;
    json["contacts"] = ContactsJson(scene, verdict.contacts);
    json["certified"] = verdict.certified;
    json["geometry"] = GeometryName(scene);
    if (!verdict.free) json["reason"] = verdict.reason;
    text += JsonLine(json);
  }
  return text;
}

std::string CheckTable(const Scene& scene, const std::vector<Configuration>& rows,
                       const std::vector<Verdict>& verdicts, double tolerance) {
  Table summary({"row", "name", "free", "overlaps", "distance mm", "limit excess"});
  Table pairs({"row", "name", "geom 1", "geom 2", "depth mm"});
  std::size_t free_rows = 0, all_overlaps = 0;
  std::string reasons;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Verdict& verdict = verdicts[i];
    const std::string row = std::to_string(i);
    std::size_t overlaps = 0;
    for (const Contact& contact : verdict.contacts) {
      if (contact.distance >= -tolerance) continue;
      ++overlaps;
      pairs.AddRow({row, rows[i].label, scene.GeomName(contact.geom[0]),
                    scene.GeomName(contact.geom[1]), Depth(contact.distance)});
    }
    all_overlaps += overlaps;
    free_rows += verdict.free;
    summary.AddRow({row, rows[i].label, verdict.free ? "yes" : "no", std::to_string(overlaps),
                    Millimetres(verdict.min_distance), Short(verdict.limit_excess)});
    // Overlaps are in the table of pairs already; the reason names the joints.
    if (verdict.free || (overlaps > 0 && verdict.limit_excess <= 0.0)) continue;
    reasons += ReasonLine(i, rows[i], verdict.reason);
  }
  std::string text = summary.ToString();
  if (all_overlaps > 0) text += "\n" + pairs.ToString();
  if (!reasons.empty()) text += "\n" + reasons;
  return text + "\n" + Plural(rows.size(), "configuration") + ": " + std::to_string(free_rows) +
         " free, " + std::to_string(rows.size() - free_rows) + " not free" + GeometryNote(scene) +
         "\n";
}

}  // namespace mjcf_pdg::app
