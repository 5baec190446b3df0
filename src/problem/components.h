// The parts of both methods that can be left out to see what they are worth, and their names.
#ifndef MJCF_PDG_SRC_PROBLEM_COMPONENTS_H_
#define MJCF_PDG_SRC_PROBLEM_COMPONENTS_H_

#include <bitset>
#include <string>
#include <vector>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

// The starts, by which a candidate says where it came from, and then other steps of both methods.
enum class Component {
  kDirect,                  // q_in itself
  kMirror,                  // q_in's other side, seen from the first answer
  kNoise,                   // normal noise about q_in
  kHop,                     // the best answer with one contact decided anew
  kConstrainedTranslation,  // Eq. 20
  kHulls,                   // the answer of the meshes' convex hulls
  kPairByPair,              // exact meshes parted one pair after the other
  kAnywhere,                // uniform within limits
  kBoxes,                   // free boxes of joint space (bound/joint_boxes.h)
  kUserPose,                // a hint, qpos0, keyframes
  kMotionCoherence,         // earlier frames
  kCentroidDifference,      // of rigid bodies
  kSuccessivePerturbation,  // Alg. 1
  kMaximallyClear,          // the clearest of random configurations
  kPolish,                  // a last descent to full precision
  kEarlyExit,               // starts that lead to nothing better are given up
  kWitnessMemory,           // rows of witness points seen before
  kDamping,                 // Levenberg-Marquardt
  kCorrections,             // contacts at the minimizer join those at q_c
  kReverseProjection,       // CCDrg
  kNone,                    // no start: q_in
};
inline constexpr int kNumComponents = static_cast<int>(Component::kNone);

// The name of a component in Options::without and Result::start; "none" for kNone.
const char* NameOf(Component component);

// The components of a method, in the order of Components (pdg.h).
const std::vector<Component>& ComponentsOf(Method method);

using ComponentSet = std::bitset<kNumComponents>;

// The set of the named components. Throws Error for a name that the method does not have; the
// message lists those that it has.
ComponentSet ComponentsNamed(const std::vector<std::string>& names, Method method);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_COMPONENTS_H_
