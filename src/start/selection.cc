#include "start/selection.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::starts;

namespace {

struct Sphere {
  Vector3d center_W = Vector3d::Zero();
  double radius = 0.0;
};

// A geom's bounding sphere. A plane's is centred below `from_W`, along the normal, by the size of
// the scene; its radius is how deep from_W is below the plane.
Sphere Bound(const PosedModel& posed, int geom, const Vector3d& from_W, double size) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  const Vector3d center_W = AsVector(d.geom_xpos + 3 * geom);
  if (m.geom_type[geom] != mjGEOM_PLANE) return {center_W, m.geom_rbound[geom]};
  const Vector3d normal_W = AsMatrix(d.geom_xmat + 9 * geom).col(2);
  return {from_W - size * normal_W, std::max(0.0, normal_W.dot(center_W - from_W))};
}

// About the mean of the geoms' centres.
Sphere Enclose(const PosedModel& posed, const std::vector<int>& geoms, const Vector3d& from_W,
               double size) {
  Sphere sphere;
  for (int g : geoms) sphere.center_W += Bound(posed, g, from_W, size).center_W / geoms.size();
  for (int g : geoms) {
    const Sphere part = Bound(posed, g, from_W, size);
    const double reach = (part.center_W - sphere.center_W).norm() + part.radius;
    sphere.radius = std::max(sphere.radius, reach);
  }
  return sphere;
}

int TreeOf(const mjModel& m, int geom) { return m.body_treeid[m.geom_bodyid[geom]]; }

bool MovesBaseOf(const SceneTables& tables, int tree, const JointEntry& joint) {
  return tree >= 0 && joint.body == tables.model->tree_bodyadr[tree] &&
         (joint.type == mjJNT_SLIDE || joint.type == mjJNT_FREE);
}

// The tree with a base that can be translated in the deepest overlap with another one or the world,
// -1 if none.
int DeepestTree(const SceneTables& tables, const std::vector<NearPair>& overlaps) {
  auto has_free_base = [&](int tree) {
    return std::any_of(tables.joints.begin(), tables.joints.end(),
                       [&](const JointEntry& joint) { return MovesBaseOf(tables, tree, joint); });
  };
  int deepest_tree = -1;
  double deepest = 0.0;
  for (const NearPair& near : overlaps) {
    const KeptPair& pair = tables.pairs[near.pair];
    const int tree1 = TreeOf(*tables.model, pair.geom1), tree2 = TreeOf(*tables.model, pair.geom2);
    if (tree1 == tree2 || near.distance >= deepest) continue;
    const int tree = has_free_base(tree1) ? tree1 : tree2;
    if (!has_free_base(tree)) continue;
    deepest = near.distance;
    deepest_tree = tree;
  }
  return deepest_tree;
}

// No start needs more than half a turn.
void ShortenTurns(const SceneTables& tables, VectorXd& dq) {
  for (const JointEntry& joint : tables.joints) {
    if (joint.type == mjJNT_SLIDE) continue;
    for (int k = joint.type == mjJNT_FREE ? 3 : 0; k < joint.ndof; ++k) {
      dq[joint.col + k] = std::clamp(dq[joint.col + k], -mjPI, mjPI);
    }
  }
}

template <typename Item>
Item& Next(std::vector<Item>& items, int& used) {
  if (static_cast<int>(items.size()) == used) items.emplace_back();
  return items[used++];
}

}  // namespace

