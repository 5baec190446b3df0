#include "apps/regress/run_case.h"

#include <algorithm>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "apps/console/progress.h"
#include "apps/input/configurations.h"
#include "apps/input/random_configuration.h"
#include "apps/output/report.h"
#include "apps/solve/solve_rows.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {
namespace {

// The rows of one entry of `configurations`, each with the name that golden results know it by.
class NamedRows {
 public:
  NamedRows(const Scene& scene, const Suite& suite, const SuiteRows& rows)
      : scene_(scene), rows_(rows), random_(rows.seed) {
    WhichArguments which;
    if (rows.kind == SuiteRows::Kind::kFile) which.file = (suite.folder / rows.file).string();
    if (rows.kind == SuiteRows::Kind::kKeyframes || rows.kind == SuiteRows::Kind::kFile) {
      source_ = std::make_unique<RowSource>(scene, which);
    }
  }

  // Where that is known.
  std::optional<std::size_t> size() const {
    if (source_) return source_->size();
    return rows_.kind == SuiteRows::Kind::kRandom ? rows_.count : 1;
  }

  bool Next(Configuration& row) {
    if (source_) {
      if (!source_->Next(row)) return false;
      if (rows_.kind == SuiteRows::Kind::kFile) row.label = rows_.file + " row " + Index();
      if (row.key >= 0) row.label = "keyframe " + row.label;
      return true;
    }
    const bool random = rows_.kind == SuiteRows::Kind::kRandom;
    if (next_ == (random ? rows_.count : 1)) return false;
    row = {};
    row.q = random ? RandomConfiguration(scene_, random_) : scene_.DefaultQpos();
    const std::string index = Index();
    row.label = random ? "random seed " + std::to_string(rows_.seed) + " row " + index : "qpos0";
    return true;
  }

 private:
  std::string Index() { return std::to_string(next_++); }

  const Scene& scene_;
  const SuiteRows& rows_;
  Random random_;
  std::unique_ptr<RowSource> source_;
  std::size_t next_ = 0;
};

// What overlaps where nothing did: a server shows this alone.
std::string InTheWay(const Scene& scene, const Configuration& row, Options options) {
  options.mocap_pos = row.mocap_pos;
  options.mocap_quat = row.mocap_quat;
  return Verify(scene, row.q, options).reason;
}

void RunRows(const Suite& suite, const SuiteCase& one, const std::vector<GoldenRow>& golden,
             const CaseRun& how, CaseReport& report) {
  const Scene scene = Scene::FromFile((suite.folder / one.model).string(), one.scene);
  std::unique_ptr<Progress> progress;
  std::map<std::string, GoldenRow> golden_rows;
  for (const GoldenRow& row : golden) golden_rows[row.name] = row;
  const auto tell = [&](const SolvedRow& solved) {
    const Configuration& row = solved.row;
    const Result& result = solved.result;
    RowReport told;
    told.now = {row.label, result.status, result.sigma, result.stats.collision_queries};
    told.reason = result.reason;
    told.seconds = result.stats.seconds;
    const auto before = golden_rows.find(row.label);
    if (before != golden_rows.end()) {
      told.before = before->second;
      report.queries.before += before->second.queries;
      report.queries.now += told.now.queries;
      ++report.queries.rows;
    } else {
      report.new_queries = report.new_queries.value_or(0) + told.now.queries;
    }
    told.change = Compare(suite, one, told.before ? &*told.before : nullptr, told.now);
    if (told.change == Change::kPenetrates) told.reason = InTheWay(scene, row, one.options);
    if (how.look) how.look(scene, solved, told);
    report.rows.push_back(std::move(told));
    if (progress) progress->Step();
  };
  std::set<std::string> names;
  for (const SuiteRows& rows : one.rows) {
    NamedRows named(scene, suite, rows);
    // qpos0 also stands for the keyframes of a model that has none: once is enough.
    const auto next = [&](Configuration& row) {
      do {
        if (!named.Next(row)) return false;
        row.label = Utf8(row.label);
      } while (!names.insert(row.label).second);
      return true;
    };
    progress.reset();  // ends its line before the next one is drawn
    if (how.progress) progress = std::make_unique<Progress>("solving rows", named.size());
    SolveRows(scene, {one.options, how.threads, 0.0, static_cast<bool>(how.look)}, next, tell);
  }
}

}  // namespace

bool CaseReport::Failed() const {
  return !error.empty() || more_queries ||
         std::any_of(rows.begin(), rows.end(),
                     [](const RowReport& row) { return IsRegression(row.change); });
}

CaseReport RunCase(const Suite& suite, const SuiteCase& one, const std::vector<GoldenRow>& golden,
                   const CaseRun& how) {
  CaseReport report;
  report.model = one.model;
  try {
    RunRows(suite, one, golden, how, report);
  } catch (const std::exception& e) {
    report.error = e.what();
    return report;
  }
  std::set<std::string> names;
  for (const RowReport& row : report.rows) names.insert(row.now.name);
  for (const GoldenRow& row : golden) {
    if (!names.contains(row.name)) report.gone.push_back(row);
  }
  report.more_queries = report.queries.Regressed(suite);
  return report;
}

}  // namespace mjcf_pdg::app
