#include "gradient.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "base/in_order.h"
#include "library_call.h"
#include "mjcf_pdg/gradient.h"
#include "model.h"
#include "options.h"

namespace mjcf_pdg::python {
namespace {

Status ReadStatus(const std::string& name) {
  if (name == "already_free") return Status::kAlreadyFree;
  if (name == "solved") return Status::kSolved;
  if (name == "unsolved") return Status::kUnsolved;
  throw Error("status: '" + name + "' is none of already_free|solved|unsolved");
}

std::vector<Status> ReadStatuses(nb::handle names, std::size_t rows) {
  std::vector<Status> status;
  for (const nb::handle name : names) status.push_back(ReadStatus(nb::cast<std::string>(name)));
  if (status.size() != rows) throw Error("status: there must be one for each row of q");
  return status;
}

struct Row {
  std::size_t index = 0;
  Result result;
  Gradient gradient;
};

// All that is given and found, row by row.
struct Rows {
  std::size_t count = 0, nq = 0, nv = 0;
  std::vector<double> q_in, q;
  std::vector<Status> status;
  std::vector<double> by_sigma, by_q;  // NaN where there is none
  std::vector<std::uint8_t> changes;

  void Differentiate(const Scene& scene, const Options& options, int threads);
  void Set(std::size_t index, const Gradient& gradient);
};

void Rows::Set(std::size_t index, const Gradient& gradient) {
  std::copy(gradient.sigma.begin(), gradient.sigma.end(),
            by_sigma.begin() + static_cast<std::ptrdiff_t>(index * nv));
  std::copy(gradient.q.begin(), gradient.q.end(),
            by_q.begin() + static_cast<std::ptrdiff_t>(index * nv * nv));
  changes[index] = gradient.active_set_changes;
}

void Rows::Differentiate(const Scene& scene, const Options& options, int threads) {
  const auto workers = std::clamp<std::size_t>(static_cast<std::size_t>(threads), 1,
                                               std::max<std::size_t>(1, count));
  std::vector<Differentiator> differentiators;
  for (std::size_t t = 0; t < workers; ++t) differentiators.emplace_back(scene, options);
  std::size_t next = 0;
  const auto take = [&](Row& row) {
    row.index = next;
    return next++ < count;
  };
  const auto work = [&](std::size_t thread, Row& row) {
    const std::span<const double> from(q_in.data() + row.index * nq, nq);
    const std::span<const double> to(q.data() + row.index * nq, nq);
    row.result.status = status[row.index];
    row.result.q.assign(to.begin(), to.end());
    row.gradient = differentiators[thread].At(from, row.result);
  };
  const auto tell = [&](std::size_t index, const Row& row) {
    Set(index, row.gradient);
    return true;
  };
  InOrder<Row>(workers).Run(take, work, tell);
}

}  // namespace

nb::dict DifferentiateRows(nb::handle model, nb::handle q_in, nb::handle q, nb::handle status,
                           int threads, const nb::kwargs& given) {
  Asked asked;
  ReadOptions(given, kNorm | kVerify | kSolve, asked);
  const Model scene = ReadModel(model, asked.scene);
  Rows rows;
  rows.nq = static_cast<std::size_t>(scene.scene.nq());
  rows.nv = static_cast<std::size_t>(scene.scene.model()->nv);
  rows.count = ReadConfigurations(q_in, "q_in", scene.scene.nq(), rows.q_in);
  if (ReadConfigurations(q, "q", scene.scene.nq(), rows.q) != rows.count) {
    throw Error("q_in and q must have the same number of rows");
  }
  rows.status = ReadStatuses(status, rows.count);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  rows.by_sigma.assign(rows.count * rows.nv, kNone);
  rows.by_q.assign(rows.count * rows.nv * rows.nv, kNone);
  rows.changes.resize(rows.count);
  CallLibrary([&] { rows.Differentiate(scene.scene, asked.options, threads); });
  nb::dict d;
  d["sigma"] = Array(std::move(rows.by_sigma), {rows.count, rows.nv});
  d["q"] = Array(std::move(rows.by_q), {rows.count, rows.nv, rows.nv});
  d["active_set_changes"] = Array(std::move(rows.changes)).attr("view")("bool");
  return d;
}

}  // namespace mjcf_pdg::python
