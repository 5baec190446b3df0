// Scene: an MJCF model seen as a penetration-depth problem: what may move, which pairs count.
#ifndef MJCF_PDG_SCENE_H_
#define MJCF_PDG_SCENE_H_

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mjcf_pdg/export.h"
#include "mjcf_pdg/types.h"

struct mjModel_;
typedef struct mjModel_ mjModel;

namespace mjcf_pdg {

// What of a model may move, and what σ is measured from.
struct SceneOptions {
  // Bodies whose own joints and subtrees may move; everything else is frozen. Empty: all joints.
  std::vector<std::string> movable;
  // Body that is the root link of the object norm (a palm, a torso; Sec. 4); empty: every tree's
  // top body.
  std::string root;
  // Mesh geoms collide as their triangles, closed ones as solids, instead of as convex hulls: those
  // that the model's <custom><text name="mjcf_pdg.exact_mesh" data="geom geom ..."/></custom>
  // names, or all if it has no such text. Against SDF geoms and height fields they stay hulls.
  bool exact_mesh = false;
};

struct SceneTables;    // internal, src/model/scene_tables.h
struct VerifierModel;  // internal, src/verify/verifier_model.h

// Immutable and shareable between threads. Copies share everything.
class MJCF_PDG_API Scene {
 public:
  // All throw Error: no such file, broken XML (with MuJoCo's line), unknown body name, a body
  // without joints below it, flex or another feature that is not supported (named), an exact_mesh
  // text that names something else than a mesh geom.
  static Scene FromFile(const std::string& path, const SceneOptions& options = {});
  static Scene FromString(const std::string& xml, const SceneOptions& options = {});
  // The model of a running program: never written to. It must outlive the scene and its solvers,
  // and stay as it is: what a scene has worked out (pairs, sizes, its own mjOption) does not follow
  // changes. After one, make a new scene.
  static Scene FromModel(const mjModel* model, const SceneOptions& options = {});

  // FromModel's argument, else the model that the scene has loaded and owns.
  const mjModel* model() const;
  // What is doubtful about the model but no Error, one line each.
  const std::vector<std::string>& Warnings() const;
  // Internal: not for other programs.
  const SceneTables& tables() const { return *tables_; }
  const std::shared_ptr<const VerifierModel>& verifier_model() const { return verifier_model_; }

  int nq() const;               // entries of a configuration
  int dof() const;              // n, the number of movable degrees of freedom
  bool HasExactMeshes() const;  // a mesh of some kept pair counts as its triangles
  int num_kept_pairs() const;   // pairs of geoms that MuJoCo's filters keep
  // By id in the model: the name, else "#id".
  std::string GeomName(int geom) const;
  std::string JointName(int joint) const;

  std::vector<std::string> KeyNames() const;   // "" for an unnamed keyframe
  std::vector<double> KeyQpos(int key) const;  // nq; throws Error for no such key
  std::vector<double> DefaultQpos() const;     // qpos0, nq

  // Throws Error unless q has nq finite entries and no zero quaternion. Other quaternions need not
  // be unit ones: they are normalized where they are used.
  void CheckConfiguration(std::span<const double> q) const;
  void CheckConfiguration(const std::vector<double>& q) const {
    CheckConfiguration(std::span<const double>(q));
  }
  // Throws Error if the user's model no longer has the sizes it had when the scene was made: a
  // model compiled anew in its place. Solver asks at every call.
  void CheckUnchanged() const;
  // Active equality constraints, by name or "#id" and kind; Solver refuses such scenes.
  std::vector<std::string> ActiveEqualities() const;

 private:
  Scene(std::shared_ptr<const mjModel> owner, const mjModel& model, const SceneOptions& options);
  std::shared_ptr<const SceneTables> tables_;
  std::shared_ptr<const VerifierModel> verifier_model_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SCENE_H_
