// Scenes and poses that the tests of the verifier share.
#ifndef MJCF_PDG_TESTS_SUPPORT_VERIFY_SCENES_H_
#define MJCF_PDG_TESTS_SUPPORT_VERIFY_SCENES_H_

#include <string>

namespace mjcf_pdg::test {

// Two boxes of 0.2 m, the second on a slide along x; at qpos 0 their centres coincide. `extra` is
// top-level XML, `geom` more attributes of the second box.
inline std::string TwoBoxes(const std::string& extra = "", const std::string& geom = "") {
  return "<mujoco>" + extra + R"(<worldbody><geom name="wall" type="box" size=".1 .1 .1"/>
    <body name="slider"><joint name="x" type="slide" axis="1 0 0"/>
      <geom name="block" type="box" size=".1 .1 .1" )" +
         geom + "/></body></worldbody></mujoco>";
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_VERIFY_SCENES_H_
