// Scene: a MuJoCo model as a penetration depth problem: which joints may move, which pairs of geoms
// count.
#ifndef MJCF_PDG_SCENE_H_
#define MJCF_PDG_SCENE_H_

#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mjcf_pdg/export.h"
#include "mjcf_pdg/types.h"

struct mjModel_;
typedef struct mjModel_ mjModel;

namespace mjcf_pdg {

// Which equality constraints (joint and tendon couplings, connects, welds) are held while solving.
enum class EqualityMode {
  kHold,    // all but connects and welds to mocap bodies, by which people drive a robot
  kAll,     // those too
  kIgnore,  // none
};

// Two geoms or bodies by name; a body stands for all of its own geoms.
using NamePair = std::array<std::string, 2>;

// An overlap that is wanted: a squeezed grasp, a soft pad, feet in a mat.
struct AllowedOverlap {
  NamePair names;
  double depth = 0.0;  // [m], 0 to 1000
};

// Which joints may move, which link the norm is measured from, and how meshes collide.
struct SceneOptions {
  // Bodies whose own joints and subtrees may move; everything else is frozen. Empty: all joints.
  std::vector<std::string> movable = {};
  // Bodies whose own joints are frozen, whatever `movable` says.
  std::vector<std::string> fixed = {};
  // Pairs whose overlaps do not count, as if the model had an <exclude> for them.
  std::vector<NamePair> exclude = {};
  std::vector<AllowedOverlap> allow = {};
  // Pairs that overlap at qpos0, in each keyframe and in each of 200 random configurations do not
  // count: links that are drawn into each other. Scene::IgnoredPairs names them.
  bool ignore_permanent = false;
  // The body that is the root link of the object norm (a palm, a torso; Sec. 4). Empty: the top
  // body of every tree.
  std::string root = {};
  // Rotational inertia that is added to that of what every hinge and ball moves [kg m²], and, as a
  // mass, to that of every slide [kg], in the norm; 0 to 1000. So toes and finger tips, which weigh
  // next to nothing, do not turn far to save grams.
  double armature = 0.0;
  bool model_armature = false;  // each joint's own `armature` of the model is added, too
  // Whether mesh geoms collide as their triangles (closed meshes as solids) instead of as their
  // convex hulls. It holds for the geoms that the model's text <custom><text
  // name="mjcf_pdg.exact_mesh" data="geom geom ..."/></custom> names, or for all if the model has
  // no such text. Against SDF geoms and height fields they remain hulls.
  bool exact_mesh = false;
  // Of the constraints that are active in the model, or in the mjData that is solved.
  EqualityMode equality = EqualityMode::kHold;
  // The length limits of tendons are held, too: they are part of what is free.
  bool hold_tendon_limits = false;
  // What the model disables by <flag> (contact, limit, constraint) does not count. If this is
  // false, contacts and limits count all the same, and Scene::Warnings says so.
  bool model_flags = false;
  // Pairs that can move apart keep their margin of the model, within which MuJoCo pushes on them,
  // where it is more than Options::clearance.
  bool keep_margins = false;
  // Flexes are left out instead of refused: they collide with nothing, and their vertices stay.
  bool ignore_flexes = false;
};

struct SceneTables;    // internal, src/model/scene_tables.h
struct VerifierModel;  // internal, src/verify/verifier_model.h

// Immutable; may be shared between threads. Copies share their contents.
class MJCF_PDG_API Scene {
 public:
  // All three throw Error if there is no such file, the XML is broken (with MuJoCo's line), a name
  // of the options is unknown or a movable body has no joints below it, the model has flexes
  // (but see ignore_flexes) or another unsupported feature (which is named), or an exact_mesh text
  // names anything but a mesh geom.
  static Scene FromFile(const std::string& path, const SceneOptions& options = {});
  static Scene FromString(const std::string& xml, const SceneOptions& options = {});
  // A scene of a running program's model, which is never written to. The model must outlive the
  // scene and its solvers and must not change, because pairs, sizes and options are derived from it
  // once. After a change, make a new scene.
  static Scene FromModel(const mjModel* model, const SceneOptions& options = {});

  // The argument of FromModel, or else the model that the scene has loaded and owns. Never null.
  const mjModel* model() const;
  // What is doubtful about the model without being an Error, one line each.
  const std::vector<std::string>& Warnings() const;
  // For the library itself, not for other programs.
  const SceneTables& tables() const { return *tables_; }
  const std::shared_ptr<const VerifierModel>& verifier_model() const { return verifier_model_; }
  Scene(std::shared_ptr<const SceneTables> tables,
        std::shared_ptr<const VerifierModel> verifier_model)
      : tables_(std::move(tables)), verifier_model_(std::move(verifier_model)) {}

  int nq() const;               // entries of a configuration
  int dof() const;              // n, the number of movable degrees of freedom
  bool HasExactMeshes() const;  // a mesh of some kept pair collides as its triangles
  int num_kept_pairs() const;   // pairs of geoms that MuJoCo's filters keep
  // The name of the geom with this id in the model or, if it has none, its place: "torso/geom1" is
  // the second geom of the body torso, "torso/body0/geom0" the first of torso's first child.
  std::string GeomName(int geom) const;
  std::string JointName(int joint) const;  // "#id" if it has no name

  std::vector<std::string> KeyNames() const;   // by keyframe; "" for an unnamed one
  std::vector<double> KeyQpos(int key) const;  // nq entries; throws Error if there is no such key
  std::vector<double> DefaultQpos() const;     // qpos0, nq entries

  // Throws Error unless q has nq finite entries and no zero quaternion. Quaternions need not be of
  // unit length: they are normalized where they are used.
  void CheckConfiguration(std::span<const double> q) const;
  void CheckConfiguration(const std::vector<double>& q) const {
    CheckConfiguration(std::span<const double>(q));
  }
  // Throws Error if the sizes of the user's model have changed since the scene was made, as when
  // another model was compiled in its place. Solver calls this for every solve.
  void CheckUnchanged() const;
  // The pairs of geoms (ids, ascending) that SceneOptions::ignore_permanent has set aside.
  const std::vector<std::array<int, 2>>& IgnoredPairs() const;
  // The equality constraints that are active in the model and held, each by its name (or "#id") and
  // kind.
  std::vector<std::string> HeldEqualities() const;
  bool HoldsTendonLimits() const;  // the options hold the length limits of some tendon

 private:
  Scene(std::shared_ptr<const mjModel> owner, const mjModel& model, const SceneOptions& options);
  std::shared_ptr<const SceneTables> tables_;
  std::shared_ptr<const VerifierModel> verifier_model_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SCENE_H_
