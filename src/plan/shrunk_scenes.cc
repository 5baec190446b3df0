#include "plan/shrunk_scenes.h"

#include <memory>

#include "solve/make_tables.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg {

std::vector<Scene> ShrunkScenes(const Scene& scene, Shrunk what) {
  constexpr double kMost = 15.0 / 16.0, kLeast = 0.02;
  std::vector<Scene> scenes;
  for (double share = kMost; share >= kLeast;
       share = share > 0.5 ? 2.0 * share - 1.0 : 0.5 * share) {
    std::shared_ptr<const mjModel> smaller = ShrunkModel(scene.tables(), share, what);
    if (!smaller) break;
    scenes.emplace_back(
        ResizedTables(scene.tables(), smaller),
        std::make_shared<const VerifierModel>(scene.verifier_model()->Resized(smaller)));
  }
  return scenes;
}

}  // namespace mjcf_pdg
