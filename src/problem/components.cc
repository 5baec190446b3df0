#include "problem/components.h"

#include <algorithm>

namespace mjcf_pdg {

const char* NameOf(Component component) {
  switch (component) {
    case Component::kDirect:
      return "direct";
    case Component::kMirror:
      return "mirror";
    case Component::kNoise:
      return "noise";
    case Component::kHop:
      return "hop";
    case Component::kConstrainedTranslation:
      return "constrained_translation";
    case Component::kHulls:
      return "hulls";
    case Component::kPairByPair:
      return "pair_by_pair";
    case Component::kAnywhere:
      return "anywhere";
    case Component::kBoxes:
      return "boxes";
    case Component::kUserPose:
      return "user_pose";
    case Component::kMotionCoherence:
      return "motion_coherence";
    case Component::kCentroidDifference:
      return "centroid_difference";
    case Component::kSuccessivePerturbation:
      return "successive_perturbation";
    case Component::kMaximallyClear:
      return "maximally_clear";
    case Component::kPolish:
      return "polish";
    case Component::kEarlyExit:
      return "early_exit";
    case Component::kWitnessMemory:
      return "witness_memory";
    case Component::kDamping:
      return "damping";
    case Component::kCorrections:
      return "corrections";
    case Component::kReverseProjection:
      return "reverse_projection";
    case Component::kNone:
      break;
  }
  return "none";
}

const std::vector<Component>& ComponentsOf(Method method) {
  using enum Component;
  static const std::vector<Component> of_auto = {
      kDirect,    kMirror,        kNoise,           kHop,      kConstrainedTranslation,
      kHulls,     kPairByPair,    kAnywhere,        kUserPose, kPolish,
      kEarlyExit, kWitnessMemory, kMotionCoherence, kDamping,  kBoxes};
  // The selections in the paper's order (Sec. 6.1).
  static const std::vector<Component> of_paper = {kMotionCoherence,
                                                  kCentroidDifference,
                                                  kSuccessivePerturbation,
                                                  kConstrainedTranslation,
                                                  kUserPose,
                                                  kMaximallyClear,
                                                  kCorrections,
                                                  kReverseProjection};
  return method == Method::kPaper ? of_paper : of_auto;
}

ComponentSet ComponentsNamed(const std::vector<std::string>& names, Method method) {
  const std::vector<Component>& known = ComponentsOf(method);
  ComponentSet set;
  for (const std::string& name : names) {
    const auto it = std::find_if(known.begin(), known.end(), [&name](Component component) {
      return name == NameOf(component);
    });
    if (it == known.end()) {
      std::string message = "cannot leave out '" + name + "': the method has";
      for (const Component component : known) {
        message += std::string(component == known.front() ? " " : ", ") + NameOf(component);
      }
      throw Error(message);
    }
    set.set(static_cast<std::size_t>(*it));
  }
  return set;
}

}  // namespace mjcf_pdg
