#include "apps/output/report.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "apps/console/text.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

// Within this ratio of its lower bound an answer counts as proven.
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

Json RowJson(const RowName& name, const Configuration& row) {
  Json json = {{"index", name.index}};
  if (!name.model.empty()) json["model"] = name.model;
  if (!row.name.empty()) json["name"] = row.name;
  return json;
}

// The cells that name a row.
std::vector<std::string> RowCells(const RowName& name, const Configuration& row) {
  std::vector<std::string> cells = {std::to_string(name.index), row.label};
  if (!name.model.empty()) cells.insert(cells.begin(), name.model);
  return cells;
}

std::vector<std::string> Heading(bool several_models, std::vector<std::string> columns) {
  columns.insert(columns.begin(), {"row", "name"});
  if (several_models) columns.insert(columns.begin(), "model");
  return columns;
}

void Append(std::vector<std::string>& cells, const std::vector<std::string>& more) {
  cells.insert(cells.end(), more.begin(), more.end());
}

std::string GeometryNote(const Scene& scene) {
  return scene.HasExactMeshes() ? " (exact meshes)" : "";
}

std::string Thousandths(double value) { return Short(value * 1e3); }

// Below a picometre there is only noise.
std::string Millimetres(double metres) {
  return Thousandths(std::abs(metres) < 1e-12 ? 0.0 : metres);
}

std::string Depth(double signed_distance) { return Millimetres(std::max(0.0, -signed_distance)); }

// The depth, and what else was wrong with the input.
std::string DepthIn(const Result& result) {
  std::string text = Depth(result.depth_in);
  if (result.status == Status::kAlreadyFree) return text;
  if (result.limit_excess_in > kLimitTolerance) text += " limits";
  if (result.equality_residual_in > kEqualityTolerance) text += " equality";
  if (result.tendon_excess_in > kEqualityTolerance) text += " tendons";
  return text;
}

// How many of the contacts that there were are still there.
std::string Kept(const Result& result) {
  return std::to_string(result.contacts_kept) + "/" + std::to_string(result.contacts_in.size());
}

std::string ReasonLine(const RowName& name, const Configuration& row, const std::string& reason) {
  const std::string model = name.model.empty() ? "" : OneLine(name.model) + " ";
  return model + "row " + std::to_string(name.index) + " (" + OneLine(row.label) +
         "): " + OneLine(reason) + "\n";
}

// The fields that only models with equality constraints have.
bool HoldsEqualities(const Scene& scene) {
  return scene.model()->neq > 0 && !scene.HeldEqualities().empty();
}

std::string Plural(std::size_t n, const std::string& noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

// Only then can MuJoCo push on pairs that are apart.
bool HasMargins(const mjModel& m) {
  const auto positive = [](double margin) { return margin > 0.0; };
  return std::any_of(m.geom_margin, m.geom_margin + m.ngeom, positive) ||
         std::any_of(m.pair_margin, m.pair_margin + m.npair, positive);
}

std::string StillPushes(const RowName& name, const Configuration& row, int pairs) {
  if (pairs == 0) return "";
  return ReasonLine(name, row,
                    "MuJoCo still pushes on " + Plural(static_cast<std::size_t>(pairs), "pair") +
                        " within their margin (solve --clearance model keeps them apart)");
}

std::string LeftOut(std::size_t rows) {
  return rows == 0 ? "" : "... and " + std::to_string(rows) + " rows that are not shown\n";
}

}  // namespace

