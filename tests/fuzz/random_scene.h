// Random models of all joint, geom, equality and tendon kinds, as hostile as MJCF allows.
#ifndef MJCF_PDG_TESTS_FUZZ_RANDOM_SCENE_H_
#define MJCF_PDG_TESTS_FUZZ_RANDOM_SCENE_H_

#include <string>
#include <vector>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

struct RandomScene {
  std::string xml;
  double scale = 1.0;  // of its geoms [m], 1e-4 to 1e4
};

// A scene of up to six moving bodies, each with up to three joints and geoms, among obstacles, some
// of them mocap bodies: geoms may coincide, masses span twelve orders of magnitude, lengths eight.
// There are couplings, connects, welds, fixed and spatial tendons, pairs, excludes, margins and
// gaps. One in thirty is a box in a grid of up to two thousand geoms. Not all compile.
RandomScene DrawScene(Random& rng);

// A configuration of the model: inside its limits or not, of free bodies within a few `scale`, with
// quaternions of any length.
std::vector<double> DrawConfiguration(const mjModel& m, double scale, Random& rng);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_FUZZ_RANDOM_SCENE_H_
