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

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/random.h"
#include "paper/successive_perturbation.h"
#include "problem/problem.h"
#include "start/selection.h"

namespace mjcf_pdg {

struct FreeConfiguration {
  VectorXd q;
  std::string start;  // name of the selection
};

// The last `capacity` configurations that were added.
class ConfigurationCache {
 public:
  explicit ConfigurationCache(std::size_t capacity) : capacity_(capacity) {}

  void Add(const VectorXd& q);
  bool empty() const { return entries_.empty(); }
  // With what is frozen as in q_in; nearest to it first, by σ.
  std::vector<VectorXd> NearestFirst(Problem& problem) const;

 private:
  std::size_t capacity_;
  std::size_t next_ = 0;  // the oldest entry, once the cache is full
  std::vector<VectorXd> entries_;
};

// One per thread. Selections refer to problem.q_in.
class FreeConfigurationSelection {
 public:
  explicit FreeConfigurationSelection(Problem& problem);

  // All selections, in the order that SelectInPaperOrder tries them.
  static std::vector<std::string> Names();

  // A new q_in. `hint`: the user's pose, if any; `seed` of the random selections.
  void Begin(const std::optional<VectorXd>& hint, std::uint64_t seed);

  // A free configuration by the first selection that finds one; none if all fail or are left out.
  std::optional<FreeConfiguration> SelectInPaperOrder();

  // Motion coherence: remembers q if it is free, or free of self-collision at least.
  void Remember(const VectorXd& q);
  void RememberFree(const VectorXd& q);  // known to be
  // The nearest to q_in of those that were free; not asked again.
  std::optional<VectorXd> NearestRemembered();

  int tried() const { return tried_; }  // selections since Begin

 private:
  using Selected = std::optional<VectorXd>;
  struct Entry {
    const char* name;
    Selected (FreeConfigurationSelection::*select)();
  };
  static const std::vector<Entry>& Table();

  Selected MotionCoherence();
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

  Problem& problem_;
  SuccessivePerturbation perturbation_;
  StartSelection starts_;
  ConfigurationCache free_, self_collision_free_;
  std::optional<VectorXd> hint_;
  Random random_;
  int tried_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PAPER_FREE_CONFIGURATION_H_
