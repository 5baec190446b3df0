// Scenes with SDF geoms of MuJoCo's own plugins.
#ifndef MJCF_PDG_TESTS_SUPPORT_SDF_SCENES_H_
#define MJCF_PDG_TESTS_SUPPORT_SDF_SCENES_H_

#include <mujoco/mujoco.h>

#include <filesystem>
#include <string>

namespace mjcf_pdg::test {

inline constexpr double kRing = 0.35, kTube = 0.15;  // radii of the torus [m]

// The fixed geom "sdf" of the plugin mujoco.sdf.`kind`, and `body` as a free body.
inline std::string SdfXml(const std::string& kind, const std::string& body) {
  mj_loadPluginLibrary(
      (std::filesystem::path(MJCF_PDG_MUJOCO_PLUGIN_DIR) / "libsdf_plugin.so").c_str());
  const std::string config = kind == "torus" ? "<config key='radius1' value='.35'/>"
                                               "<config key='radius2' value='.15'/>"
                                             : "";
  return "<mujoco><extension><plugin plugin='mujoco.sdf." + kind + "'><instance name='i'>" +
         config +
         "</instance></plugin></extension><asset><mesh name='m'><plugin instance='i'/>"
         "</mesh></asset><worldbody><geom name='sdf' type='sdf' mesh='m' pos='.1 0 -.2' "
         "euler='20 30 10'><plugin instance='i'/></geom><body name='body'><freejoint/>" +
         body + "</body></worldbody></mujoco>";
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_SDF_SCENES_H_
