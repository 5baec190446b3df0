// The brute force of Fig. 11: the optimum of a rigid body that turns about one axis and translates
// in the plane across it.
//
// Source: Tang & Kim, Sec. 6.2: one rotation and two translations are sampled 300 times each, and
// the best contact configuration is the optimum. Differs from it:
//   1. For each angle and each direction of the translation the contact is found by bisection
//      instead of by sampling.
//   2. The best angle and direction are searched again on finer grids until σ falls by less than
//      0.1 % from one grid to the next.
#ifndef MJCF_PDG_BENCH_PLANAR_OPTIMUM_H_
#define MJCF_PDG_BENCH_PLANAR_OPTIMUM_H_

#include "problem/workspace.h"

namespace mjcf_pdg::bench {

struct PlanarOptimum {
  double sigma = 0.0;  // [m²]
  double error = 0.0;  // relative fall of σ on the last grid
  int queries = 0;     // configurations that were checked
};

// The optimum for work.problem(). The scene's joints must be two slides at right angles and a hinge
// across both through the centre of mass, all on one body.
PlanarOptimum BruteForcePlanar(Workspace& work);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_PLANAR_OPTIMUM_H_