std::string JsonLine(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string Utf8(const std::string& text) { return Json::parse(JsonLine(text)); }

Json GeomJson(const Scene& scene, int geom) {
  const char* name = mj_id2name(scene.model(), mjOBJ_GEOM, geom);
  return name && *name ? Json(name) : Json(geom);
}

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

Json IgnoredJson(const Scene& scene) {
  Json list = Json::array();
  for (const auto& [geom1, geom2] : scene.IgnoredPairs()) {
    list.push_back({GeomJson(scene, geom1), GeomJson(scene, geom2)});
  }
  return list;
}

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

std::string SolveJson(const Scene& scene, const RowName& name, const Configuration& row,
                      const Result& result) {
  Json json = RowJson(name, row);
  json["status"] = StatusName(result.status);
  json["qpos_in"] = row.q;
  json["qpos"] = result.q;
  json["sigma"] = result.sigma;
  json["rms"] = std::sqrt(result.sigma);
  json["sigma_lower_bound"] = result.sigma_lower_bound;
  json["depth_in"] = result.depth_in;
  json["min_distance"] = result.min_distance;
  json["limit_excess_in"] = result.limit_excess_in;
  if (HoldsEqualities(scene)) {
    json["equality_residual_in"] = result.equality_residual_in;
    json["equality_residual"] = result.equality_residual;
  }
  if (scene.HoldsTendonLimits()) {
    json["tendon_excess_in"] = result.tendon_excess_in;
    json["tendon_excess"] = result.tendon_excess;
  }
  json["iterations"] = result.stats.iterations;
  json["collision_queries"] = result.stats.collision_queries;
  json["time_us"] = std::round(result.stats.seconds * 1e9) / 1e3;
  json["start"] = result.start;
  json["contacts_in"] = ContactsJson(scene, result.contacts_in);
  json["contacts"] = ContactsJson(scene, result.contacts);
  json["contacts_kept"] = result.contacts_kept;
  if (HasMargins(*scene.model())) json["pushed_pairs"] = result.pushed_pairs;
  if (!scene.IgnoredPairs().empty()) json["ignored"] = IgnoredJson(scene);
  json["certified"] = result.certified;
  json["geometry"] = GeometryName(scene);
  json["proven"] =
      result.status != Status::kUnsolved && result.sigma <= kProvenRatio * result.sigma_lower_bound;
  if (result.status == Status::kUnsolved) {
    json["reason"] = result.reason;
    json["cause"] = CauseName(result.cause);
  }
  return JsonLine(json);
}

SolveTable::SolveTable(bool several_models)
    : table_(Heading(several_models, {"status", "depth mm", "rms mm", "sigma m^2", "distance mm",
                                      "kept", "start", "time ms"})) {}

void SolveTable::Add(const Scene& scene, const RowName& name, const Configuration& row,
                     const Result& result) {
  Count(result.status);
  geometry_ = GeometryNote(scene);
  const bool unsolved = result.status == Status::kUnsolved;
  const bool shown = rows() <= kRowsShown || (unsolved && shown_unsolved_ < kRowsShown);
  if (!shown) {
    ++left_out_;
    return;
  }
  std::vector<std::string> cells = RowCells(name, row);
  Append(cells, {StatusName(result.status), DepthIn(result), Millimetres(std::sqrt(result.sigma)),
                 Short(result.sigma), Millimetres(result.min_distance), Kept(result), result.start,
                 Thousandths(result.stats.seconds)});
  table_.AddRow(std::move(cells));
  reasons_ += StillPushes(name, row, unsolved ? 0 : result.pushed_pairs);
  if (!unsolved) return;
  ++shown_unsolved_;
  reasons_ += ReasonLine(name, row, result.reason);
}

std::string SolveTable::ToString() const {
  return table_.ToString() + LeftOut(left_out_) + reasons_ + Plural(rows(), "configuration") +
         ": " + std::to_string(count_[static_cast<int>(Status::kAlreadyFree)]) + " already free, " +
         std::to_string(count_[static_cast<int>(Status::kSolved)]) + " solved, " +
         std::to_string(count_[static_cast<int>(Status::kUnsolved)]) + " unsolved" + geometry_ +
         "\n";
}

std::string CheckJson(const Scene& scene, const RowName& name, const Configuration& row,
                      const Verdict& verdict) {
  Json json = RowJson(name, row);
  json["free"] = verdict.free;
  json["qpos"] = row.q;
  json["min_distance"] = verdict.min_distance;
  json["limit_excess"] = verdict.limit_excess;
  if (HoldsEqualities(scene)) json["equality_residual"] = verdict.equality_residual;
  if (scene.HoldsTendonLimits()) json["tendon_excess"] = verdict.tendon_excess;
  json["contacts"] = ContactsJson(scene, verdict.contacts);
  if (HasMargins(*scene.model())) json["pushed_pairs"] = verdict.pushed_pairs;
  if (!scene.IgnoredPairs().empty()) json["ignored"] = IgnoredJson(scene);
  json["certified"] = verdict.certified;
  json["geometry"] = GeometryName(scene);
  if (!verdict.free) json["reason"] = verdict.reason;
  return JsonLine(json);
}

CheckTable::CheckTable(bool several_models, double tolerance)
    : tolerance_(tolerance),
      summary_(Heading(several_models, {"free", "overlaps", "distance mm", "limit excess"})),
      pairs_(Heading(several_models, {"geom 1", "geom 2", "depth mm"})) {}

void CheckTable::Add(const Scene& scene, const RowName& name, const Configuration& row,
                     const Verdict& verdict) {
  ++rows_;
  free_ += verdict.free;
  geometry_ = GeometryNote(scene);
  if (rows_ > kRowsShown && (verdict.free || shown_not_free_ == kRowsShown)) {
    ++left_out_;
    return;
  }
  shown_not_free_ += !verdict.free;
  std::size_t overlaps = 0;
  for (const Contact& contact : verdict.contacts) {
    if (contact.distance >= -tolerance_) continue;
    ++overlaps;
    std::vector<std::string> cells = RowCells(name, row);
    Append(cells, {scene.GeomName(contact.geom[0]), scene.GeomName(contact.geom[1]),
                   Depth(contact.distance)});
    pairs_.AddRow(std::move(cells));
  }
  overlaps_ += overlaps;
  std::vector<std::string> cells = RowCells(name, row);
  Append(cells, {verdict.free ? "yes" : "no", std::to_string(overlaps),
                 Millimetres(verdict.min_distance), Short(verdict.limit_excess)});
  summary_.AddRow(std::move(cells));
  reasons_ += StillPushes(name, row, verdict.free ? verdict.pushed_pairs : 0);
  // Overlaps are in the table of pairs already; the reason names joints and tendons.
  const bool outside = verdict.limit_excess > 0.0 || verdict.tendon_excess > kEqualityTolerance;
  if (verdict.free || (overlaps > 0 && !outside)) return;
  reasons_ += ReasonLine(name, row, verdict.reason);
}

std::string CheckTable::ToString() const {
  std::string text = summary_.ToString() + LeftOut(left_out_);
  if (overlaps_ > 0) text += "\n" + pairs_.ToString();
  if (!reasons_.empty()) text += "\n" + reasons_;
  return text + "\n" + Plural(rows_, "configuration") + ": " + std::to_string(free_) + " free, " +
         std::to_string(rows_ - free_) + " not free" + geometry_ + "\n";
}

}  // namespace mjcf_pdg::app
