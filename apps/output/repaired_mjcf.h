// Writes the scene as MJCF with a keyframe LABEL_pdg for every configuration that is or became free
// (LABEL_pdg_2 and so on if a label occurs again). For `solve --out-mjcf`.
#ifndef MJCF_PDG_APPS_OUTPUT_REPAIRED_MJCF_H_
#define MJCF_PDG_APPS_OUTPUT_REPAIRED_MJCF_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/input/configurations.h"
#include "mjcf_pdg/pdg.h"
#include "solve/model_file.h"

namespace mjcf_pdg::app {

// Parses and compiles an MJCF or URDF file. Throws Error if that fails, or for a .mjb file, from
// which MJCF cannot be written.
SpecPtr ParseSpec(const std::string& path);

// The rows of a scene and what became of each.
struct RepairedRows {
  const Scene& scene;
  const std::vector<Configuration>& rows;
  const std::vector<Result>& results;
  std::vector<double> times = {};  // of the new keyframes [s]; empty: those of the rows' keyframes
};

// Adds to `spec` a keyframe for each row whose result is not unsolved, and removes an old one of
// that name. Its qpos is the result's. The ctrl and act of position actuators change by as much
// as the actuator's length. All else is as in the row's keyframe, or, for a row without one, as the
// model's defaults.
void AddRepairedKeys(const RepairedRows& repaired, mjSpec* spec);

// Returns the MJCF text of `spec`, with all digits. Asset files should be named as seen from where
// it will be written (apps/output/asset_files.h).
std::string FormatMjcf(mjSpec* spec);

// Loads the written file `path`, from `vfs` if that is not null. Throws std::runtime_error unless
// it loads and its keyframes have the qpos of the results.
void CheckMjcf(const std::string& path, const mjVFS* vfs, const RepairedRows& repaired);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_REPAIRED_MJCF_H_
