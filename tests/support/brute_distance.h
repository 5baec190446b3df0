// A slow oracle of the distance of convex geoms, which shares no code with MuJoCo or the library.
#ifndef MJCF_PDG_TESTS_SUPPORT_BRUTE_DISTANCE_H_
#define MJCF_PDG_TESTS_SUPPORT_BRUTE_DISTANCE_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>

namespace mjcf_pdg::test {

// Support function of a convex geom at the pose in `d`: the largest n · p over its points p [m].
double Support(const mjModel* m, const mjData* d, int geom, const Eigen::Vector3d& n_W);

struct BruteGap {
  double distance = 0.0;                           // signed [m]; never above the true one
  Eigen::Vector3d n_W = Eigen::Vector3d::UnitX();  // unit normal, from geom 1 to geom 2
};
// Maximizes the gap -(h_1(n) + h_2(-n)) between supporting planes over unit vectors n, where h is
// the support function. The maximum is the signed distance of two convex geoms, whether or not they
// overlap. Planes are half-spaces.
BruteGap BruteDistance(const mjModel* m, const mjData* d, int geom1, int geom2);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_BRUTE_DISTANCE_H_
