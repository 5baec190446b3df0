#include "apps/regress/regress_page.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/html/shell_command.h"
#include "apps/html/solved_row.h"
#include "apps/options.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double Rms(const GoldenRow& row) { return 1e3 * std::sqrt(row.sigma); }

// Status, √σ and queries: golden, which there must be, and now; `again` is the command that
// compares.
PageTable Compared(const RowReport& report, const std::string& again) {
  PageTable table{"Against the golden result", {"", "golden", "now"}, Json::array(), {}, again};
  const GoldenRow &before = *report.before, &now = report.now;
  table.rows = {{"status", StatusName(before.status), StatusName(now.status)},
                {"σ, m²", before.sigma, now.sigma},
                {"√σ, mm", Rms(before), Rms(now)},
                {"collision queries", before.queries, now.queries}};
  return table;
}

// Suites do not ask for contacts, which take queries: they are looked for here.
SolvedRow WithContacts(const Scene& scene, Options options, SolvedRow solved) {
  options.mocap_pos = solved.row.mocap_pos;
  options.mocap_quat = solved.row.mocap_quat;
  const std::vector<double>& q_in = solved.row.q;
  Verdict given = Verify(scene, q_in, options, &q_in);
  Verdict found = Verify(scene, solved.result.q, options, &q_in);
  solved.result.depth_in = given.min_distance;
  solved.result.limit_excess_in = given.limit_excess;
  solved.result.equality_residual_in = given.equality_residual;
  solved.result.tendon_excess_in = given.tendon_excess;
  solved.result.min_distance = found.min_distance;
  solved.result.contacts_in = std::move(given.contacts);
  solved.result.contacts = std::move(found.contacts);
  return solved;
}

// A value of a suite's option as the command line has it: ["A", "B", DEPTH] is A,B=DEPTH.
std::string OptionValue(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& part : value) {
    text += (text.empty() ? "" : part.is_number() ? "=" : ",") + OptionValue(part);
  }
  return text;
}

// Options of a suite as words of a command line; of `norm`: those that it takes, too.
std::vector<std::string> OptionWords(const Json& given, bool of_norm) {
  std::vector<std::string> words;
  for (const auto& [member, value] : given.items()) {
    std::string name = "--" + member;
    std::replace(name.begin(), name.end(), '_', '-');
    if (value == false || (of_norm && !IsNormOption(name))) continue;
    if (value == true) words.push_back(name);
    if (value.is_boolean()) continue;
    const Json values = value.is_array() ? value : Json::array({value});
    for (const Json& one : values) words.insert(words.end(), {name, OptionValue(one)});
  }
  return words;
}

PageTable SuiteOptions(const Json& given) {
  PageTable table{"Options of the suite", {"option", "value"}, Json::array(), {}, {}};
  for (const auto& [member, value] : given.items()) table.rows.push_back({member, value.dump()});
  return table;
}

}  // namespace

RegressPage::RegressPage(RegressPageHead head)
    : head_(std::move(head)),
      page_({head_.again,
             {"depth mm", "golden rms mm", "rms mm", "queries"},
             Json::array(),
             head_.note}) {}

std::string RegressPage::ShownName() const {
  return head_.several_suites ? name_ + " of " + suite_ : name_;
}

std::vector<std::string> RegressPage::CommandOptions(bool of_norm) const {
  std::vector<std::string> words = head_.plugins;
  for (const std::string& word : OptionWords(given_, of_norm)) words.push_back(word);
  return words;
}

void RegressPage::Begin(const Suite& suite, const SuiteCase& one) {
  suite_ = suite.path;
  name_ = (suite.folder / one.model).lexically_normal().string();
  options_ = one.options;
  given_ = one.given;
  begun_ = false;
  place_ = page_.Here();
}

void RegressPage::DropRows() {
  page_.GoBack(place_);
  begun_ = false;
}

void RegressPage::Add(const Scene& scene, const SolvedRow& solved, const RowReport& report) {
  if (!begun_) page_.BeginModel(ShownName(), scene);
  begun_ = true;
  const SolvedRow shown = WithContacts(scene, options_, solved);
  PageRow row = SolvedPageRow(scene, options_.metric, shown);
  // Only the table that compares has them: the row's command asks for contacts, which takes more.
  Json& facts = row.content["facts"];
  facts.erase(std::remove_if(facts.begin(), facts.end(),
                             [](const Json& fact) { return fact[0] == kQueriesFact; }),
              facts.end());
  if (report.change != Change::kNone) row.status += std::string(", ") + NameOf(report.change);
  row.wrong = IsRegression(report.change);
  row.values = {std::max(0.0, -1e3 * shown.result.depth_in),
                report.before ? Rms(*report.before) : kNone, Rms(report.now),
                static_cast<double>(report.now.queries)};
  const RowCommand command{{"solve", name_}, CommandOptions(false)};
  row.content["command"] = command.Of(solved.row);
  row.content["trace"] = command.Of(solved.row, "--trace");
  row.content["norm"] = NormCommand(name_, CommandOptions(true));
  if (report.before) row.tables.push_back(Compared(report, head_.again));
  if (!given_.empty()) row.tables.push_back(SuiteOptions(given_));
  page_.Add(row);
}

void RegressPage::AddUnsolved(const PageRow& row) {
  if (!begun_) page_.BeginModel(ShownName());
  begun_ = true;
  page_.Add(row);
}

void RegressPage::End(const Suite& suite, const CaseReport& report) {
  if (report.rows.empty()) {  // maybe never begun
    suite_ = suite.path;
    name_ = (suite.folder / report.model).lexically_normal().string();
    begun_ = false;
  }
  PageRow row;
  for (const GoldenRow& gone : report.gone) {
    row.of.label = gone.name;
    row.status = NameOf(Change::kGone);
    row.values = {kNone, Rms(gone), kNone, kNone};
    AddUnsolved(row);
  }
  if (!report.error.empty()) {
    row.of.label = report.model;
    row.status = "failed";
    row.wrong = true;
    row.values = {kNone, kNone, kNone, kNone};
    row.content["reason"] = report.error;
    AddUnsolved(row);
  }
  const char* words = !report.error.empty() ? "failed" : report.more_queries ? "more" : "";
  const bool compared = report.queries.rows > 0, added = report.new_queries.has_value();
  models_.rows.push_back({ShownName(), compared ? Json(report.queries.before) : Json("-"),
                          compared ? Json(report.queries.now) : Json("-"),
                          added ? Json(*report.new_queries) : Json("-"), words});
}

std::string RegressPage::ToString() {
  page_.AddTable(models_);
  return page_.ToString();
}

}  // namespace mjcf_pdg::app
