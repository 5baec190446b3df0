// The text of a model with the lines that an audit asks for; all else stays as it was written.
#ifndef MJCF_PDG_APPS_AUDIT_MENDED_TEXT_H_
#define MJCF_PDG_APPS_AUDIT_MENDED_TEXT_H_

#include <string>
#include <vector>

#include "apps/audit/examine.h"

namespace mjcf_pdg::app {

// <exclude body1="..." body2="..."/>, escaped.
std::string ExcludeLine(const std::string& body1, const std::string& body2);

struct MendOptions {
  std::string target;  // the file that the text is for
  SceneOptions scene;  // as the model was examined
  Options solve;
};

struct MendedModel {
  std::string text;
  std::string done;               // what is not as it was: "1 <exclude>, 2 keyframes, qpos0"
  std::vector<std::string> left;  // what is wrong as before, and why, a line each
};

// The MJCF of `model` with <exclude> lines for permanent overlaps and, in keyframes that are wrong,
// a qpos that is not, and the ctrl and act that hold it there (setpoints.h). Where such keyframes
// stand in included files, the text of these takes the place of their <include>. A model whose
// qpos0 is wrong gets bodies that stand elsewhere (WithResetPose), or, where that is not possible
// or servos pull from there, a keyframe "qpos0_pdg". Throws Error if the model is no text, or if it
// would have to be written to another folder (paths in it are relative).
MendedModel Mended(const std::string& model, const Audit& audit, const MendOptions& options);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_AUDIT_MENDED_TEXT_H_
