#include "plan/shrunk_scenes.h"

#include <memory>

#include "solve/make_tables.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg {
namespace {

// Sizes of what grows, its own included, equal steps apart. When a quarter of a hand that is thin
// and aslant in its hole was added at once, PDg moved it to this side of the wall or that instead
// of turning it. Of 207 searches for passages 3 % wider than the body 203 find a path within 20 s,
// and 200 when sizes doubled up to a half and then lacked half as much each time. Ten are as good,
// 25 take longer (bench/README.md, Passages).
constexpr int kSizes = 16;

}  // namespace

std::vector<Scene> ShrunkScenes(const Scene& scene, Shrunk what) {
  std::vector<Scene> scenes;
  for (int lacks = kSizes - 1; lacks > 0; --lacks) {
    const double share = static_cast<double>(lacks) / kSizes;
    std::shared_ptr<const mjModel> smaller = ShrunkModel(scene.tables(), share, what);
    if (!smaller) break;
    scenes.emplace_back(
        ResizedTables(scene.tables(), smaller),
        std::make_shared<const VerifierModel>(scene.verifier_model()->Resized(smaller)));
  }
  return scenes;
}

}  // namespace mjcf_pdg
