// How far joints are from their places.
#ifndef MJCF_PDG_APPS_OUTPUT_JOINT_MOVED_H_
#define MJCF_PDG_APPS_OUTPUT_JOINT_MOVED_H_

#include <map>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// Ids of joints by the names that the terms of the object norm have. Empty if the terms are bodies
// (Metric::kDisplacement).
std::map<std::string, int> JointsOfTerms(const Scene& scene, Metric metric);

// How far joint `id` is from its place in q_in [rad or m]: hinges and slides with sign, ball joints
// the angle, free joints the way of their origin.
double JointMoved(const Scene& scene, int id, const std::vector<double>& q_in,
                  const std::vector<double>& q);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_JOINT_MOVED_H_
