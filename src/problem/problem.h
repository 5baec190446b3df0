// What a solve is: made once for a q_in (workspace.h) and not changed after.
#ifndef MJCF_PDG_SRC_PROBLEM_PROBLEM_H_
#define MJCF_PDG_SRC_PROBLEM_PROBLEM_H_

#include "collide/contacts.h"
#include "mjcf_pdg/types.h"
#include "model/kinematics.h"
#include "problem/components.h"

namespace mjcf_pdg {

// The lengths of a solve. All follow from the user's tolerance and the scene's size, so that a
// scene a thousand times larger, solved with a tolerance a thousand times larger, behaves the same.
struct Tolerances {
  Tolerances(double tolerance, double scene_size);

  double user;    // overlap that counts as free: Options::tolerance [m]
  double aim;     // overlap that a descent aims at: less than that, for distances jitter [m]
  double accept;  // overlap with which a descent calls a configuration free: between the two [m]
  // Distance at which exact meshes are kept [m]: as long as triangles are apart their nearest
  // points give a normal, which has to be guessed when they overlap.
  double mesh_gap;
};

struct Problem {
  const SceneTables& tables;
  const Options& options;
  double clearance;  // the largest that a pair must keep, but for mesh_gap [m]
  double size;       // half of the geoms that may move have a smaller bounding radius [m]
  Tolerances tolerances;
  ComponentSet without;  // Options::without
  MocapPoses mocap = {};
  VectorXd q_in = {};      // nq, quaternions normalized
  VectorXd required = {};  // per kept pair: smallest distance that counts as free [m]

  // The pair can move and is nearer than required by more than `accepted` [m].
  bool Overlaps(const NearPair& near, double accepted) const {
    return tables.pairs[near.pair].moves && near.distance < required[near.pair] - accepted;
  }
  // False for what Options::without names.
  bool Uses(Component component) const { return !without[static_cast<std::size_t>(component)]; }
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_PROBLEM_H_
