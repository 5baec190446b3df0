// Free-configuration selection: a table of the paper's methods by name, and their order.
//
// Source: Tang & Kim, Sec. 3.2, 5.1 and 6.1. Order: motion coherence if there is any; else centroid
// difference for a rigid body, successive perturbation and then constrained translation for an
// articulated one.
// Differs from it:
//   1. Where all of these fail we go on: a pose of the user's (hint, qpos0, keyframes), then the
//      maximally clear configuration.
//   2. Translations that end in a collision are tried along the other free directions, and tree
//      after tree where several are in collision.
//   3. The maximally clear configuration is the clearest of random ones, no precomputed grid: about
//      q_in at a growing distance, until some are free.
#ifndef MJCF_PDG_SRC_PAPER_FREE_CONFIGURATION_H_
#define MJCF_PDG_SRC_PAPER_FREE_CONFIGURATION_H_

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/random.h"
#include "paper/successive_perturbation.h"
#include "problem/workspace.h"
#include "start/motion_coherence.h"
#include "start/selection.h"

namespace mjcf_pdg {

struct FreeConfiguration {
  VectorXd q;
  Component start = Component::kNone;  // the selection
};

// One per thread. Selections refer to work.problem().q_in.
class FreeConfigurationSelection {
 public:
  // `coherence`: what earlier frames left.
  FreeConfigurationSelection(Workspace& work, const MotionCoherence& coherence);

  // A new q_in. `hint`: the user's pose, null: none; `seed` of the random selections.
  void Begin(const VectorXd* hint, std::uint64_t seed);

  // A free configuration by the first selection that finds one; none if all fail or are left out.
  std::optional<FreeConfiguration> SelectInPaperOrder();

  // No tree of links overlaps itself at q, a configuration worth remembering. One query.
  bool SelfCollisionFree(const VectorXd& q) { return perturbation_.SelfCollisionFree(q); }

  int tried() const { return tried_; }  // selections since Begin

 private:
  using Selected = std::optional<VectorXd>;
  struct Entry {
    Component component;
    Selected (FreeConfigurationSelection::*select)();
  };
  static const std::vector<Entry>& Table();

  Selected Coherence();
  Selected CentroidDifference();
  Selected Perturbation();
  Selected Translation();
  Selected UserPose();
  Selected MaximallyClear();

  bool IsRigid() const;  // one link, free to go anywhere
  Selected FirstFree(std::span<const VectorXd> configurations);
  Selected TranslateFrom(VectorXd q);
  std::vector<NearPair> Overlaps(const VectorXd& q);
  std::vector<VectorXd> UserPoses();
  // `pose` with the root links' joints as in q_in.
  VectorXd AtBaseOfInput(const VectorXd& pose) const;
  double Clearance(const VectorXd& q, double reach);

  const Problem& problem_;
  Workspace& work_;
  SuccessivePerturbation perturbation_;
  StartSelection starts_;
  const MotionCoherence& coherence_;
  const VectorXd* hint_ = nullptr;
  Random random_;
  int tried_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PAPER_FREE_CONFIGURATION_H_
