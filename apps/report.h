// What `solve` and `check` tell: JSON Lines for programs, tables for people.
#ifndef MJCF_PDG_APPS_REPORT_H_
#define MJCF_PDG_APPS_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// One line, line break included; numbers at full precision. A name that is not UTF-8 does not
// throw.
std::string JsonLine(const nlohmann::ordered_json& value);

// A name is a string, the id of a geom without one a number: a geom may be called "3".
nlohmann::ordered_json GeomJson(const Scene& scene, int geom);

std::string SolveJson(const Scene& scene, const std::vector<Configuration>& rows,
                      const std::vector<Result>& results);
std::string SolveTable(const Scene& scene, const std::vector<Configuration>& rows,
                       const std::vector<Result>& results);

std::string CheckJson(const Scene& scene, const std::vector<Configuration>& rows,
                      const std::vector<Verdict>& verdicts);
// Lists pairs that overlap by more than `tolerance` [m].
std::string CheckTable(const Scene& scene, const std::vector<Configuration>& rows,
                       const std::vector<Verdict>& verdicts, double tolerance);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REPORT_H_
