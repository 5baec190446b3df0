// What `regress` found, as a report.
#ifndef MJCF_PDG_APPS_REGRESS_REGRESS_PAGE_H_
#define MJCF_PDG_APPS_REGRESS_REGRESS_PAGE_H_

#include <nlohmann/json.hpp>
#include <string>

#include "apps/html/page.h"
#include "apps/regress/run_case.h"
#include "apps/regress/suite.h"

namespace mjcf_pdg::app {

struct RegressPageHead {
  std::string again;                 // a command that runs all suites again
  std::string note;                  // what is to be known of it, in words
  std::vector<std::string> plugins;  // of the command line, that `solve` and `norm` need as well
  bool several_suites = false;       // models are then told apart by their suites
};

// Collects rows as they are solved, case by case.
class RegressPage {
 public:
  explicit RegressPage(RegressPageHead head);

  // The rows that follow are of this case.
  void Begin(const Suite& suite, const SuiteCase& one);
  void Add(const Scene& scene, const SolvedRow& solved, const RowReport& report);
  // Removes the rows of the present case.
  void DropRows();
  // What is known when the rows of a model are solved, or why they are not; also of a model that
  // the golden results alone have.
  void End(const Suite& suite, const CaseReport& report);
  std::string ToString();

 private:
  // The model, with its suite where there are several.
  std::string ShownName() const;
  std::vector<std::string> CommandOptions(bool of_norm) const;
  void AddUnsolved(const PageRow& row);

  RegressPageHead head_;
  Page page_;
  PageTable models_{
      "Queries of each model", {"model", "golden", "now", "of new rows", ""}, {}, {}, {}};
  std::string suite_;  // the file of the present one
  std::string name_;   // of the present model
  Options options_;    // of the present case
  nlohmann::ordered_json given_;
  bool begun_ = false;   // the present model is on the page
  Page::Place place_{};  // where the present case began
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REGRESS_REGRESS_PAGE_H_
