// A search on the convex hulls of exact meshes, before the one on their triangles, for models of
// several links. Not in the paper.
//
// What is free for the hulls is free for the triangles, and hulls have exact depths and normals: a
// whole search on hulls costs less than a few descents on triangles. Where the answer lies in a
// hollow of a mesh, the hulls' answer is far away or does not exist, and other starts must find it.
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

  // Solves `work`'s problem with every mesh replaced by its hull. Returns the nearest answer, valid
  // until the next call, or null if nothing free was found.
  const VectorXd* Run(const Workspace& work);

  std::int64_t queries() const;

 private:
  struct Hulls;
  std::unique_ptr<Hulls> hulls_;  // made at the first Run: most models have no exact meshes
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_HULL_STAGE_H_
