#include "plan/shrunk_scenes.h"

#include <memory>

#include "solve/make_tables.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg {
namespace {

// Of a body that grows, the last one its own: as many equal steps. Doubling up to a half and then
// halving what is lacking, nine steps, adds a quarter of a body at a time: a thin hand that was
// aslant in its hole is then put on this side of the wall or that, not straight. Of 138 searches
// for passages 3 % wider than the body 133 find a path within 20 s so, 137 with 16 equal steps,
// 137 with 10 and 135 with 25 (bench/README.md, Passages).
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
