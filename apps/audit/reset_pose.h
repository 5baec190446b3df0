// Where a model begins: mj_resetData puts it at qpos0, which MJCF says by how its bodies stand.
#ifndef MJCF_PDG_APPS_AUDIT_RESET_POSE_H_
#define MJCF_PDG_APPS_AUDIT_RESET_POSE_H_

#include <optional>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

struct ResetPose {
  const std::string& path;       // the file that the text is for: names in it are relative to that
  const std::vector<double>& q;  // where the model is to begin, nq values
  bool degrees;                  // angles of the text are in degrees
  const SceneOptions& scene;     // in which q is free, with
  const Options& solve;          // this tolerance
};

struct MovedReset {
  std::string text;
  bool within_limits;  // no joint is outside its limits at the new qpos0
};

// The text with other poses of bodies, and other `ref`, `axis` and `pos` of joints, so that qpos0
// is `q`, or another configuration where nothing overlaps, and every other one is what it was. Of
// a body that has to stay, joints that qpos0 has outside their limits stay there. None where MJCF
// cannot say that (a ball joint's qpos0 is the identity always; equality constraints and springs
// may be tied to qpos0) or where this program cannot (bodies in a <frame>, made by <replicate> or
// of an attached model): the new text is compiled, and compared with the old one.
std::optional<MovedReset> WithResetPose(const std::string& text, const ResetPose& pose);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_AUDIT_RESET_POSE_H_
