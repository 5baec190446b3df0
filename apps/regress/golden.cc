#include "apps/regress/golden.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
// Queries that a model may take more however few they are: the random starts of one row.
constexpr long long kFewQueries = 50;

Status StatusNamed(const std::string& name) {
  for (const Status status : {Status::kAlreadyFree, Status::kSolved, Status::kUnsolved}) {
    if (name == StatusName(status)) return status;
  }
  throw Error("status '" + name + "' is none of ours");
}

}  // namespace

Golden ReadGolden(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) return {};
  std::ifstream file(path);
  if (!file) throw Error(path + ": cannot be opened");
  Golden golden;
  try {
    const Json json = Json::parse(file);
    if (json.at("version") != kVersion) {
      throw Error("is of version " + json.at("version").dump() + ", this program writes " +
                  std::to_string(kVersion) + " (--update)");
    }
    for (const Json& row : json.at("rows")) {
      golden[row.at("model")].push_back(
          {row.at("row"), StatusNamed(row.at("status")), row.at("sigma"), row.at("queries")});
    }
  } catch (const nlohmann::json::exception& e) {
    throw Error(path + ": " + e.what());
  } catch (const Error& e) {
    throw Error(path + ": " + e.what());
  }
  return golden;
}

std::string FormatGolden(const Suite& suite, const Golden& golden) {
  std::string text;
  for (const SuiteCase& one : suite.cases) {
    const auto found = golden.find(one.model);
    if (found == golden.end()) continue;
    for (const GoldenRow& row : found->second) {
      char sigma[32];
      std::snprintf(sigma, sizeof sigma, "%.9g", row.sigma);
      text += (text.empty() ? "\n" : ",\n");
      text += "{\"model\": " + Json(one.model).dump() + ", \"row\": " + Json(row.name).dump() +
              ", \"status\": \"" + StatusName(row.status) + "\", \"sigma\": " + sigma +
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
