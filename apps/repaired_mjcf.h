// The scene as MJCF again, with a keyframe NAME_pdg for every configuration that is or became free
// (NAME_pdg_2 and so on for a keyframe that is asked for again).
#ifndef MJCF_PDG_APPS_REPAIRED_MJCF_H_
#define MJCF_PDG_APPS_REPAIRED_MJCF_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

struct SpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using SpecPtr = std::unique_ptr<mjSpec, SpecDeleter>;

// Throws Error if `path` is no MJCF (a .mjb has lost its source).
SpecPtr ParseSpec(const std::string& path);

// Adds to `spec` a keyframe LABEL_pdg per row that is not unsolved, in place of one of that name:
// qpos repaired; ctrl of position actuators moved by as much as their length; the rest as in the
// row's keyframe (or the model's defaults).
void AddRepairedKeys(const Scene& scene, const std::vector<Configuration>& rows,
                     const std::vector<Result>& results, mjSpec* spec);

// The text of `spec`, exact to the last digit, with asset files relative to `folder`, where it is
// going to live. Changes the file names inside `spec`.
std::string FormatMjcf(mjSpec* spec, const std::string& folder);

// Loads `path` and throws std::runtime_error unless its keyframes LABEL_pdg are the repaired ones.
void CheckMjcf(const std::string& path, const std::vector<Configuration>& rows,
               const std::vector<Result>& results);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REPAIRED_MJCF_H_
