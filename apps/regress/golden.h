// Golden results of a suite, and what has changed since. The file has a version and a line a row:
//   {"version": 1, "rows": [
//     {"model": "arm.xml", "row": "keyframe home", "status": "solved", "sigma": 0.0004, "queries":
//     57},
#ifndef MJCF_PDG_APPS_REGRESS_GOLDEN_H_
#define MJCF_PDG_APPS_REGRESS_GOLDEN_H_

#include <map>
#include <string>
#include <vector>

#include "apps/regress/suite.h"

namespace mjcf_pdg::app {

// What is kept of a row. σ has nine digits, more than any tolerance needs and few enough that
// another compiler changes none of them.
struct GoldenRow {
  std::string name;  // "keyframe home", "poses.npy row 3", "random 7"
  Status status = Status::kUnsolved;
  double sigma = 0.0;  // [m²]
  int queries = 0;
};

// The row as it is read again when it was written.
GoldenRow Kept(GoldenRow row);

// Rows by model.
using Golden = std::map<std::string, std::vector<GoldenRow>>;

// Empty if there is no such file. Throws Error, with the place in it, for one that is broken or of
// another version.
Golden ReadGolden(const std::string& path);
// One line a row, in the order of the suite, so that a changed row is a changed line.
std::string FormatGolden(const Suite& suite, const Golden& golden);

enum class Change {
  kNone,        // as golden
  kNew,         // has no golden result
  kGone,        // is in the golden results alone
  kPenetrates,  // was free, is not
  kLost,        // was solved, is not
  kSigmaUp,     // is farther than tolerated
  kSigmaDown,   // is nearer than tolerated: better, and worth a new golden result
  kFixed,       // was not solved, or penetrated, and is better now
};
const char* NameOf(Change change);
bool IsRegression(Change change);

// `before` null: there is no golden result.
Change Compare(const Suite& suite, const SuiteCase& of, const GoldenRow* before,
               const GoldenRow& now);

// The queries of the rows that both have: more than tolerated, over all of a model?
struct Queries {
  long long before = 0, now = 0;
  std::size_t rows = 0;
  bool Regressed(const Suite& suite) const;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REGRESS_GOLDEN_H_
