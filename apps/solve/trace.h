// The record of a search: `solve --trace` writes it, `replay` recomputes it. JSON Lines: a header,
// then for each row a line with its q_in, one per iteration, and one with the answer.
#ifndef MJCF_PDG_APPS_SOLVE_TRACE_H_
#define MJCF_PDG_APPS_SOLVE_TRACE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "apps/solve/solve_rows.h"

namespace mjcf_pdg::app {

// `options`: GivenOptions of the command line.
std::string TraceHeader(const std::string& model, const std::vector<std::string>& options);

// The lines of one row, each with its line break. Times are left out: the same search gives the
// same bytes.
std::string TraceRow(const Scene& scene, std::size_t index, const SolvedRow& solved);

struct TraceStart {
  std::string version, mujoco;  // of what wrote the trace
  std::string model;
  std::vector<std::string> options;
};
// Throws Error, without the line's place, if `line` is no header.
TraceStart ReadTraceHeader(const std::string& line);

// The first line of a row.
struct TraceInput {
  std::size_t index = 0;
  Configuration row;
};
// Throws Error, without the line's place, if `line` is no first line of a row.
TraceInput ReadTraceInput(const std::string& line);

// Whether `line` is the last one of a row, as far as it can be read.
bool EndsTraceRow(const std::string& line);

// In words, where a line of a trace and the line that is there now differ first.
std::string TraceDifference(const std::string& traced, const std::string& now);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_TRACE_H_