StartSelection::StartSelection(Workspace& work) : problem_(work.problem()), work_(work) {
  const SceneTables& tables = problem_.tables;
  int slides = 0;
  arms_.setConstant(tables.n, problem_.size);
  for (const JointEntry& joint : tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      if (!joint.Slides(k)) continue;
      arms_[joint.col + k] = 1.0;
      ++slides;
    }
  }
  open_.reserve(1 + 2 * slides);
  trial_.resize(tables.model->nq);
  // Rooms for the largest of everything, so that no later call needs more. Islands are made while a
  // scene is solved, and their configurations are long: there lists grow when they are needed.
  if (tables.moving_trees.empty()) {
    translations_.assign(1 + 2 * slides, trial_);
    found_.assign(translations_.size(), {trial_});
    rays_.assign(translations_.size(), VectorXd(tables.n));
  }
  for (VectorXd* per_dof : {&dq_, &hopped_, &scaled_, &steps_}) per_dof->resize(tables.n);
  r_.resize(work.norm.rows());
  J_.resize(work.norm.rows(), tables.n);
  between_.reserve(tables.n);
  free_.reserve(slides);
  touching_.reserve(tables.pairs.size());
  others_.reserve(tables.pairs.size());
  own_.reserve(tables.model->ngeom);
}

// steps_: how far each dof moves for a step of `length` [m] in object-norm units; dofs that the
// norm hardly sees are held back.
void StartSelection::FindDofSteps(const VectorXd& at, double length) {
  work_.norm.Linearize(at, r_, J_);
  steps_ = J_.colwise().norm().transpose().cwiseQuotient(arms_);  // gains, turns as arcs
  const double least = tune::kLeastGain * steps_.norm() / std::sqrt(steps_.size());
  steps_ = length * steps_.cwiseMax(least).cwiseProduct(arms_).cwiseInverse();
}

// between_: the dofs between the two bodies of a touching pair picked at random; all of them where
// nothing touches.
void StartSelection::MarkDofsOfSomeContact(const VectorXd& q, Random& random) {
  const SceneTables& tables = problem_.tables;
  const mjModel& m = *tables.model;
  const double reach = tune::kHoppable * problem_.tolerances.user;
  touching_.clear();
  work_.finder.Pose(q);
  for (const NearPair& near : work_.finder.Find(problem_.clearance + reach, Depths::kSkipped)) {
    const bool touches = near.distance < problem_.required[near.pair] + reach;
    if (touches && tables.pairs[near.pair].moves) touching_.push_back(near.pair);
  }
  between_.assign(tables.n, touching_.empty());
  if (touching_.empty()) return;
  const KeptPair& pair = tables.pairs[touching_[random.Bits() % touching_.size()]];
  int body1 = m.geom_bodyid[pair.geom1], body2 = m.geom_bodyid[pair.geom2];
  while (body1 != body2) {  // up to the common ancestor; parents have smaller ids
    int& body = body1 > body2 ? body1 : body2;
    for (const JointEntry& joint : tables.joints) {
      if (joint.body != body) continue;
      std::fill_n(between_.begin() + joint.col, joint.ndof, 1);
    }
    body = m.body_parentid[body];
  }
}

// from ⊕ t dq inside the limits.
void StartSelection::MoveTo(const VectorXd& from, const VectorXd& dq, double t, VectorXd& out) {
  scaled_ = t * dq;
  Integrate(problem_.tables, from, scaled_, out);
  ClampToLimits(problem_.tables, out);
}

void StartSelection::Mirrored(const VectorXd& q, VectorXd& start) {
  Beyond(problem_.q_in, q, -1.0, start);
}

void StartSelection::Gaussian(const VectorXd& center, double sigma, double spread, Random& random,
                              VectorXd& start) {
  const int n = problem_.tables.n;
  FindDofSteps(center, spread * std::sqrt(sigma / n));
  dq_.resize(n);
  const double share = random.Uniform() < 0.5 ? 0.5 : 1.0;
  for (int i = 0; i < n; ++i) {
    const bool stays = random.Uniform() >= share;
    dq_[i] = stays ? 0.0 : random.Normal() * steps_[i];
  }
  ShortenTurns(problem_.tables, dq_);
  Integrate(problem_.tables, center, dq_, start);
  ClampToLimits(problem_.tables, start);
}

