// A model prepared for pictures: its pose, which of its geoms are shown, in which colours, and how
// what overlaps is kept in sight. Then it is drawn.
#ifndef MJCF_PDG_APPS_PICTURE_STAGE_H_
#define MJCF_PDG_APPS_PICTURE_STAGE_H_

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "apps/picture/egl_context.h"
#include "apps/picture/image.h"

namespace mjcf_pdg::app {

// The colours of guilty geoms. Orange and blue differ for every kind of colour vision.
enum class Tint { kOrange, kBlue };

// A ball that CountPixels adds to the scene to find out how much of a place is seen. It is in no
// picture.
struct Marker {
  double position[3];  // World frame [m].
  double radius;       // [m]
};

using Point = std::array<double, 3>;

// Where everything stands.
struct Pose {
  std::vector<double> qpos;
  std::vector<double> mocap_pos, mocap_quat;  // as in Options; empty: as in the model
};

// Guilty geoms are those that overlap; they alone are drawn in colour, everything else is grey.
// Shown are the geoms of groups 0 to 2, as in MuJoCo's viewer, all guilty geoms (if such a geom is
// not shown otherwise, the rest of its body is drawn as glass), and the colliding geoms of bodies
// that would show nothing otherwise. Where other geoms cover more than half of what a guilty geom
// would show, all of them are drawn as glass; where guilty geoms cover each other, the outline of
// the covered one is drawn over everything.
class Stage {
 public:
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;

  explicit Stage(const mjModel* model);  // Throws std::runtime_error if there is no OpenGL.

  // Makes these geoms (ids) the guilty ones. To be called before anything is drawn.
  void SetGuilty(const std::vector<int>& geoms);
  void SetPose(const Pose& pose);  // Also finds the contacts at this pose.

  const mjModel& model() const { return *model_; }
  const mjData& data() const { return *data_; }
  bool IsGuilty(int geom) const { return shade_[geom] != 0; }
  bool IsShown(int geom) const { return model_->geom_group[geom] == 0; }
  bool IsUnbounded(int geom) const;  // A plane or a height field.

  // Finds out which guilty geoms are covered in this camera's picture; the pictures drawn from here
  // on show these as the comment of the class says.
  void FindCovered(mjvCamera& camera);

  // Returns a picture of kWidth × kHeight in which the guilty geoms are tinted and the places
  // `marks` (world frame [m]) have a ring around them. The two texts stand in the top left corner
  // (characters outside ASCII become '?'). MuJoCo may update a camera that rides on a body.
  Image Draw(mjvCamera& camera, Tint tint, const std::vector<Point>& marks,
             const std::string& title, const std::string& text);

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
  bool IsGuiltyGeom(const mjvGeom& geom) const;
  bool IsGlass(const mjvGeom& geom) const;
  void DimLights();
  void TintScene(Tint tint);
  void AddBackdrop();
  // Renders the geoms of the scene in a colour per geom, only those that `keep` accepts, and
  // returns at each pixel the geom's id, that of a marker (ngeom + index), or -1.
  template <typename Keep>
  std::vector<int> Segment(int width, int height, Keep keep);

  const mjModel* source_;
  Pose model_pose_;
  std::unique_ptr<mjModel, Deleter> model_;  // A copy of source_ with shown geoms in group 0.
  std::unique_ptr<mjData, Deleter> data_;
  EglContext egl_;  // Must outlive the canvas.
  Canvas canvas_;
  Scene scene_;
  mjvOption option_;
  std::vector<int> shade_;         // By geom: 0 if it is not guilty, else 1 + index of its shade.
  std::vector<bool> glass_body_;   // By body: it has a guilty geom that is hidden by default.
  bool under_others_ = false;      // Some guilty geom is covered by geoms that are not.
  std::vector<int> under_guilty_;  // The guilty geoms that other guilty geoms cover.
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_STAGE_H_
