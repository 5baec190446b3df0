// The contents of a Scene as plain tables: movable joints, kept pairs, exact meshes.
// solve/make_tables.cc fills them once; all later stages only read them, from any number of
// threads.
#ifndef MJCF_PDG_SRC_MODEL_SCENE_TABLES_H_
#define MJCF_PDG_SRC_MODEL_SCENE_TABLES_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace mjcf_pdg {

class TriangleBvh;
class SupportPoints;

// A joint that may move. `id` and `body` are those of the mjModel.
struct JointEntry {
  int id = 0;
  int type = 0;  // mjtJoint
  int body = 0;
  int qadr = 0;  // first entry in qpos (nq)
  int vadr = 0;  // first entry in MuJoCo's tangent vectors (nv)
  int col = 0;   // first entry in dq, our tangent vectors (n)
  int ndof = 0;  // number of entries in dq
  bool limited = false;
  // Limits: hinge [rad], slide [m]; a ball's total rotation angle is at most hi [rad].
  double lo = 0.0, hi = 0.0;
  double armature = 0.0;  // added by the norm: hinge and ball [kg m²], slide [kg]

  // True if the joint's k-th degree of freedom is a translation [m], false if a rotation [rad].
  bool Slides(int k) const { return type == mjJNT_SLIDE || (type == mjJNT_FREE && k < 3); }
};

// What the two geoms of a pair collide as. It says who measures the pair (collide/contacts.h) and
// what its signed distance proves.
enum class PairKind {
  kConvex,   // convex geoms, and meshes as their convex hulls: one plane parts all of both
  kExact,    // a geom is a mesh that collides as its triangles
  kTerrain,  // geom 1 is a height field; geom 2, if a mesh, counts as its hull
  kSdf,      // a geom is an SDF, which has a signed distance at each point but none to a geom
};

// True if the distance of two geoms that are apart is that of one plane between all of both. Else
// they have features (NearPair), each of which parts the two surfaces only near it.
constexpr bool PartedByOnePlane(PairKind kind) { return kind == PairKind::kConvex; }

// True if depth and normal are reliable only while the geoms are apart, so that the optimization
// should keep a gap between them: where triangles cross, the way out is a guess.
constexpr bool NeedsGap(PairKind kind) { return kind == PairKind::kExact; }

// A kept pair: two geoms whose overlap counts (kept_pairs.h). Geom 1 is the one of the smaller
// mjtGeom, or of the smaller id if the types are the same.
struct KeptPair {
  int geom1 = 0, geom2 = 0;
  double allowed = 0.0;  // overlap that the model allows by a negative margin + gap [m], >= 0
  double kept = 0.0;     // distance that SceneOptions::keep_margins asks for [m], >= 0
  PairKind kind = PairKind::kConvex;
  bool moves = true;  // some movable joint lies between the two geoms

  // The smallest signed distance that counts as free [m]. `clearance` is Options::clearance.
  double Required(double clearance) const {
    return (moves ? std::max(clearance, kept) : 0.0) - allowed;
  }
};

// The kept pairs of two bodies, body1 < body2: SceneTables::pairs[begin, end).
struct BodyPair {
  int body1 = 0, body2 = 0;
  int begin = 0, end = 0;
};

// A sphere around all geoms of a body, in the body's frame [m]. Its radius is infinite if a geom is
// a plane.
struct BoundingSphere {
  Eigen::Vector3d center_B = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

// What a query measures of an exact pair that overlaps. kMeasured: its deepest places, which is
// slow. kSearched: the same by a longer search, which is slower still. kSkipped: only that it
// overlaps.
enum class Depths { kMeasured, kSearched, kSkipped };

struct SceneTables {
  std::shared_ptr<const mjModel> owner;  // owns *model; empty if that belongs to the user's program
  const mjModel* model = nullptr;
  // A private copy of the mjModel struct, whose arrays are still those of *model. It is set up for
  // collision queries: settings that blind MuJoCo's collision detection are undone, multi-contact
  // is off, and the arena is large enough for all contacts.
  mjModel query_model;

  std::vector<JointEntry> joints;  // the movable joints, in MJCF order
  std::vector<int> column_of_dof;  // nv: a MuJoCo dof's entry in dq, -1 if the joint is frozen
  std::vector<char> body_moves;    // nbody: a movable joint is at the body or above it
  // Of an island (model/island.h): the kinematic trees that move, an entry for each of the model,
  // and the mass of all others that are movable in the scene [kg]. Empty and 0 otherwise.
  std::vector<char> moving_trees;
  double outside_mass = 0.0;
  int n = 0;  // number of movable degrees of freedom: the length of dq
  // The scene's size [m], to which lengths are compared: the median bounding radius of the
  // colliding geoms that may move.
  double size = 1.0;
  int root_body = -1;  // the norm's root link; -1: the top body of each tree

  std::vector<KeptPair> pairs;  // sorted by body pair
  std::vector<BodyPair> body_pairs;
  std::vector<BoundingSphere> body_spheres;      // nbody
  bool has_sdf_pairs = false;                    // some pair is PairKind::kSdf
  double largest_kept = 0.0;                     // KeptPair::kept of any pair [m]
  std::shared_ptr<const SupportPoints> support;  // of the kept pairs' convex geoms

  std::vector<char> exact;   // ngeom: the geom is a mesh that collides as its triangles
  std::vector<char> convex;  // ngeom: exact, and the triangles are those of its convex hull
  // ngeom: the triangles of meshes and boxes in exact pairs; null for all other geoms.
  std::vector<std::shared_ptr<const TriangleBvh>> bvhs;
  double tree_units = 1.0;  // the unit of length of `bvhs`: tree units per metre (triangle_bvh.h)
  // By equality constraint of the model: it is held while it is active (equality/held.h).
  std::vector<char> held_equalities;
  std::vector<char> held_tendons;  // by tendon of the model: its length limits are held
  // Pairs of geoms (ascending) that do not count although MuJoCo's filters keep them, because the
  // options exclude them or, in `ignored`, because they overlap permanently. Both are sorted.
  std::vector<std::array<int, 2>> excluded, ignored;
  std::vector<std::string> warnings;  // for the user, a line each
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_SCENE_TABLES_H_
