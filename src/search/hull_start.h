// Exact meshes: a start for models of several links, the nearest that is free of their convex
// hulls.
//
// Hulls that are apart have triangles that are apart, and their depths and ways out are known: a
// whole search on hulls takes less than a few descents on triangles. Where a hollow matters its
// answer is far, or there is none. Nothing of the paper.
#ifndef MJCF_PDG_SRC_SEARCH_HULL_START_H_
#define MJCF_PDG_SRC_SEARCH_HULL_START_H_

#include <cstdint>
#include <memory>
#include <optional>

#include "problem/problem.h"

namespace mjcf_pdg {

class HullStart {
 public:
  explicit HullStart(const Problem& problem);
  ~HullStart();

  // The problem's answer as if its meshes were their hulls; none if nothing was found free.
  std::optional<VectorXd> Start();

  std::int64_t queries() const;

 private:
  struct Hulls;
  const Problem& problem_;
  std::unique_ptr<Hulls> hulls_;  // once asked for
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_HULL_START_H_
