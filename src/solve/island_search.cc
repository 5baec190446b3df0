#include "solve/island_search.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/tuning.h"

namespace mjcf_pdg {
namespace {

namespace tune = tuning::islands;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

IslandSearch::Part::Part(const Workspace& scene, const MovableTrees& trees, std::vector<int> of,
                         Verifier& verifier)
    : island(scene.problem().tables, trees, std::move(of)),
      work(island.tables, scene.problem().options, scene.finder.posed().shared_data()),
      stages(work, verifier),
      at_rest(static_cast<Eigen::Index>(island.scene_pairs.size())) {}

IslandSearch::IslandSearch(Workspace& work, Verifier& verifier)
    : work_(work), verifier_(verifier), trees_(work.problem().tables) {
  outcome_.Reserve(static_cast<int>(work.problem().tables.model->nq));
  groups_.resize(trees_.count());
  held_ = trees_.OfHeld(work.problem().tables);
}

void IslandSearch::Seed(const std::vector<NearPair>& overlaps) {
  num_groups_ = 0;
  group_of_.assign(trees_.count(), -1);
  const Problem& problem = work_.problem();
  for (const NearPair& near : overlaps) {
    const KeptPair& pair = problem.tables.pairs[near.pair];
    const int tree1 = trees_.OfGeom(pair.geom1), tree2 = trees_.OfGeom(pair.geom2);
    if (tree1 >= 0) GroupOf(tree1);
    if (tree2 >= 0) GroupOf(tree2);
    if (tree1 >= 0 && tree2 >= 0) Unite(GroupOf(tree1), tree2);
  }
  for (const JointEntry& joint : problem.tables.joints) {
    if (LimitExcess(joint, problem.q_in) > 0.0) GroupOf(trees_.OfJoint(joint));
  }
  if (work_.equality.Violation(problem.q_in) > kEqualityTolerance) {
    for (const std::vector<int>& joined : held_) {
      for (const int tree : joined) GroupOf(tree);
    }
  }
  UniteHeld();
}

// The tree's group; a new one if it has none.
std::size_t IslandSearch::GroupOf(int tree) {
  if (group_of_[tree] < 0) {
    group_of_[tree] = static_cast<int>(num_groups_);
    Group& group = groups_[num_groups_++];
    group.trees.assign(1, tree);
    group.pending = true;
    group.blocked = group.free = group.candidate = false;
  }
  return static_cast<std::size_t>(group_of_[tree]);
}

// Trees that equality constraints or limited tendons join move together.
void IslandSearch::UniteHeld() {
  for (const std::vector<int>& joined : held_) {
    for (const int tree : joined) {
      if (group_of_[tree] < 0) continue;
      for (const int other : joined) Unite(static_cast<std::size_t>(group_of_[tree]), other);
    }
  }
}

// The tree, with all of its group, joins group `a`, which is to be solved again then.
void IslandSearch::Unite(std::size_t a, int tree) {
  const int b = group_of_[tree];
  if (b == static_cast<int>(a)) return;
  Group& group = groups_[a];
  group.pending = true;
  if (b < 0) {
    group.trees.push_back(tree);
  } else {
    // What is known of the two holds only while the other is as in q_in.
    group.free = group.candidate = false;
    group.trees.insert(group.trees.end(), groups_[b].trees.begin(), groups_[b].trees.end());
    groups_[b].trees.clear();
    groups_[b].pending = false;
  }
  for (const int of_group : group.trees) group_of_[of_group] = static_cast<int>(a);
  std::sort(group.trees.begin(), group.trees.end());
}

bool IslandSearch::Several() const {
  return std::count_if(groups_.begin(), groups_.begin() + static_cast<std::ptrdiff_t>(num_groups_),
                       [](const Group& group) { return !group.trees.empty(); }) > 1;
}

IslandSearch::Part& IslandSearch::PartOf(const std::vector<int>& trees) {
  for (const std::unique_ptr<Part>& part : parts_) {
    if (part->island.trees == trees) return *part;
  }
  auto part = std::make_unique<Part>(work_, trees_, trees, verifier_);
  if (parts_.size() < tune::kKept) {
    parts_.push_back(std::move(part));
    return *parts_.back();
  }
  parts_[next_part_] = std::move(part);
  Part& made = *parts_[next_part_];
  next_part_ = (next_part_ + 1) % tune::kKept;
  return made;
}

// A group that is to be solved; null: none.
IslandSearch::Group* IslandSearch::Pending() {
  for (Group& group : Groups()) {
    if (group.pending) return &group;
  }
  return nullptr;
}

bool IslandSearch::Run(const Input& input) {
  outcome_.Clear();
  Seed(input.overlaps);
  do {
    while (Group* group = Pending()) Solve(*group, input);
  } while (UniteTouching());
  Compose();
  bool free = true;
  for (const Group& group : Groups()) free &= group.trees.empty() || group.free;
  // Several islands were verified one by one.
  if (Several()) free = free && verifier_.IsFree(q_, input.q_in);
  const VectorXd* const hint = input.hint;
  if (!hint) return free;
  work_.ReferNorm();
  const double of_hint = work_.norm.Sigma(*hint);
  if (free && of_hint >= sigma_) return free;
  of_hint_.assign(hint->data(), hint->data() + hint->size());
  if (!verifier_.IsFree(of_hint_, input.q_in)) return free && verifier_.IsFree(q_, input.q_in);
  q_ = of_hint_;
  sigma_ = of_hint;
  start_ = Component::kUserPose;
  return true;
}

void IslandSearch::Solve(Group& group, const Input& input) {
  group.pending = false;
  if (group.free && work_.Spent()) return;
  Part& part = PartOf(group.trees);
  const std::int64_t queries = part.stages.Queries(), verified = verifier_.queries();
  const std::int64_t lcp_steps = part.stages.strategy->lcp_steps();
  BeginPart(part, input);
  const bool helps = group.free && !group.blocked && Helps(part, group);
  if (group.blocked || !group.free || helps) {
    known_ = helps ? pushed_.q : group.q;
    SearchAndAccept(part, input, group);
  }
  queries_ += part.stages.Queries() - queries;
  lcp_steps_ += part.stages.strategy->lcp_steps() - lcp_steps;
  work_.budget.Charge(part.stages.Queries() - queries + verifier_.queries() - verified);
}

// The scene's problem, restricted to the island.
void IslandSearch::BeginPart(Part& part, const Input& input) {
  const Problem& problem = work_.problem();
  if (input.at_rest) {
    for (std::size_t k = 0; k < part.island.scene_pairs.size(); ++k) {
      part.at_rest[static_cast<Eigen::Index>(k)] = (*input.at_rest)[part.island.scene_pairs[k]];
    }
  }
  part.work.Begin(problem.q_in, problem.mocap, input.at_rest ? &part.at_rest : nullptr);
  part.work.equality.SetActive(work_.equality.active());
  part.work.recorder = work_.recorder;
  part.work.budget = work_.budget.For(part.work.finder.queries(), work_.finder.queries());
  if (!input.hint) return;
  part.hint = problem.q_in;
  SetMovable(part.island.tables, *input.hint, part.hint);
}

void IslandSearch::SearchAndAccept(Part& part, const Input& input, Group& group) {
  const VectorXd* const hint = input.hint ? &part.hint : nullptr;
  const std::int64_t before = part.work.finder.distances();
  const std::vector<NearPair>& overlaps = part.work.OverlapsAtInput();
  const int distances = static_cast<int>(part.work.finder.distances() - before);
  Outcome& found = part.stages.Search(overlaps, distances, hint, group.free ? &known_ : nullptr);
  group.sigma_lower_bound = part.stages.sigma_lower_bound();
  outcome_.starts += found.starts;
  outcome_.iterations += found.iterations;
  if (Several()) {
    const SceneTables& tables = part.island.tables;
    verifier_.SetScope({tables.body_moves, tables.held_equalities, tables.held_tendons});
  }
  Acceptance& acceptance = part.stages.acceptance;
  acceptance.Begin(input.q_in);
  if (acceptance.Accept(found, hint)) {
    accepted_ = Eigen::Map<const VectorXd>(acceptance.q().data(), work_.problem().q_in.size());
    Keep(part, group, {accepted_, acceptance.start(), true});
  } else if (!group.free) {
    group.candidate = !found.free.empty();
    if (group.candidate || found.has_overlap) {
      const Candidate& best = group.candidate ? found.free.front() : found.least_overlap;
      Keep(part, group, {best.q, best.start, false});
    } else {
      Keep(part, group, {work_.problem().q_in, Component::kNone, false});
    }
  }
  verifier_.SetScope({});
  if (!work_.Spent()) LetTouchedJoin(part, found, group);
}

// Trees that the answer touches, and those that stopped a start which was nearer than that.
void IslandSearch::LetTouchedJoin(Part& part, const Outcome& found, Group& group) {
  const std::size_t index = static_cast<std::size_t>(&group - groups_.data());
  UniteTouched(index, part.work, group.q);
  const bool blocked = found.nearest_overlap.sigma < (group.free ? group.sigma : kInfinity);
  group.blocked = blocked && UniteTouched(index, part.work, found.nearest_overlap.q);
}

// Whether the answer of an island comes nearer where a tree that it touches can move as well: one
// descent from there. Most trees that are touched only stand in no one's way.
bool IslandSearch::Helps(Part& part, const Group& group) {
  pushed_.q = group.q;
  pushed_.sigma = group.sigma;
  return part.stages.strategy->Polish(pushed_) && pushed_.sigma < tune::kHelps * group.sigma;
}

// The answer of an island that has grown counts if it is nearer.
void IslandSearch::Keep(Part& part, Group& group, const Answer& answer) {
  const double sigma = part.work.norm.Sigma(answer.q);
  if (group.free && !(sigma < group.sigma)) return;
  group.free = answer.free;
  group.sigma = sigma;
  group.q = answer.q;
  group.start = answer.start;
}

// Calls join(tree1, tree2), which says whether it has united anything, for the movable trees (-1:
// what nothing moves) of each pair that touches or overlaps at q. Returns whether something is
// united.
template <typename Join>
bool IslandSearch::UniteWhereTouching(Workspace& work, const VectorXd& q, const Join& join) {
  const Problem& problem = work.problem();
  const double touching = tune::kTouching * problem.tolerances.user;
  bool united = false;
  work.finder.Pose(q);
  for (const NearPair& near : work.finder.Find(problem.clearance + touching, Depths::kSkipped)) {
    if (near.distance > problem.required[near.pair] + touching) continue;
    const KeptPair& pair = problem.tables.pairs[near.pair];
    united |= join(trees_.OfGeom(pair.geom1), trees_.OfGeom(pair.geom2));
  }
  if (united) UniteHeld();
  return united;
}

// The trees that an island touches or overlaps at q join its group. Returns whether there are some.
bool IslandSearch::UniteTouched(std::size_t of, Workspace& work, const VectorXd& q) {
  return UniteWhereTouching(work, q, [&](int tree1, int tree2) {
    bool united = false;
    for (const int tree : {tree1, tree2}) {
      if (tree < 0 || group_of_[tree] == static_cast<int>(of)) continue;
      Unite(of, tree);
      united = true;
    }
    return united;
  });
}

// Where answers of different groups touch, those groups are united. Returns whether some are.
bool IslandSearch::UniteTouching() {
  if (!Several() || work_.Spent()) return false;
  Compose();
  return UniteWhereTouching(work_, composed_, [&](int tree1, int tree2) {
    if (tree1 < 0 || tree2 < 0) return false;
    const int group1 = group_of_[tree1], group2 = group_of_[tree2];
    if (group1 < 0 || group2 < 0 || group1 == group2) return false;
    Unite(static_cast<std::size_t>(group1), tree2);
    return true;
  });
}

// All answers side by side.
void IslandSearch::Compose() {
  composed_ = work_.problem().q_in;
  sigma_ = sigma_lower_bound_ = 0.0;
  double costliest = -kInfinity;
  bool free = true, candidate = true;
  for (const Group& group : Groups()) {
    if (group.trees.empty()) continue;
    sigma_ += group.sigma;
    sigma_lower_bound_ += group.sigma_lower_bound;
    free &= group.free;
    candidate &= group.free || group.candidate;
    if (group.sigma > costliest) {
      costliest = group.sigma;
      start_ = group.start;
    }
  }
  for (const JointEntry& joint : work_.problem().tables.joints) {
    const int group = group_of_[trees_.OfJoint(joint)];
    if (group < 0) continue;
    composed_.segment(joint.qadr, QposEntries(joint)) =
        groups_[group].q.segment(joint.qadr, QposEntries(joint));
  }
  q_.assign(composed_.data(), composed_.data() + composed_.size());
  outcome_.free.Clear();
  outcome_.has_overlap = !free && !candidate;
  if (candidate) outcome_.free.Insert(composed_, sigma_, start_);
  if (outcome_.has_overlap) outcome_.least_overlap = {composed_, sigma_, start_};
}

}  // namespace mjcf_pdg
