#include "apps/view/search_record.h"

#include <chrono>
#include <utility>

namespace mjcf_pdg::app {
namespace {

SearchRecord Record(const Scene& scene, Options options, Configuration row) {
  SearchRecord record;
  options.report_contacts = true;
  options.mocap_pos = row.mocap_pos;
  options.mocap_quat = row.mocap_quat;
  Solver solver(scene, options);
  solver.SetObserver([&record](const Iteration& at) {
    record.steps.push_back({at.start,
                            at.descent,
                            at.step,
                            {at.q.begin(), at.q.end()},
                            at.sigma,
                            at.violation,
                            at.free});
  });
  record.result = solver.Solve(std::span<const double>(row.q));
  SearchStep answer;
  answer.start = "answer";
  answer.q = record.result.q;
  answer.sigma = record.result.sigma;
  answer.free = record.result.status != Status::kUnsolved;
  record.steps.push_back(std::move(answer));
  record.row = std::move(row);
  return record;
}

}  // namespace

void Search::Begin(const Configuration& row) {
  if (running()) return;
  record_ = std::async(std::launch::async, Record, std::cref(scene_), options_, row);
}

bool Search::done() const {
  return running() && record_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace mjcf_pdg::app
