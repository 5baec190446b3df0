#include "apps/regress/golden.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <set>
#include <utility>

#include "apps/output/report.h"
#include "apps/regress/json_place.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr double kMostSigma = 1e300;  // any finite one [m²]
// Queries that a model may take more however few they are: the random starts of one row.
constexpr long long kFewQueries = 50;

std::string SigmaText(double sigma) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", sigma);
  return text;
}

GoldenRow ReadRow(const JsonPlace& place, std::string& model) {
  GoldenRow row;
  int members = 0;
  const auto queries = [&](const JsonPlace& p) {
    row.queries = static_cast<int>(p.Whole(0, std::numeric_limits<int>::max()));
  };
  const auto status = [&](const JsonPlace& p) {
    row.status = p.Choice<Status>({{"already_free", Status::kAlreadyFree},
                                   {"solved", Status::kSolved},
                                   {"unsolved", Status::kUnsolved}});
  };
  place.Members({
      {"model", [&](const JsonPlace& p) { model = p.Text(), ++members; }},
      {"row", [&](const JsonPlace& p) { row.name = p.Text(), ++members; }},
      {"status", [&](const JsonPlace& p) { status(p), ++members; }},
      {"sigma", [&](const JsonPlace& p) { row.sigma = p.Number(0.0, kMostSigma), ++members; }},
      {"queries", [&](const JsonPlace& p) { queries(p), ++members; }},
  });
  if (members != 5) place.Refuse("needs model, row, status, sigma and queries");
  return row;
}

}  // namespace

Golden ReadGolden(const std::string& path) {
  std::error_code ec;
  if (!fs::exists(fs::symlink_status(path, ec))) return {};
  const Json json = ReadJsonFile(path);
  const JsonPlace file{json, path};
  if (json.is_object() && json.contains("version") && json["version"] != kVersion) {
    file.Refuse("is of version " + json["version"].dump() + ", this program knows " +
                std::to_string(kVersion) + " (remove the file, and --update makes it anew)");
  }
  Golden golden;
  bool whole = false;
  std::set<std::pair<std::string, std::string>> names;
  const auto read_rows = [&](const JsonPlace& rows) {
    whole = true;
    if (rows.value == Json::array()) return;  // no model could be run
    for (const JsonPlace& place : rows.List()) {
      std::string model;
      GoldenRow row = ReadRow(place, model);
      if (!names.emplace(model, row.name).second) place.Refuse("is of a row that has one already");
      golden[model].push_back(std::move(row));
    }
  };
  file.Members({{"version", [](const JsonPlace&) {}}, {"rows", read_rows}});
  if (!whole || !json.contains("version")) file.Refuse("needs version and rows");
  return golden;
}

GoldenRow Kept(GoldenRow row) {
  row.sigma = std::strtod(SigmaText(row.sigma).c_str(), nullptr);
  return row;
}

std::string FormatGolden(const Suite& suite, const Golden& golden) {
  std::string text;
  for (const SuiteCase& one : suite.cases) {
    const auto found = golden.find(one.model);
    if (found == golden.end()) continue;
    for (const GoldenRow& row : found->second) {
      text += (text.empty() ? "\n" : ",\n");
      text += "{\"model\": " + Json(one.model).dump() + ", \"row\": " + Json(row.name).dump() +
              ", \"status\": \"" + StatusName(row.status) +
              "\", \"sigma\": " + SigmaText(row.sigma) +
              ", \"queries\": " + std::to_string(row.queries) + "}";
    }
  }
  return "{\"version\": " + std::to_string(kVersion) + ", \"rows\": [" + text + "\n]}\n";
}

const char* NameOf(Change change) {
  switch (change) {
    case Change::kNone:
      return "same";
    case Change::kNew:
      return "new";
    case Change::kGone:
      return "gone";
    case Change::kPenetrates:
      return "penetrates";
    case Change::kLost:
      return "lost";
    case Change::kSigmaUp:
      return "sigma_up";
    case Change::kSigmaDown:
      return "sigma_down";
    case Change::kFixed:
      return "fixed";
  }
  return "";
}

bool IsRegression(Change change) {
  return change == Change::kPenetrates || change == Change::kLost || change == Change::kSigmaUp;
}

Change Compare(const Suite& suite, const SuiteCase& of, const GoldenRow* before,
               const GoldenRow& now) {
  if (!before) return Change::kNew;
  if (before->status != now.status) {
    if (now.status == Status::kUnsolved) return Change::kLost;
    if (before->status == Status::kAlreadyFree) return Change::kPenetrates;
    return Change::kFixed;
  }
  // An answer may lie anywhere within the tolerance, which is much of a tiny σ.
  const double moved = std::sqrt(now.sigma) - std::sqrt(before->sigma);
  if (now.status != Status::kSolved || std::abs(moved) <= of.options.tolerance) {
    return Change::kNone;
  }
  if (now.sigma > (1.0 + suite.sigma_tolerance) * before->sigma) return Change::kSigmaUp;
  if (before->sigma > (1.0 + suite.sigma_tolerance) * now.sigma) return Change::kSigmaDown;
  return Change::kNone;
}

bool Queries::Regressed(const Suite& suite) const {
  const double allowed = (1.0 + suite.queries_tolerance) * static_cast<double>(before);
  return now > before + kFewQueries && static_cast<double>(now) > allowed;
}

}  // namespace mjcf_pdg::app
