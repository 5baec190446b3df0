#include "paper/successive_perturbation.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

namespace mjcf_pdg {

LinkTree::LinkTree(const SceneTables& tables) {
  const mjModel& m = *tables.model;
  link_of_body.assign(m.nbody, -1);
  std::vector<std::vector<int>> joints_of_body(m.nbody);
  for (int j = 0; j < static_cast<int>(tables.joints.size()); ++j) {
    joints_of_body[tables.joints[j].body].push_back(j);
  }
  for (int body = 1; body < m.nbody; ++body) {  // parents have smaller ids
    const int parent = link_of_body[m.body_parentid[body]];
    link_of_body[body] = parent;
    if (joints_of_body[body].empty()) continue;
    const int link = static_cast<int>(links.size());
    links.push_back(
        {body, parent, parent < 0 ? 0 : links[parent].depth + 1, {}, joints_of_body[body]});
    if (parent >= 0) links[parent].children.push_back(link);
    link_of_body[body] = link;
  }
}

bool LinkTree::IsBelow(int link, int ancestor) const {
  while (link > ancestor) link = links[link].parent;
  return link == ancestor;
}

SuccessivePerturbation::SuccessivePerturbation(Workspace& work)
    : problem_(work.problem()), work_(work), tree_(work.problem().tables) {}

const std::vector<LinkPair>& SuccessivePerturbation::Overlaps(const VectorXd& q) {
  const SceneTables& tables = problem_.tables;
  overlaps_.clear();
  work_.finder.Pose(q);
  for (const NearPair& near : work_.finder.Find(problem_.clearance, Depths::kSkipped)) {
    if (!problem_.Overlaps(near, problem_.tolerances.accept)) continue;
    const KeptPair& pair = tables.pairs[near.pair];
    overlaps_.push_back({tree_.link_of_body[tables.model->geom_bodyid[pair.geom1]],
                         tree_.link_of_body[tables.model->geom_bodyid[pair.geom2]]});
  }
  return overlaps_;
}

bool SuccessivePerturbation::SelfCollisionFree(const VectorXd& q) {
  auto root = [this](int link) {
    while (tree_.links[link].parent >= 0) link = tree_.links[link].parent;
    return link;
  };
  const std::vector<LinkPair>& overlaps = Overlaps(q);
  return std::none_of(overlaps.begin(), overlaps.end(), [&](const LinkPair& pair) {
    return pair.link1 >= 0 && pair.link2 >= 0 && root(pair.link1) == root(pair.link2);
  });
}

PerturbationResult SuccessivePerturbation::Run(const PerturbationOptions& options) {
  options_ = options;
  result_ = {};
  result_.q = problem_.q_in;
  ClampToLimits(problem_.tables, result_.q);
  result_.free = Preprocess() && RunAlgorithm1();
  return result_;
}

std::vector<int> SuccessivePerturbation::CollidingLinks() {
  ++result_.queries;
  std::vector<int> colliding;
  for (const LinkPair& pair : Overlaps(result_.q)) {
    for (const int link : {pair.link1, pair.link2}) {
      if (link >= 0) colliding.push_back(link);
    }
  }
  std::sort(colliding.begin(), colliding.end());
  colliding.erase(std::unique(colliding.begin(), colliding.end()), colliding.end());
  return colliding;
}

// Colliding links with several children, in ascending order of height, the root first: Alg. 1
// would stop at them.
bool SuccessivePerturbation::Preprocess() {
  std::vector<int> branching;
  for (const int link : CollidingLinks()) {
    if (tree_.links[link].children.size() >= 2) branching.push_back(link);
  }
  std::stable_sort(branching.begin(), branching.end(),
                   [this](int a, int b) { return tree_.links[a].depth < tree_.links[b].depth; });
  return std::all_of(branching.begin(), branching.end(),
                     [this](int link) { return Perturb(link, Scope::kLinkWithoutDescendants); });
}

bool SuccessivePerturbation::RunAlgorithm1() {
  std::vector<int> colliding = CollidingLinks();
  std::stable_sort(colliding.begin(), colliding.end(),
                   [this](int a, int b) { return tree_.links[a].depth > tree_.links[b].depth; });
  std::deque<int> L(colliding.begin(), colliding.end());
  while (!L.empty()) {
    int n = L.front();
    L.pop_front();
    if (Perturb(n, Scope::kSubtree)) continue;
    n = tree_.links[n].parent;
    if (n < 0) return false;  // the root failed
    if (tree_.links[n].children.size() >= 2) return false;
    if (std::find(L.begin(), L.end(), n) == L.end()) L.push_front(n);
  }
  ++result_.queries;
  return work_.Free(result_.q);
}

// Varies the link's inboard joints, nearest change first, until it succeeds; else leaves them.
bool SuccessivePerturbation::Perturb(int link, Scope scope) {
  if (Succeeds(link, scope, result_.q)) return true;
  tries_.clear();
  for (const int joint : tree_.links[link].joints) AppendTries(problem_.tables.joints[joint]);
  std::stable_sort(tries_.begin(), tries_.end(),
                   [](const Try& a, const Try& b) { return a.sigma < b.sigma; });
  for (Try& next : tries_) {
    if (result_.queries >= options_.max_queries || work_.Spent()) return false;
    if (!Succeeds(link, scope, next.q)) continue;
    result_.q = std::move(next.q);
    ++result_.perturbed;
    return true;
  }
  return false;
}

bool SuccessivePerturbation::Succeeds(int link, Scope scope, const VectorXd& q) {
  ++result_.queries;
  const std::vector<LinkPair>& overlaps = Overlaps(q);
  return std::none_of(overlaps.begin(), overlaps.end(), [&](const LinkPair& pair) {
    if (scope == Scope::kSubtree) {
      return tree_.IsBelow(pair.link1, link) || tree_.IsBelow(pair.link2, link);
    }
    return (pair.link1 == link && !tree_.IsBelow(pair.link2, link)) ||
           (pair.link2 == link && !tree_.IsBelow(pair.link1, link));
  });
}

void SuccessivePerturbation::AppendTries(const JointEntry& joint) {
  if (joint.type != mjJNT_BALL) AppendLinearTries(joint);
  if (joint.type == mjJNT_BALL || joint.type == mjJNT_FREE) AppendTurns(joint);
}

// Steps grow from the current value on; the last one reaches the end of the range.
double SuccessivePerturbation::Offset(int step, double range) const {
  const double all = std::pow(options_.growth, options_.steps) - 1.0;
  return range * (std::pow(options_.growth, step) - 1.0) / all;
}

// Hinges, slides and the translations of a free joint.
void SuccessivePerturbation::AppendLinearTries(const JointEntry& joint) {
  const bool free = joint.type == mjJNT_FREE;
  // A slide without limits is tried as far as the whole scene is wide.
  const double open = joint.type == mjJNT_HINGE ? M_PI : 2.0 * problem_.tables.model->stat.extent;
  for (int axis = 0; axis < (free ? 3 : 1); ++axis) {
    const double now = result_.q[joint.qadr + axis];
    const double up = joint.limited ? std::max(0.0, joint.hi - now) : open;
    const double down = joint.limited ? std::max(0.0, now - joint.lo) : open;
    for (int step = 1; step <= options_.steps; ++step) {
      for (const double change : {Offset(step, up), -Offset(step, down)}) {
        if (change == 0.0) continue;
        VectorXd q = result_.q;
        q[joint.qadr + axis] += change;
        ClampToLimits(problem_.tables, q);  // the last step by rounding
        AppendTry(std::move(q));
      }
    }
  }
}

// Turns of a ball, or of a free joint's body, about the world's axes, by up to half a turn.
void SuccessivePerturbation::AppendTurns(const JointEntry& joint) {
  work_.finder.Pose(result_.q);
  const Matrix3d R = AsMatrix(work_.finder.posed().data()->xmat + 9 * joint.body);
  VectorXd dq = VectorXd::Zero(problem_.tables.n), q;
  for (int axis = 0; axis < 3; ++axis) {
    for (int step = 1; step <= options_.steps; ++step) {
      for (const double sign : {1.0, -1.0}) {
        dq.segment<3>(RotationColumn(joint)) =
            sign * Offset(step, M_PI) * R.row(axis).transpose();  // in the body's frame
        Integrate(problem_.tables, result_.q, dq, q);
        const bool kept = !joint.limited || BallAngle(q.data() + joint.qadr) <= joint.hi;
        if (kept) AppendTry(q);
      }
    }
  }
}

void SuccessivePerturbation::AppendTry(VectorXd q) {
  const double sigma = work_.norm.Sigma(q);
  tries_.push_back({std::move(q), sigma});
}

}  // namespace mjcf_pdg
