// Motion coherence: what earlier frames of a motion leave for later ones to start from.
//
// Source: Tang & Kim, Sec. 3.2 and 5.1: a cache of free and of self-collision-free configurations.
#ifndef MJCF_PDG_SRC_START_MOTION_COHERENCE_H_
#define MJCF_PDG_SRC_START_MOTION_COHERENCE_H_

#include <cstddef>
#include <vector>

#include "problem/workspace.h"

namespace mjcf_pdg {

// The last `capacity` configurations that were added.
class ConfigurationCache {
 public:
  explicit ConfigurationCache(std::size_t capacity) : capacity_(capacity) {}

  void Add(const VectorXd& q);
  void Clear() { entries_.clear(), next_ = 0; }
  bool empty() const { return entries_.empty(); }
  // With what is frozen as in q_in; nearest to it first, by σ, `largest_count` at most.
  std::vector<VectorXd> NearestFirst(Workspace& work, std::size_t largest_count) const;

 private:
  std::size_t capacity_;
  std::size_t next_ = 0;  // the oldest entry, once the cache is full
  std::vector<VectorXd> entries_;
};

// One per solver. Cached configurations may no longer be free: obstacles (mocap bodies) move too.
class MotionCoherence {
 public:
  static constexpr std::size_t kTries = 8;  // nearest cached configurations that a start looks at

  // A frame's answer, known to be free; a frame known to be free of self-collision.
  void AddFree(const VectorXd& q);
  void AddSelfCollisionFree(const VectorXd& q) { self_collision_free_.Add(q); }
  void Clear();

  bool empty() const { return free_.empty(); }
  std::vector<VectorXd> NearestFree(Workspace& work, std::size_t largest_count = kTries) const {
    return free_.NearestFirst(work, largest_count);
  }
  std::vector<VectorXd> NearestSelfCollisionFree(Workspace& work) const {
    return self_collision_free_.NearestFirst(work, kTries);
  }

 private:
  // Longer motions than so many frames seldom come back to where they were.
  static constexpr std::size_t kCapacity = 64;
  ConfigurationCache free_{kCapacity}, self_collision_free_{kCapacity};
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_START_MOTION_COHERENCE_H_
