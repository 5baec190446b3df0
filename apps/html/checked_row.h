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

// The slider goes from `from` to where the motion is free, and there to `to`. `words` say what
// ended it where no pairs did.
PageRow MotionPageRow(const Scene& scene, const Ends& ends, const Motion& motion,
                      const std::string& words);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_CHECKED_ROW_H_
