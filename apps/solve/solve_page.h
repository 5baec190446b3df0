// What `solve` found, as a report.
#ifndef MJCF_PDG_APPS_SOLVE_SOLVE_PAGE_H_
#define MJCF_PDG_APPS_SOLVE_SOLVE_PAGE_H_

#include <string>
#include <vector>

#include "apps/html/page.h"
#include "apps/html/solved_row.h"
#include "apps/options.h"
#include "apps/solve/solve_arguments.h"

namespace mjcf_pdg::app {

// Collects rows as they are solved, model by model.
class SolvePage {
 public:
  // Keeps a reference to the arguments.
  SolvePage(const CLI::App& command, const SolveArguments& arguments);

  // The rows that follow are of this model.
  void Begin(const std::string& model, const Scene& scene);
  void Add(const Scene& scene, const SolvedRow& solved);
  // Of a trajectory all frames follow as one motion.
  void End();
  std::string ToString() const { return page_.ToString(); }

 private:
  std::string AllRowsCommand() const;
  std::string InputNote() const;
  std::string ClockNote() const;

  const SolveArguments& arguments_;
  const std::vector<std::string> given_, given_norm_;
  Page page_;
  std::string model_;
  std::vector<PageFrame> motion_;      // the answers of a trajectory
  std::vector<std::size_t> unsolved_;  // of them
  std::vector<double> motion_values_;  // of the list: the largest of its frames
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_SOLVE_PAGE_H_
