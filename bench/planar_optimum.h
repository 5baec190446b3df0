// Fig. 11's brute force: a rigid body that turns about one axis and is shifted in the plane across
// it.
//
// Source: Tang & Kim, Sec. 6.2: one rotation and two translations are sampled 300 times each, the
// best contact configuration is the optimum. Differs from it: for each angle and direction of the
// shift the contact is found by bisection instead of by sampling; then the best angles and
// directions are searched again on finer grids until σ falls by less than 0.1 % from one to the
// next.
#ifndef MJCF_PDG_BENCH_PLANAR_OPTIMUM_H_
#define MJCF_PDG_BENCH_PLANAR_OPTIMUM_H_

#include "problem/workspace.h"

namespace mjcf_pdg::bench {

struct PlanarOptimum {
  double sigma = 0.0;  // [m²]
  double error = 0.0;  // relative fall of σ on the last grid
  int queries = 0;
};

// The scene's joints are two slides at right angles and a hinge across both, through the centre of
// mass, on one body.
PlanarOptimum BruteForcePlanar(Workspace& work);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_PLANAR_OPTIMUM_H_
