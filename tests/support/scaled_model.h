// A model in another unit of length: all lengths are multiplied by a power of two, so that nothing
// is rounded, and masses stay.
#ifndef MJCF_PDG_TESTS_SUPPORT_SCALED_MODEL_H_
#define MJCF_PDG_TESTS_SUPPORT_SCALED_MODEL_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

// A copy of the model with all lengths times `scale`.
ModelPtr Scaled(const mjModel& model, double scale);

// The configuration `q` of the model as one of the scaled model.
std::vector<double> Scaled(const mjModel& model, std::vector<double> q, double scale);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_SCALED_MODEL_H_
