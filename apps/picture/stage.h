// A model prepared for pictures: its pose, which of its geoms are shown and in which colours, and
// drawing it.
#ifndef MJCF_PDG_APPS_PICTURE_STAGE_H_
#define MJCF_PDG_APPS_PICTURE_STAGE_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/picture/contact_sheet.h"
#include "apps/picture/egl_context.h"

namespace mjcf_pdg::app {

enum class Tint { kRed, kGreen };

// A ball that CountPixels adds to the scene to find out how much of a place is seen. It is in no
// picture.
struct Marker {
  double position[3];  // World frame [m].
  double radius;       // [m]
};

// Guilty geoms are those that overlap; they are drawn in red or green. Shown are the geoms of
// groups 0 to 2, as in MuJoCo's viewer, all guilty geoms (if such a geom is not shown otherwise,
// the rest of its body is drawn as glass), and the colliding geoms of bodies that would show
// nothing otherwise.
class Stage {
 public:
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;

  explicit Stage(const mjModel* model);  // Throws std::runtime_error if there is no OpenGL.

  // Makes these geoms (ids) the guilty ones. To be called before anything is drawn.
  void SetGuilty(const std::vector<int>& geoms);
  void SetPose(const std::vector<double>& qpos);  // Also finds the contacts at this pose.

  const mjModel& model() const { return *model_; }
  const mjData& data() const { return *data_; }
  bool IsGuilty(int geom) const { return shade_[geom] != 0; }
  bool IsShown(int geom) const { return model_->geom_group[geom] == 0; }
  bool IsUnbounded(int geom) const;  // A plane or a height field.

  // Returns a picture of kWidth × kHeight, the lowest line first, with the guilty geoms tinted and
  // the two texts in its top left corner (characters outside ASCII become '?'). MuJoCo may update a
  // camera that rides on a body.
  Bytes Draw(mjvCamera& camera, Tint tint, const std::string& title, const std::string& when);

  // Returns how many pixels of a picture of kProbeWidth × kProbeHeight show each geom and, after
  // the geoms, each marker.
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
  mjvGeom* AddBall(const mjtNum position[3], double radius);  // Null if the scene is full.
  bool IsGlass(const mjvGeom& geom) const;
  void TintScene(Tint tint);
  void AddBackdrop();

  const mjModel* source_;
  std::unique_ptr<mjModel, Deleter> model_;  // A copy of source_ with shown geoms in group 0.
  std::unique_ptr<mjData, Deleter> data_;
  EglContext egl_;  // Must outlive the canvas.
  Canvas canvas_;
  Scene scene_;
  mjvOption option_;
  std::vector<int> shade_;        // By geom: 0 if it is not guilty, else 1 + index of its shade.
  std::vector<bool> glass_body_;  // By body: it has a guilty geom that is hidden by default.
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_STAGE_H_
