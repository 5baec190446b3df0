#include "apps/audit/audit_page.h"

#include <algorithm>
#include <limits>

#include "apps/console/text.h"
#include "apps/html/shell_command.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

PageRow PairRow(const Scene& scene, const AuditedPair& pair, std::size_t samples) {
  PageRow row;
  row.of = pair.where;
  row.of.label = PageGeomName(scene, pair.geom1) + " / " + PageGeomName(scene, pair.geom2);
  row.status = NameOf(pair.kind);
  row.wrong = pair.kind != Overlap::kSometimes;
  row.values = {100.0 * pair.share, -1e3 * pair.deepest.distance, kNone};
  row.frames = {{pair.where.q, "deepest in " + pair.where.label}};
  row.content = {
      {"facts", Json::array({PageFact("overlaps", NameOf(pair.kind)),
                             PageFact("of " + std::to_string(samples) + " random configurations",
                                      pair.count),
                             PageFact("share, %", 100.0 * pair.share),
                             PageFact("deepest seen, mm", -1e3 * pair.deepest.distance),
                             PageFact("deepest in", pair.where.label)})},
      {"contacts_in", PageContacts(scene, {pair.deepest})}};
  return row;
}

PageRow KeyRow(const Scene& scene, const AuditedKey& key) {
  PageRow row;
  row.of = key.of;
  row.status = key.Wrong() ? "keyframe, wrong" : "keyframe, free";
  row.wrong = key.Wrong();
  row.values = {kNone, 1e3 * key.depth, key.force_over_weight};
  row.frames = {{key.of.q, key.of.label}};
  row.content = {
      {"facts",
       Json::array({PageFact("depth, mm", 1e3 * key.depth),
                    PageFact("joint limits exceeded by, rad or m", key.limit_excess),
                    PageFact("equalities violated by, m or rad", key.equality_residual),
                    PageFact("MuJoCo pushes with, times the weight", key.force_over_weight)})},
      {"contacts_in", PageContacts(scene, key.contacts)}};
  return row;
}

// Pairs by class, and those that never overlap.
PageTable Counts(const std::string& model, const Audit& audit) {
  PageTable table{"Pairs of " + model, {"overlap", "pairs"}, Json::array(), {}, {}};
  for (const Overlap kind : {Overlap::kPermanent, Overlap::kDefault, Overlap::kSometimes}) {
    const auto count = std::count_if(audit.pairs.begin(), audit.pairs.end(),
                                     [&](const AuditedPair& pair) { return pair.kind == kind; });
    table.rows.push_back({NameOf(kind), count});
  }
  table.rows.push_back({"never (each in less than " + Short(100.0 * audit.never_share) +
                            " % of all configurations, with 95 % confidence)",
                        audit.never});
  return table;
}

}  // namespace

void AddAudit(const std::string& model, const Scene& scene, const Audit& audit,
              const std::vector<std::string>& options, Page& page) {
  page.BeginModel(model, scene);
  const RowCommand check{{"check", model}, options};
  const auto add = [&](PageRow row) {
    row.content["command"] = check.Of(row.of);
    page.Add(row);
  };
  for (const AuditedPair& pair : audit.pairs) add(PairRow(scene, pair, audit.samples));
  for (const AuditedKey& key : audit.keys) add(KeyRow(scene, key));
  page.AddTable(Counts(model, audit));
  PageTable exclude{
      "MuJoCo leaves these out with <exclude>", {"body 1", "body 2"}, Json::array(), {}, {}};
  for (const auto& [body1, body2] : audit.exclude) exclude.rows.push_back({body1, body2});
  if (!audit.exclude.empty()) page.AddTable(exclude);
  PageTable warnings{"Warnings", {model}, Json::array(), {}, {}};
  for (const std::string& words : audit.warnings) warnings.rows.push_back(Json::array({words}));
  if (!audit.warnings.empty()) page.AddTable(warnings);
}

void AddUnaudited(const std::string& model, const std::string& error, Page& page) {
  page.BeginModel(model);
  PageRow row;
  row.of.label = model;
  row.status = "failed";
  row.wrong = true;
  row.values = {kNone, kNone, kNone};
  row.content["reason"] = error;
  page.Add(row);
}

}  // namespace mjcf_pdg::app
