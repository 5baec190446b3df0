// Exact meshes: a search on their convex hulls, before the one on triangles, for models of several
// links.
//
// Hulls that are apart have triangles that are apart, and their depths and ways out are known: a
// whole search on hulls takes less than a few descents on triangles. Where a hollow matters its
// answer is far, or there is none. Nothing of the paper.
#ifndef MJCF_PDG_SRC_SEARCH_HULL_STAGE_H_
#define MJCF_PDG_SRC_SEARCH_HULL_STAGE_H_

#include <cstdint>
#include <memory>

#include "problem/workspace.h"

namespace mjcf_pdg {

class HullStage {
 public:
  HullStage();
  ~HullStage();

  // The nearest answer as if the meshes of `work`'s problem were their hulls, until the next call;
  // null if nothing was found free.
  const VectorXd* Run(const Workspace& work);

  std::int64_t queries() const;

 private:
  struct Hulls;
  std::unique_ptr<Hulls> hulls_;  // made at the first Run: most models have no exact meshes
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_HULL_STAGE_H_