void StartSelection::ContactHop(const VectorXd& best, double sigma, Hop hop, Random& random,
                                VectorXd& start) {
  const SceneTables& tables = problem_.tables;
  MarkDofsOfSomeContact(best, random);
  const double spread = tune::kHopSpreads[random.Bits() % std::size(tune::kHopSpreads)];
  FindDofSteps(problem_.q_in, spread * std::sqrt(sigma / tables.n));
  const double share = random.Uniform() < 0.5 ? 0.5 : 1.0;
  Difference(tables, problem_.q_in, best, dq_);
  hopped_ = dq_;
  for (int i = 0; i < tables.n; ++i) {
    if (!between_[i] || random.Uniform() >= share) continue;
    const double noise = random.Normal() * steps_[i];
    hopped_[i] = hop == Hop::kFromBest ? dq_[i] + noise : hop == Hop::kFromInput ? noise : -dq_[i];
  }
  scaled_ = hopped_;
  ShortenTurns(tables, scaled_);
  hopped_ = (hopped_.array() == dq_.array()).select(dq_, scaled_);  // what stays is not shortened
  Integrate(tables, problem_.q_in, hopped_, start);
  ClampToLimits(tables, start);
}

void StartSelection::Beyond(const VectorXd& center, const VectorXd& q, double times,
                            VectorXd& start) {
  Difference(problem_.tables, center, q, dq_);
  MoveTo(center, dq_, times, start);
}

void StartSelection::AddFound(const VectorXd& q) {
  FreeOnRay& found = Next(found_, num_found_);
  found.q = q;
  found.sigma = work_.norm.Sigma(q);
}

// At t the ray has been given up or is free; then its first free configuration between `before` and
// t has been found.
bool StartSelection::RayEnds(const VectorXd& center, int ray, double before, double t,
                             double& largest_sigma) {
  MoveTo(center, rays_[ray], t, trial_);
  if (work_.Spent() || work_.norm.Sigma(trial_) > largest_sigma) return true;
  if (!work_.Free(trial_)) return false;
  double overlapping = before;
  for (int halvings = 0; halvings < tune::kRayHalvings; ++halvings) {
    const double middle = 0.5 * (t + overlapping);
    MoveTo(center, rays_[ray], middle, trial_);
    (work_.Free(trial_) ? t : overlapping) = middle;
  }
  MoveTo(center, rays_[ray], t, trial_);
  AddFound(trial_);
  largest_sigma = std::min(largest_sigma, tune::kWorthARay * found_[num_found_ - 1].sigma);
  return true;
}

std::span<const FreeOnRay> StartSelection::FirstFree(const VectorXd& center,
                                                     std::span<const VectorXd> far,
                                                     double largest_sigma) {
  if (rays_.size() < far.size()) rays_.resize(far.size());
  open_.clear();
  for (std::size_t k = 0; k < far.size(); ++k) {
    Difference(problem_.tables, center, far[k], rays_[k]);
    open_.push_back(static_cast<int>(k));
  }
  num_found_ = 0;
  double before = 0.0;
  for (double t = tune::kFirstOnRay; before < 1.0 && !open_.empty();
       t = std::min(1.0, tune::kNextOnRay * t)) {
    std::erase_if(open_, [&](int ray) { return RayEnds(center, ray, before, t, largest_sigma); });
    before = t;
  }
  int kept = 0;
  for (int k = 0; k < num_found_; ++k) {
    if (found_[k].sigma > largest_sigma) continue;
    std::swap(found_[kept], found_[k]);
    // Among those before, after the ones that are no worse.
    for (int i = kept++; i > 0 && found_[i].sigma < found_[i - 1].sigma; --i) {
      std::swap(found_[i], found_[i - 1]);
    }
  }
  return {found_.data(), static_cast<std::size_t>(kept)};
}

