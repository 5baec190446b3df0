#include "plan/relaxed_scenes.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "model/scene_tables.h"
#include "model/shrunk_model.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg {
namespace {

// Of the box around the geom in its own frame [m]; infinite if nothing movable carries the geom.
double LeastWidth(const SceneTables& tables, int geom) {
  const mjModel& m = *tables.model;
  if (!tables.body_moves[m.geom_bodyid[geom]]) return std::numeric_limits<double>::infinity();
  const mjtNum* half = m.geom_aabb + 6 * geom + 3;
  return 2.0 * std::min({half[0], half[1], half[2]});
}

double LeastWidth(const SceneTables& tables, int geom1, int geom2) {
  return std::min(LeastWidth(tables, geom1), LeastWidth(tables, geom2));
}

Scene Dilated(const Scene& scene, double share) {
  auto tables = std::make_shared<SceneTables>(scene.tables());
  for (KeptPair& pair : tables->pairs) {
    if (!PartedByOnePlane(pair.kind) || !pair.moves) continue;
    pair.allowed += share * LeastWidth(*tables, pair.geom1, pair.geom2);
  }
  auto verifier = std::make_shared<VerifierModel>(*scene.verifier_model());
  for (verify::CheckedPair& pair : verifier->pairs) {
    if (!pair.convex() || !pair.separable) continue;
    pair.allowed += share * LeastWidth(*tables, pair.geom1, pair.geom2);
  }
  return {std::move(tables), std::move(verifier)};
}

}  // namespace

std::vector<Scene> ShrunkScenes(const Scene& scene) {
  // Shares of a size. Seconds of the processor for peg.xml, slot.xml (models/passages), the bridge,
  // a board in a window and an L in its hole (medians of 6 seeds, 9701 and after; shrunken scenes
  // alone, whose paths were straightened first): 0.20, 1.3, 0.13, 0.80 and 5.4; from seven eighths
  // 0.22, 1.3, 0.14, 0.57 and 9.9 (half of them not found). The last step is short then: a passage
  // that is 3 % wider than a body has room for it.
  constexpr double kMost = 0.75, kLeast = 0.02;
  std::vector<Scene> scenes;
  if (scene.HasExactMeshes()) return scenes;
  for (double share = kMost; share >= kLeast; share *= 0.5) {
    std::shared_ptr<const mjModel> smaller = ShrunkModel(scene.tables(), share);
    if (!smaller) break;
    scenes.push_back(scene.Resized(std::move(smaller)));
  }
  return scenes;
}

std::vector<Scene> DilatedScenes(const Scene& scene) {
  // Of the least width. From a 64th the last step is short: a passage that is 3 % wider than a body
  // leaves it a 64th on each side.
  constexpr double kMost = 1.0, kLeast = 1.0 / 64.0;
  const std::vector<KeptPair>& pairs = scene.tables().pairs;
  const bool any = std::any_of(pairs.begin(), pairs.end(), [](const KeptPair& pair) {
    return PartedByOnePlane(pair.kind) && pair.moves;
  });
  std::vector<Scene> scenes;
  for (double share = kMost; any && share >= kLeast; share *= 0.5) {
    scenes.push_back(Dilated(scene, share));
  }
  return scenes;
}

}  // namespace mjcf_pdg
