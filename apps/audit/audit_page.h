// What `audit` found, as a report.
#ifndef MJCF_PDG_APPS_AUDIT_AUDIT_PAGE_H_
#define MJCF_PDG_APPS_AUDIT_AUDIT_PAGE_H_

#include <string>
#include <vector>

#include "apps/audit/examine.h"
#include "apps/html/page.h"

namespace mjcf_pdg::app {

inline const std::vector<std::string> kAuditColumns = {"share %", "depth mm", "force/weight"};

// Adds a row for each pair that overlaps, where it does deepest, and one for qpos0 and each
// keyframe. `options` are those of the command line that `check` has, too.
void AddAudit(const std::string& model, const Scene& scene, const Audit& audit,
              const std::vector<std::string>& options, Page& page);

// A row for a model that could not be looked at.
void AddUnaudited(const std::string& model, const std::string& error, Page& page);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_AUDIT_AUDIT_PAGE_H_
