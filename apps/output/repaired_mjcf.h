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

namespace mjcf_pdg::app {

struct SpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using SpecPtr = std::unique_ptr<mjSpec, SpecDeleter>;

// Parses and compiles an MJCF file. Throws Error if that fails, or for a .mjb file, from which MJCF
// cannot be written.
SpecPtr ParseSpec(const std::string& path);

// Adds to `spec` a keyframe for each row whose result is not unsolved, and removes an old one of
// that name. Its qpos is the result's. The ctrl of position actuators changes by as much as the
// actuator's length. All else is as in the row's keyframe, or, for a row without one, as the
// model's defaults.
void AddRepairedKeys(const Scene& scene, const std::vector<Configuration>& rows,
                     const std::vector<Result>& results, mjSpec* spec);

// Returns the MJCF text of `spec`, with all digits and with asset files relative to `folder`, the
// folder that the text will be written to. Changes the file names in `spec`.
std::string FormatMjcf(mjSpec* spec, const std::string& folder);

// Loads the written file `path`. Throws std::runtime_error unless it loads and its keyframes have
// the qpos of the results.
void CheckMjcf(const std::string& path, const std::vector<Configuration>& rows,
               const std::vector<Result>& results);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_REPAIRED_MJCF_H_
