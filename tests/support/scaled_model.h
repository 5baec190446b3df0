// A model as if its metre were another length: every length times a power of two, so that nothing
// is rounded, and masses as they are.
#ifndef MJCF_PDG_TESTS_SUPPORT_SCALED_MODEL_H_
#define MJCF_PDG_TESTS_SUPPORT_SCALED_MODEL_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

ModelPtr Scaled(const mjModel& model, double scale);

// A configuration of the model in the scaled one.
std::vector<double> Scaled(const mjModel& model, std::vector<double> q, double scale);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_SCALED_MODEL_H_
