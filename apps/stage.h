// One model on stage: its pose, which of its geoms are shown and in which colours, and drawing it.
#ifndef MJCF_PDG_APPS_STAGE_H_
#define MJCF_PDG_APPS_STAGE_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/contact_sheet.h"
#include "apps/egl_context.h"

namespace mjcf_pdg::app {

enum class Tint { kRed, kGreen };

// A ball which is not drawn, only there to ask whether a place is seen.
struct Marker {
  double position[3];
  double radius;
};

// Shown are geom groups 0 to 2, as in MuJoCo's viewer, and besides: the guilty geoms whatever their
// group (the rest of such a body is then drawn as glass), and the colliding geoms of bodies which
// would show nothing otherwise.
class Stage {
 public:
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;

  explicit Stage(const mjModel* model);  // Throws std::runtime_error if there is no OpenGL.

  void SetGuilty(const std::vector<int>& geoms);
  void SetPose(const std::vector<double>& qpos);  // Also finds the contacts of the pose.

  const mjModel& model() const { return *model_; }
  const mjData& data() const { return *data_; }
  bool IsGuilty(int geom) const { return shade_[geom] != 0; }
  bool IsShown(int geom) const { return model_->geom_group[geom] == 0; }
  bool IsUnbounded(int geom) const;  // A floor, say.

  // A picture, the lowest line first, with the guilty geoms tinted and the texts in its corner
  // (characters outside ASCII become '?').
  Bytes Draw(mjvCamera& camera, Tint tint, const std::string& title, const std::string& when);

  // How many pixels each geom fills, and after the geoms each marker, in a small picture.
  static constexpr int kProbeWidth = 160;
  static constexpr int kProbeHeight = 120;
  std::vector<int> CountPixels(mjvCamera camera, const std::vector<Marker>& markers);

 private:
  struct Deleter {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  struct Scene : mjvScene {
    Scene() { mjv_defaultScene(this); }
    ~Scene() { mjv_freeScene(this); }
  };
  struct Canvas : mjrContext {
    Canvas() { mjr_defaultContext(this); }
    ~Canvas() { mjr_freeContext(this); }
  };

  void UpdateScene(mjvCamera& camera);
  mjvGeom* AddBall(const mjtNum position[3], double radius);  // Null if there is no room.
  bool IsGlass(const mjvGeom& geom) const;
  void TintScene(Tint tint);
  void AddBackdrop();

  const mjModel* source_;
  std::unique_ptr<mjModel, Deleter> model_;  // A copy: shown geoms are in group 0.
  std::unique_ptr<mjData, Deleter> data_;
  EglContext egl_;  // Must outlive the canvas.
  Canvas canvas_;
  Scene scene_;
  mjvOption option_;
  std::vector<int> shade_;        // Per geom: 0 if innocent, else 1 + the index of its shade.
  std::vector<bool> glass_body_;  // Has a guilty geom, hidden by default, usually inside others.
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_STAGE_H_
