// What the window draws: the command, what of it overlaps in orange, and its repair as a ghost in
// blue. MuJoCo's abstract visualization (mjv_*): no OpenGL, no window.
#ifndef MJCF_PDG_APPS_VIEW_GHOST_SCENE_H_
#define MJCF_PDG_APPS_VIEW_GHOST_SCENE_H_

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "apps/input/configurations.h"

namespace mjcf_pdg::app {

// Orange and blue differ for every kind of colour vision; a ghost that is not free is white.
inline constexpr std::array<float, 3> kGuiltyColor = {0.95f, 0.50f, 0.05f};
inline constexpr std::array<float, 3> kGhostColor = {0.05f, 0.30f, 0.90f};
inline constexpr std::array<float, 3> kUnfreeGhostColor = {0.95f, 0.95f, 0.95f};

struct Shown {
  bool command = true, ghost = true;
  bool own_colors = false;  // the model's, instead of grey
};

class GhostScene {
 public:
  explicit GhostScene(const mjModel& model);  // keeps a reference

  // Poses the command. Its contacts (and their forces) are computed if `option` shows them.
  void SetCommand(const Configuration& row);
  // Poses the ghost (nq values) among the mocap bodies of the command.
  void SetGhost(std::span<const double> q, bool free);
  void RemoveGhost() { ghost_shown_ = false; }

  // Writes `scene`. `guilty`: the geoms of the command that overlap (ids); they are drawn whatever
  // groups are shown. Of the ghost only what is elsewhere than in the command is drawn.
  void Update(const std::vector<int>& guilty, const Shown& shown);

  const mjData& command() const { return *command_; }
  mjData& command() { return *command_; }
  const mjData& ghost() const { return *ghost_; }

  // The body and the point that are seen in a direction; both relative to the window, in [0, 1],
  // from its lower left corner.
  struct Hit {
    int body = 0;
    std::array<double, 3> point_W = {};
  };
  std::optional<Hit> Pick(double aspect, double x, double y) const;

  mjvScene scene;
  mjvOption option;
  mjvCamera camera;
  mjvPerturb perturb;

 private:
  struct Deleter {
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  struct SceneOwner {
    explicit SceneOwner(mjvScene& s) : scene(s) { mjv_defaultScene(&scene); }
    ~SceneOwner() { mjv_freeScene(&scene); }
    mjvScene& scene;
  };

  void Pose(mjData& data) const;
  // Adds the geoms of `data` that `keep` accepts, without any decoration.
  template <typename Keep>
  void Add(mjData& data, const mjvOption& groups, int categories, Keep keep);
  void AddHidden(const std::vector<int>& guilty);
  void AddGhost();
  void Paint(const std::vector<int>& guilty, bool own_colors);

  const mjModel& model_;
  std::unique_ptr<mjData, Deleter> command_, ghost_;
  SceneOwner owner_;
  bool ghost_shown_ = false, ghost_free_ = true;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEW_GHOST_SCENE_H_
