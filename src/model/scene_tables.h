// What a Scene knows, as plain tables. Filled by scene.cc, read everywhere, never written again.
#ifndef MJCF_PDG_SRC_MODEL_SCENE_TABLES_H_
#define MJCF_PDG_SRC_MODEL_SCENE_TABLES_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

namespace mjcf_pdg {

class TriangleBvh;
class SupportPoints;

// A joint that may move. Angles in rad, slides in m.
struct JointEntry {
  int id = 0;
  int type = 0;  // mjtJoint
  int body = 0;
  int qadr = 0;  // first entry in qpos
  int vadr = 0;  // first entry in MuJoCo's tangent (nv)
  int col = 0;   // first entry in ours (n)
  int ndof = 0;
  bool limited = false;
  double lo = 0.0, hi = 0.0;  // a ball's total angle is at most hi

  // Is its k-th dof a translation [m]? The others turn [rad].
  bool Slides(int k) const { return type == mjJNT_SLIDE || (type == mjJNT_FREE && k < 3); }
};

// Two geoms whose overlap counts, in MuJoCo's order (by type, then by body).
struct KeptPair {
  int geom1 = 0, geom2 = 0;
  double allowed = 0.0;      // overlap the model allows by a negative margin + gap [m], >= 0
  bool has_distance = true;  // false for SDF and height fields: contacts only
  bool exact = false;        // one geom or both collide as their triangles, not as hulls
  bool moves = true;         // some movable joint lies between the two geoms
};

// Kept pairs of one pair of bodies: pairs[begin, end).
struct BodyPair {
  int body1 = 0, body2 = 0;
  int begin = 0, end = 0;
};

// In the body's frame; radius infinite when the body has a plane.
struct BoundingSphere {
  Eigen::Vector3d center_B = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

// What is asked of an exact pair that overlaps: how deep and where, which is slow, the same with a
// longer search for its deepest places, or only that it does.
enum class Depths { kMeasured, kSearched, kSkipped };

struct SceneTables {
  std::shared_ptr<const mjModel> owner;  // empty when the model is a running program's
  const mjModel* model = nullptr;
  // A private copy of the struct alone (arrays are the user's): settings that blind MuJoCo's
  // collision detection are undone, multi-contact is off, the arena is large enough.
  mjModel query_model;

  std::vector<JointEntry> joints;  // movable ones, in MJCF order
  std::vector<int> column_of_dof;  // nv -> n, -1 when frozen
  std::vector<char> body_moves;    // nbody: some movable joint is above it
  int n = 0;
  double size =
      1.0;  // half of the colliding geoms that may move have a smaller bounding radius [m]
  int root_body = -1;  // the norm's root link, -1: top bodies

  std::vector<KeptPair> pairs;  // sorted by body pair
  std::vector<BodyPair> body_pairs;
  std::vector<BoundingSphere> body_spheres;  // nbody
  bool has_contact_only_pairs = false;
  std::shared_ptr<const SupportPoints> support;  // of the kept pairs' convex geoms

  std::vector<char> exact;   // ngeom: collides as its triangles ...
  std::vector<char> convex;  // ... which are those of its convex hull
  std::vector<std::shared_ptr<const TriangleBvh>>
      solids;               // ngeom; null where no exact pair needs it
  double tree_units = 1.0;  // of solids, to the metre
  std::vector<std::string> warnings;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_SCENE_TABLES_H_
