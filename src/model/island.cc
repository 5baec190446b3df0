#include "model/island.h"

#include <algorithm>
#include <utility>

namespace mjcf_pdg {
namespace {

// Appends the bodies that a tendon runs along.
void AddBodiesOfTendon(const mjModel& m, int tendon, std::vector<int>& bodies) {
  for (int k = 0; k < m.tendon_num[tendon]; ++k) {
    const int wrap = m.tendon_adr[tendon] + k, object = m.wrap_objid[wrap];
    switch (m.wrap_type[wrap]) {
      case mjWRAP_JOINT:
        bodies.push_back(m.jnt_bodyid[object]);
        break;
      case mjWRAP_SITE:
        bodies.push_back(m.site_bodyid[object]);
        break;
      case mjWRAP_SPHERE:
      case mjWRAP_CYLINDER:
        bodies.push_back(m.geom_bodyid[object]);
        break;
      default:
        break;
    }
  }
}

// The bodies that an equality constraint refers to, and those that its tendons run along.
std::vector<int> BodiesOfEquality(const mjModel& m, int equality) {
  std::vector<int> bodies;
  for (const int object : {m.eq_obj1id[equality], m.eq_obj2id[equality]}) {
    if (object < 0) continue;
    switch (m.eq_type[equality]) {
      case mjEQ_JOINT:
        bodies.push_back(m.jnt_bodyid[object]);
        break;
      case mjEQ_TENDON:
        AddBodiesOfTendon(m, object, bodies);
        break;
      case mjEQ_CONNECT:
      case mjEQ_WELD:
        bodies.push_back(m.eq_objtype[equality] == mjOBJ_SITE ? m.site_bodyid[object] : object);
        break;
      default:
        break;
    }
  }
  return bodies;
}

// Sorts numbers of which each run that ends at one of `ends` is sorted already.
void SortRuns(std::vector<std::ptrdiff_t> ends, std::vector<int>& numbers) {
  while (ends.size() > 1) {
    std::vector<std::ptrdiff_t> merged;
    std::ptrdiff_t begin = 0;
    for (std::size_t k = 1; k < ends.size(); k += 2) {
      std::inplace_merge(numbers.begin() + begin, numbers.begin() + ends[k - 1],
                         numbers.begin() + ends[k]);
      merged.push_back(begin = ends[k]);
    }
    if (ends.size() % 2 == 1) merged.push_back(ends.back());
    ends.swap(merged);
  }
}

}  // namespace

MovableTrees::MovableTrees(const SceneTables& scene)
    : model_(scene.model), of_body_(scene.model->nbody, -1) {
  const mjModel& m = *model_;
  std::vector<int> index(m.ntree, -1);
  for (int body = 0; body < m.nbody; ++body) {
    if (!scene.body_moves[body]) continue;
    int& tree = index[m.body_treeid[body]];
    if (tree < 0) tree = count_++;
    of_body_[body] = tree;
  }
  for (int e = 0; e < m.neq; ++e) of_equality_.push_back(TreesOf(BodiesOfEquality(m, e)));
  for (int t = 0; t < m.ntendon; ++t) {
    std::vector<int> bodies;
    AddBodiesOfTendon(m, t, bodies);
    of_tendon_.push_back(TreesOf(bodies));
  }
  body_pairs_.resize(count_);
  for (int k = 0; k < static_cast<int>(scene.body_pairs.size()); ++k) {
    const int tree1 = of_body_[scene.body_pairs[k].body1];
    const int tree2 = of_body_[scene.body_pairs[k].body2];
    if (tree1 >= 0) body_pairs_[tree1].push_back(k);
    if (tree2 >= 0 && tree2 != tree1) body_pairs_[tree2].push_back(k);
  }
}

std::vector<int> MovableTrees::TreesOf(const std::vector<int>& bodies) const {
  std::vector<int> trees;
  for (const int body : bodies) {
    if (of_body_[body] >= 0) trees.push_back(of_body_[body]);
  }
  std::sort(trees.begin(), trees.end());
  trees.erase(std::unique(trees.begin(), trees.end()), trees.end());
  return trees;
}

std::vector<std::vector<int>> MovableTrees::OfHeld(const SceneTables& scene) const {
  std::vector<std::vector<int>> held;
  for (std::size_t e = 0; e < scene.held_equalities.size(); ++e) {
    if (scene.held_equalities[e]) held.push_back(of_equality_[e]);
  }
  for (std::size_t t = 0; t < scene.held_tendons.size(); ++t) {
    if (scene.held_tendons[t]) held.push_back(of_tendon_[t]);
  }
  return held;
}

Island::Island(const SceneTables& scene, const MovableTrees& all, std::vector<int> of_trees)
    : trees(std::move(of_trees)) {
  tables.owner = scene.owner;
  tables.model = scene.model;
  tables.query_model = scene.query_model;
  tables.size = scene.size;
  tables.body_spheres = scene.body_spheres;
  tables.support = scene.support;
  tables.exact = scene.exact;
  tables.convex = scene.convex;
  tables.bvhs = scene.bvhs;
  tables.tree_units = scene.tree_units;
  if (scene.root_body >= 0 && Has(all.OfBody(scene.root_body))) tables.root_body = scene.root_body;
  const auto concerns = [this](const std::vector<int>& joined) {
    return std::any_of(joined.begin(), joined.end(), [this](int tree) { return Has(tree); });
  };
  tables.held_equalities = scene.held_equalities;
  for (std::size_t e = 0; e < tables.held_equalities.size(); ++e) {
    tables.held_equalities[e] &= concerns(all.OfEquality(static_cast<int>(e)));
  }
  tables.held_tendons = scene.held_tendons;
  for (std::size_t t = 0; t < tables.held_tendons.size(); ++t) {
    tables.held_tendons[t] &= concerns(all.OfTendon(static_cast<int>(t)));
  }
  FillJoints(scene, all);
  FillPairs(scene, all);
}

bool Island::Has(int tree) const {
  return tree >= 0 && std::binary_search(trees.begin(), trees.end(), tree);
}

void Island::FillJoints(const SceneTables& scene, const MovableTrees& all) {
  const mjModel& m = *scene.model;
  tables.column_of_dof.assign(m.nv, -1);
  for (JointEntry joint : scene.joints) {
    if (!Has(all.OfJoint(joint))) continue;
    joint.col = tables.n;
    for (int k = 0; k < joint.ndof; ++k) tables.column_of_dof[joint.vadr + k] = tables.n++;
    tables.joints.push_back(joint);
  }
  tables.body_moves.assign(m.nbody, 0);
  std::vector<char>& moving = tables.moving_trees;
  moving.assign(m.ntree, 0);
  for (int body = 1; body < m.nbody; ++body) {
    if (Has(all.OfBody(body))) {
      tables.body_moves[body] = moving[m.body_treeid[body]] = 1;
    } else if (scene.body_moves[body]) {
      tables.outside_mass += m.body_mass[body];
    }
  }
  // Where no tree sleeps, MuJoCo's lists of what is awake do not count.
  if (std::find(moving.begin(), moving.end(), 0) == moving.end()) moving.clear();
}

void Island::FillPairs(const SceneTables& scene, const MovableTrees& all) {
  std::vector<int> body_pairs;
  std::vector<std::ptrdiff_t> ends;
  std::size_t pairs = 0;
  for (const int tree : trees) {
    const std::vector<int>& of_tree = all.BodyPairsOf(tree);
    body_pairs.insert(body_pairs.end(), of_tree.begin(), of_tree.end());
    ends.push_back(static_cast<std::ptrdiff_t>(body_pairs.size()));
  }
  SortRuns(std::move(ends), body_pairs);
  body_pairs.erase(std::unique(body_pairs.begin(), body_pairs.end()), body_pairs.end());
  for (const int k : body_pairs) pairs += scene.body_pairs[k].end - scene.body_pairs[k].begin;
  tables.body_pairs.reserve(body_pairs.size());
  tables.pairs.reserve(pairs);
  scene_pairs.reserve(pairs);
  for (const int k : body_pairs) {
    BodyPair bodies = scene.body_pairs[k];
    const bool both = Has(all.OfBody(bodies.body1)) && Has(all.OfBody(bodies.body2));
    const int begin = static_cast<int>(tables.pairs.size());
    for (int pair = bodies.begin; pair < bodies.end; ++pair) {
      tables.pairs.push_back(scene.pairs[pair]);
      // A joint of the island lies between it and all else.
      tables.pairs.back().moves = !both || scene.pairs[pair].moves;
      tables.has_sdf_pairs |= scene.pairs[pair].kind == PairKind::kSdf;
      tables.largest_kept = std::max(tables.largest_kept, scene.pairs[pair].kept);
      scene_pairs.push_back(pair);
    }
    bodies.begin = begin;
    bodies.end = static_cast<int>(tables.pairs.size());
    tables.body_pairs.push_back(bodies);
  }
}

}  // namespace mjcf_pdg
