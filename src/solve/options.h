// Which options are usable: ranges, and the names of the starts and steps that can be left out.
#ifndef MJCF_PDG_SRC_SOLVE_OPTIONS_H_
#define MJCF_PDG_SRC_SOLVE_OPTIONS_H_

#include <vector>

#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

// Throws Error for a value out of range or none of an enumeration's, a mocap pose that does not fit
// the model, or a name in options.without that options.method does not have.
void CheckOptions(const Options& options, const mjModel& m);

// Throws Error unless the libmujoco of this process has the major and minor version of the headers
// that we were built with: patches go together, other versions lay out their structs differently.
void CheckMujocoVersion();

// Quaternions shorter than this are refused, because they have no direction.
inline constexpr double kLeastQuaternion = 1e-6;

// Throws Error for negative numbers and NaN.
void CheckBudget(const Budget& budget);

// Throws Error unless there are 3 and 4 finite values per mocap body, or none, and no quaternion is
// zero.
void CheckMocap(const std::vector<double>& pos, const std::vector<double>& quat, const mjModel& m);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_OPTIONS_H_
