// What the verifier knows of a model: immutable, made once per Scene, shared between threads.
#ifndef MJCF_PDG_SRC_VERIFY_VERIFIER_MODEL_H_
#define MJCF_PDG_SRC_VERIFY_VERIFIER_MODEL_H_

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <vector>

#include "mjcf_pdg/scene.h"
#include "verify/convex/convex_shape.h"
#include "verify/exact/mesh_solid.h"
#include "verify/pairs.h"

namespace mjcf_pdg {

struct VerifierModel {
  // `owner` keeps `m` alive; it is null for the model of a running program, which must outlive this
  // object. `ignored` are pairs of geoms that do not count. Throws Error for an
  // unknown body or geom.
  VerifierModel(std::shared_ptr<const mjModel> owner, const mjModel& m, const SceneOptions& options,
                const std::vector<std::array<int, 2>>& ignored = {});

  // The same of a copy of the model in which geoms are smaller; nothing else may differ.
  VerifierModel Resized(std::shared_ptr<const mjModel> model) const;

  std::shared_ptr<const mjModel> owner;
  // A copy of the mjModel struct, whose arrays are the user's. Settings that make MuJoCo's
  // collision detection miss contacts are undone, and the arena is large enough for all contacts.
  mjModel unblinded;
  std::vector<char> exact;  // by geom: it collides as its triangles
  std::vector<verify::CheckedPair> pairs;
  bool has_sdf_pairs = false;
  verify::LeftOut left_out;      // pairs whose contacts do not count
  std::vector<char> equalities;  // by equality constraint: to be held while it is active
  std::vector<char> tendons;     // by tendon: its length limits count
  bool keeps_margins = false;    // SceneOptions::keep_margins
  double largest_margin = 0.0;   // of any pair, 0 if none is positive [m]
  // By geom, of the geoms in `pairs`; those of planes and of geoms without signed distances have
  // nothing but their extents.
  std::vector<verify::ConvexShape> shapes;
  // By geom; null unless the geom is a box or mesh of an exact pair.
  std::vector<std::shared_ptr<const verify::MeshSolid>> solids;

 private:
  void MakeShapes(const mjModel& m);
  void MakeSolids(const mjModel& m);
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_VERIFY_VERIFIER_MODEL_H_
