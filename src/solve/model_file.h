// Models from files: MJCF (.xml), URDF and compiled models (.mjb).
#ifndef MJCF_PDG_SRC_SOLVE_MODEL_FILE_H_
#define MJCF_PDG_SRC_SOLVE_MODEL_FILE_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

namespace mjcf_pdg {

struct SpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using SpecPtr = std::unique_ptr<mjSpec, SpecDeleter>;

// Parses MJCF or URDF. Meshes of a URDF that are named as in ROS, package://NAME/..., are looked
// for in a folder NAME beside the file or beside a folder above it, and in the folders of
// ROS_PACKAGE_PATH and AMENT_PREFIX_PATH (there in share/NAME). MuJoCo itself resolves no packages.
// Throws Error, without the path, if the file cannot be parsed, a package is not found, or a plugin
// that it names is not registered with MuJoCo.
SpecPtr ParseModelFile(const std::string& path);
SpecPtr ParseModelText(const std::string& xml);

// Throws Error with MuJoCo's words if the model does not compile.
std::shared_ptr<const mjModel> CompileModel(mjSpec* spec);

// The model of a file, by the ending .mjb a compiled one. Throws Error, without the path, if there
// is none, or if it is compiled and not MuJoCo's of exactly this version, or uses plugins.
std::shared_ptr<const mjModel> LoadModelFile(const std::string& path);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_MODEL_FILE_H_
