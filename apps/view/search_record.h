// A whole solve, iteration by iteration, in a thread of its own so that the window goes on.
#ifndef MJCF_PDG_APPS_VIEW_SEARCH_RECORD_H_
#define MJCF_PDG_APPS_VIEW_SEARCH_RECORD_H_

#include <future>
#include <string>
#include <vector>

#include "apps/input/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

struct SearchStep {
  std::string start;  // of the descent; "answer": the solve's result, the last step
  int descent = 0, step = 0;
  std::vector<double> q;
  double sigma = 0.0;      // [m²]
  double violation = 0.0;  // as in Iteration [m]
  bool free = false;
};

struct SearchRecord {
  Configuration row;              // what was solved
  std::vector<SearchStep> steps;  // never empty: the answer is the last one
  Result result;
};

class Search {
 public:
  // Keeps a reference to the scene.
  Search(const Scene& scene, const Options& options) : scene_(scene), options_(options) {}

  // Solves `row`. Does nothing while a search is running.
  void Begin(const Configuration& row);
  bool running() const { return record_.valid(); }
  // Whether a running search has ended, so that Take does not wait.
  bool done() const;
  // Waits for the running search. Throws what it has thrown.
  SearchRecord Take() { return record_.get(); }

 private:
  const Scene& scene_;
  Options options_;
  std::future<SearchRecord> record_;  // its destructor waits
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEW_SEARCH_RECORD_H_
