// The text of a model with the lines that an audit asks for; all else stays as it was written.
#ifndef MJCF_PDG_APPS_AUDIT_MENDED_TEXT_H_
#define MJCF_PDG_APPS_AUDIT_MENDED_TEXT_H_

#include <string>

#include "apps/audit/examine.h"

namespace mjcf_pdg::app {

// <exclude body1="..." body2="..."/>, escaped.
std::string ExcludeLine(const std::string& body1, const std::string& body2);

// The MJCF of `model` with <exclude> lines for permanent overlaps and, in keyframes that penetrate
// or leave limits, a qpos that is free. A model whose qpos0 does so gets a keyframe "qpos0_pdg", at
// which it is free: qpos0 itself follows from where its bodies stand. What cannot be made free
// stays as it is. Throws Error if the model is no text, if it would have to be written to another
// folder (paths in it are relative), or if a keyframe stands in another file.
std::string MendedText(const std::string& model, const Audit& audit, const std::string& target);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_AUDIT_MENDED_TEXT_H_
