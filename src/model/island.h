// Islands: kinematic trees that a solve moves together. Whatever else could move stays where it is
// in q_in, as an obstacle, so that a solve costs what its island costs, however large the scene is.
//
// σ is a sum over trees (Eq. 19): an answer of an island that touches no other tree is an optimum
// of the whole scene, too. Not in the source, whose models are one tree or one body.
#ifndef MJCF_PDG_SRC_MODEL_ISLAND_H_
#define MJCF_PDG_SRC_MODEL_ISLAND_H_

#include <vector>

#include "model/scene_tables.h"

namespace mjcf_pdg {

// The trees of the scene that may move, as indices 0 … count-1, in order of their ids.
class MovableTrees {
 public:
  explicit MovableTrees(const SceneTables& scene);

  int count() const { return count_; }
  // -1 for what no movable joint carries.
  int OfBody(int body) const { return of_body_[body]; }
  int OfGeom(int geom) const { return of_body_[model_->geom_bodyid[geom]]; }
  int OfJoint(const JointEntry& joint) const { return of_body_[joint.body]; }
  // The trees that an equality constraint of the model joins, or that a tendon runs along,
  // ascending.
  const std::vector<int>& OfEquality(int equality) const { return of_equality_[equality]; }
  const std::vector<int>& OfTendon(int tendon) const { return of_tendon_[tendon]; }
  // The same for each equality constraint and limited tendon that the scene holds.
  std::vector<std::vector<int>> OfHeld(const SceneTables& scene) const;
  // SceneTables::body_pairs that concern the tree, ascending.
  const std::vector<int>& BodyPairsOf(int tree) const { return body_pairs_[tree]; }

 private:
  std::vector<int> TreesOf(const std::vector<int>& bodies) const;

  const mjModel* model_;
  int count_ = 0;
  std::vector<int> of_body_;
  std::vector<std::vector<int>> of_equality_, of_tendon_, body_pairs_;
};

struct Island {
  // `trees`: ascending indices of `all`, the trees of `scene`.
  Island(const SceneTables& scene, const MovableTrees& all, std::vector<int> trees);

  std::vector<int> trees;
  // Of the same model: joints of other trees are frozen, and kept pairs that do not concern the
  // island are left out. Sizes and masses are still those of the scene.
  SceneTables tables;
  std::vector<int> scene_pairs;  // per kept pair of `tables`: its index in the scene's

 private:
  bool Has(int tree) const;
  void FillJoints(const SceneTables& scene, const MovableTrees& all);
  void FillPairs(const SceneTables& scene, const MovableTrees& all);
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_ISLAND_H_
