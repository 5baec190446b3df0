// How far each joint is from its place, for a report.
#ifndef MJCF_PDG_APPS_HTML_JOINT_MOVES_H_
#define MJCF_PDG_APPS_HTML_JOINT_MOVES_H_

#include <nlohmann/json.hpp>
#include <vector>

#include "apps/html/page.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// The terms of σ from the first frame to each, those that are largest in frame `end` first: for
// every term its name, unit, and for every frame its σ [m²] and (of joints) how far it moved [mm or
// °].
nlohmann::ordered_json PageJoints(const Scene& scene, Metric metric,
                                  const std::vector<PageFrame>& frames, std::size_t end);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_JOINT_MOVES_H_
