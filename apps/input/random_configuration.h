// Random configurations of a scene, for suites and audits: the same from every machine.
#ifndef MJCF_PDG_APPS_INPUT_RANDOM_CONFIGURATION_H_
#define MJCF_PDG_APPS_INPUT_RANDOM_CONFIGURATION_H_

#include <vector>

#include "base/random.h"
#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::app {

// Every joint that can move, anywhere within its limits: hinges without limits all around, slides
// without limits and free bodies within the model's extent about qpos0, rotations uniformly (balls
// within their limit). Frozen joints stay as in qpos0.
std::vector<double> RandomConfiguration(const Scene& scene, Random& random);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_INPUT_RANDOM_CONFIGURATION_H_
