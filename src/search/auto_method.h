// Method auto in its stages: the first starts; where links of exact meshes overlap, a whole search
// on their convex hulls; where few degrees of freedom move, all of joint space; the search itself;
// and a last descent from the answer to full precision.
#ifndef MJCF_PDG_SRC_SEARCH_AUTO_METHOD_H_
#define MJCF_PDG_SRC_SEARCH_AUTO_METHOD_H_

#include <cstdint>
#include <optional>

#include "bound/joint_boxes.h"
#include "problem/strategy.h"
#include "search/hull_stage.h"
#include "search/search.h"
#include "start/motion_coherence.h"

namespace mjcf_pdg {

class AutoMethod : public Strategy {
 public:
  explicit AutoMethod(Workspace& work);

  Outcome& Run(const StrategyInput& input) override;
  bool UsesLowerBound() const override;
  bool Polish(Candidate& candidate) override;
  bool Retreat(const Candidate& candidate, VectorXd& q) override;
  std::int64_t lcp_steps() const override { return search_.trials().lcp_steps(); }
  std::int64_t other_queries() const override { return hulls_.queries(); }
  void Remember(const VectorXd& q, bool free) override;
  void Forget() override;

 private:
  void SearchBoxes(const StrategyInput& input);

  const Problem& problem_;
  Workspace& work_;
  MotionCoherence coherence_;
  HullStage hulls_;
  std::optional<JointBoxes> boxes_;  // where few degrees of freedom move
  Search search_;
  VectorXd recalled_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_AUTO_METHOD_H_