void StartSelection::Uniform(const VectorXd& center, Random& random, VectorXd& start) {
  auto between = [&random](double low, double high) {
    return low + (high - low) * random.Uniform();
  };
  const double reach = tune::kUniformReach * problem_.size;
  dq_.resize(problem_.tables.n);
  for (const JointEntry& joint : problem_.tables.joints) {
    const bool scalar = joint.type == mjJNT_HINGE || joint.type == mjJNT_SLIDE;
    for (int k = 0; k < joint.ndof; ++k) {
      const double range = joint.Slides(k) ? reach : mjPI;
      dq_[joint.col + k] = between(-range, range);
    }
    if (!scalar || !joint.limited) continue;
    const double span = joint.type == mjJNT_SLIDE ? reach : joint.hi - joint.lo;
    const double low = std::max(joint.lo, center[joint.qadr] - span);
    const double high = std::min(joint.hi, center[joint.qadr] + span);
    dq_[joint.col] = between(low, high) - center[joint.qadr];
  }
  Integrate(problem_.tables, center, dq_, start);
  ClampToLimits(problem_.tables, start);
}

void StartSelection::FindBaseDirections(int tree) {
  free_.clear();
  for (const JointEntry& joint : problem_.tables.joints) {
    if (!MovesBaseOf(problem_.tables, tree, joint)) continue;
    if (joint.type == mjJNT_SLIDE) {
      const double* axis = work_.finder.posed().data()->xaxis + 3 * joint.id;
      free_.push_back({AsVector(axis), joint.col});
    } else {
      for (int i = 0; i < 3; ++i) free_.push_back({Vector3d::Unit(i), joint.col + i});
    }
  }
}

// own_: geoms of the tree; others_: the geoms of other trees or the world that it overlaps.
void StartSelection::SplitGeoms(int tree, const std::vector<NearPair>& overlaps) {
  const mjModel& m = *problem_.tables.model;
  auto in_tree = [&](int geom) { return TreeOf(m, geom) == tree; };
  own_.clear();
  others_.clear();
  for (int g = 0; g < m.ngeom; ++g) {
    if (in_tree(g) && (m.geom_contype[g] || m.geom_conaffinity[g])) own_.push_back(g);
  }
  for (const NearPair& near : overlaps) {
    const KeptPair& pair = problem_.tables.pairs[near.pair];
    if (in_tree(pair.geom1) == in_tree(pair.geom2)) continue;
    others_.push_back(in_tree(pair.geom1) ? pair.geom2 : pair.geom1);
  }
}

void StartSelection::AddTranslation(const VectorXd& from, double distance,
                                    const Vector3d& direction_W) {
  dq_.setZero(problem_.tables.n);
  for (const FreeDirection& f : free_) dq_[f.col] += distance * direction_W.dot(f.a_W);
  VectorXd& q = Next(translations_, num_translations_);
  Integrate(problem_.tables, from, dq_, q);
  ClampToLimits(problem_.tables, q);
}

std::span<const VectorXd> StartSelection::ConstrainedTranslation(
    const std::vector<NearPair>& overlaps, const VectorXd& from) {
  num_translations_ = 0;
  const int tree = DeepestTree(problem_.tables, overlaps);
  if (tree < 0) return {};
  work_.finder.Pose(from);
  const PosedModel& posed = work_.finder.posed();
  FindBaseDirections(tree);
  SplitGeoms(tree, overlaps);
  if (own_.empty() || others_.empty()) return {};
  const Sphere A = Enclose(posed, own_, Vector3d::Zero(), problem_.size);
  const Sphere B = Enclose(posed, others_, A.center_W, problem_.size);
  const double distance = A.radius + B.radius + problem_.clearance;
  const Vector3d d = (A.center_W - B.center_W).normalized();
  Vector3d projected = Vector3d::Zero();
  for (const FreeDirection& f : free_) projected += d.dot(f.a_W) * f.a_W;
  if (projected.norm() > 0.1) AddTranslation(from, distance, projected.normalized());
  for (const FreeDirection& f : free_) {
    AddTranslation(from, distance, f.a_W);
    AddTranslation(from, distance, -f.a_W);
  }
  return {translations_.data(), static_cast<std::size_t>(num_translations_)};
}

}  // namespace mjcf_pdg
