// The report of `solve --html`: one file that opens in any browser and loads nothing.
#ifndef MJCF_PDG_APPS_HTML_SOLVE_PAGE_H_
#define MJCF_PDG_APPS_HTML_SOLVE_PAGE_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/solve/solve_rows.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// The rows of one model. Each is packed by itself as it comes, and unpacked when it is looked at.
class SolvePage {
 public:
  // `options`: GivenOptions of the command line, to show how a row is made again.
  SolvePage(const Scene& scene, Metric metric, std::string model, std::vector<std::string> options);

  void Add(const SolvedRow& solved);
  std::string ToString() const;

 private:
  std::string Command(const Configuration& row) const;
  nlohmann::ordered_json Joints(const std::vector<double>& q_in,
                                const std::vector<double>& q) const;
  nlohmann::ordered_json Frames(const SolvedRow& solved, std::vector<float>& poses) const;

  const Scene scene_;
  const Metric metric_;
  const std::string model_;
  const std::vector<std::string> options_;
  const std::shared_ptr<mjData> data_;
  nlohmann::ordered_json rows_ = nlohmann::ordered_json::array();
  std::string blocks_;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_SOLVE_PAGE_H_
