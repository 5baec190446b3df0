// What the independent check knows of a model: immutable, made once, shared between threads.
#ifndef MJCF_PDG_SRC_VERIFY_VERIFIER_MODEL_H_
#define MJCF_PDG_SRC_VERIFY_VERIFIER_MODEL_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <vector>

#include "mjcf_pdg/scene.h"
#include "verify/convex_shape.h"
#include "verify/mesh_solid.h"
#include "verify/pairs.h"

namespace mjcf_pdg {

struct VerifierModel {
  // `owner` keeps `m` alive; empty when the model is a running program's. Of the options, those
  // count that say what may move and which meshes are exact. Throws Error for an unknown name.
  VerifierModel(std::shared_ptr<const mjModel> owner, const mjModel& m,
                const SceneOptions& options);

  std::shared_ptr<const mjModel> owner;
  // A copy of the struct alone (arrays are the user's): settings that blind MuJoCo's collision
  // detection are undone, the arena is large enough.
  mjModel unblinded;
  std::vector<char> exact;  // ngeom: collides as its triangles
  std::vector<verify::CheckedPair> pairs;
  bool has_contact_only_pairs = false;
  std::vector<verify::ConvexShape> shapes;  // ngeom; of planes and contact-only geoms, unused
  std::vector<std::shared_ptr<const verify::MeshSolid>>
      solids;  // ngeom; where an exact pair has it
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_VERIFY_VERIFIER_MODEL_H_
