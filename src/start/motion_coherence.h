// Motion coherence: configurations of earlier frames of a motion, from which later frames may
// start.
//
// Source: Tang & Kim, Sec. 3.2 and 5.1: a cache of free and of self-collision-free configurations.
#ifndef MJCF_PDG_SRC_START_MOTION_COHERENCE_H_
#define MJCF_PDG_SRC_START_MOTION_COHERENCE_H_

#include <cstddef>
#include <vector>

#include "base/tuning.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

// The last `capacity` configurations that were added.
class ConfigurationCache {
 public:
  explicit ConfigurationCache(std::size_t capacity) : capacity_(capacity) {}

  void Add(const VectorXd& q);
  void Clear() { entries_.clear(), next_ = 0; }
  bool empty() const { return entries_.empty(); }
  // The entries nearest to q_in by σ, nearest first, `largest_count` at most, with frozen joints as
  // in q_in.
  std::vector<VectorXd> NearestFirst(Workspace& work, std::size_t largest_count) const;

 private:
  std::size_t capacity_;
  std::size_t next_ = 0;  // the oldest entry, once the cache is full
  std::vector<VectorXd> entries_;
};

// One per solver. What was free when it was added may no longer be: obstacles (mocap bodies) move
// too.
class MotionCoherence {
 public:
  // Adds a frame's answer, which is free; or a configuration that is free of self-collision at
  // least.
  void AddFree(const VectorXd& q);
  void AddSelfCollisionFree(const VectorXd& q) { self_collision_free_.Add(q); }
  void Clear();

  bool empty() const { return free_.empty(); }
  std::vector<VectorXd> NearestFree(
      Workspace& work, std::size_t largest_count = tuning::starts::kFramesTried) const {
    return free_.NearestFirst(work, largest_count);
  }
  std::vector<VectorXd> NearestSelfCollisionFree(Workspace& work) const {
    return self_collision_free_.NearestFirst(work, tuning::starts::kFramesTried);
  }

 private:
  ConfigurationCache free_{tuning::starts::kFramesKept};
  ConfigurationCache self_collision_free_{tuning::starts::kFramesKept};
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_START_MOTION_COHERENCE_H_
