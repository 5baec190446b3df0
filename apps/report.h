// The output of `solve` and `check`: JSON Lines for programs, tables for people.
#ifndef MJCF_PDG_APPS_REPORT_H_
#define MJCF_PDG_APPS_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// Returns one line with its line break, numbers at full precision. Bytes that are not UTF-8 are
// replaced.
std::string JsonLine(const nlohmann::ordered_json& value);

// The geom's name as a string, or, if it has none, its id as a number, because a geom may be called
// "3".
nlohmann::ordered_json GeomJson(const Scene& scene, int geom);

// The texts of all rows: one JSON line a row, or a table with a line of totals. `results` and
// `verdicts` are in the order of `rows`.
std::string SolveJson(const Scene& scene, const std::vector<Configuration>& rows,
                      const std::vector<Result>& results);
std::string SolveTable(const Scene& scene, const std::vector<Configuration>& rows,
                       const std::vector<Result>& results);

std::string CheckJson(const Scene& scene, const std::vector<Configuration>& rows,
                      const std::vector<Verdict>& verdicts);
// Also lists the pairs that overlap by more than `tolerance` [m].
std::string CheckTable(const Scene& scene, const std::vector<Configuration>& rows,
                       const std::vector<Verdict>& verdicts, double tolerance);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REPORT_H_
