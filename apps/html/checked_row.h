// A checked configuration or motion in a report: of `check`.
#ifndef MJCF_PDG_APPS_HTML_CHECKED_ROW_H_
#define MJCF_PDG_APPS_HTML_CHECKED_ROW_H_

#include <string>
#include <vector>

#include "apps/html/page.h"
#include "mjcf_pdg/motion.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

inline const std::vector<std::string> kCheckColumns = {"overlaps", "depth mm", "limit excess"};

struct CheckedRow {
  const Configuration& row;
  const Verdict& verdict;
};

// Without command; `values` are those of kCheckColumns. What overlaps by no more than `tolerance`
// [m] counts as none.
PageRow CheckedPageRow(const Scene& scene, double tolerance, const CheckedRow& checked);

struct CheckedMotion {
  const Ends& ends;
  const Motion& motion;
  std::vector<Contact> contacts;  // of what is in the way, at motion.q
};

// The slider goes from `from` to where the motion is free, and from there to `to`.
PageRow MotionPageRow(const Scene& scene, const CheckedMotion& checked);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_CHECKED_ROW_H_
