#include "start/selection.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace mjcf_pdg {
namespace {

constexpr double kTouching = 20.0;           // of the tolerance
constexpr double kFirstOnRay = 1.0 / 256.0;  // share of the way
constexpr double kNextOnRay = 1.2;           // times the share before
constexpr int kRayHalvings = 2;
constexpr double kWorthARay = 2.0;                 // σ over that of the nearest found
constexpr double kHopSpreads[] = {3.0, 7.5, 1.5};  // as in GaussianStart, one at random

struct Sphere {
  Vector3d center_W = Vector3d::Zero();
  double radius = 0.0;
};

// A geom's bounding sphere. A plane's is centred 1 m below `from_W` along the normal; its radius is
// how deep from_W is below the plane.
Sphere Bound(const PosedModel& posed, int geom, const Vector3d& from_W) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  const Vector3d center_W = AsVector(d.geom_xpos + 3 * geom);
  if (m.geom_type[geom] != mjGEOM_PLANE) return {center_W, m.geom_rbound[geom]};
  const Vector3d normal_W = AsMatrix(d.geom_xmat + 9 * geom).col(2);
  return {from_W - normal_W, std::max(0.0, normal_W.dot(center_W - from_W))};
}

// About the mean of the geoms' centres.
Sphere Enclose(const PosedModel& posed, const std::vector<int>& geoms, const Vector3d& from_W) {
  Sphere sphere;
  for (int g : geoms) sphere.center_W += Bound(posed, g, from_W).center_W / geoms.size();
  for (int g : geoms) {
    const Sphere part = Bound(posed, g, from_W);
    const double reach = (part.center_W - sphere.center_W).norm() + part.radius;
    sphere.radius = std::max(sphere.radius, reach);
  }
  return sphere;
}

// A direction in which a tree's base may be translated, and the tangent that does it.
struct FreeDirection {
  Vector3d a_W;
  int col = 0;
};

int TreeOf(const mjModel& m, int geom) { return m.body_treeid[m.geom_bodyid[geom]]; }

bool MovesBaseOf(const SceneTables& tables, int tree, const JointEntry& joint) {
  return tree >= 0 && joint.body == tables.model->tree_bodyadr[tree] &&
         (joint.type == mjJNT_SLIDE || joint.type == mjJNT_FREE);
}

std::vector<FreeDirection> BaseDirections(Workspace& work, int tree) {
  std::vector<FreeDirection> directions;
  for (const JointEntry& joint : work.problem().tables.joints) {
    if (!MovesBaseOf(work.problem().tables, tree, joint)) continue;
    if (joint.type == mjJNT_SLIDE) {
      const double* axis = work.finder.posed().data()->xaxis + 3 * joint.id;
      directions.push_back({AsVector(axis), joint.col});
    } else {
      for (int i = 0; i < 3; ++i) directions.push_back({Vector3d::Unit(i), joint.col + i});
    }
  }
  return directions;
}

// Geoms of the tree, and the geoms of other trees or the world that it overlaps.
void SplitGeoms(const SceneTables& tables, int tree, const std::vector<NearPair>& overlaps,
                std::vector<int>& own, std::vector<int>& others) {
  const mjModel& m = *tables.model;
  auto in_tree = [&](int geom) { return TreeOf(m, geom) == tree; };
  for (int g = 0; g < m.ngeom; ++g) {
    if (in_tree(g) && (m.geom_contype[g] || m.geom_conaffinity[g])) own.push_back(g);
  }
  for (const NearPair& near : overlaps) {
    const KeptPair& pair = tables.pairs[near.pair];
    if (in_tree(pair.geom1) == in_tree(pair.geom2)) continue;
    others.push_back(in_tree(pair.geom1) ? pair.geom2 : pair.geom1);
  }
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

// How far each dof moves for a step of `length` [m] in object-norm units; dofs that the norm hardly
// sees are held back.
VectorXd DofSteps(Workspace& work, const VectorXd& at, double length) {
  VectorXd r;
  MatrixXd J;
  work.norm.Linearize(at, r, J);
  const double floor = 1e-3 * J.norm() / std::sqrt(J.cols());
  return length * J.colwise().norm().cwiseMax(floor).cwiseInverse().transpose();
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

// Marks (n) the dofs between the two bodies of a touching pair picked at random; all of them where
// nothing touches.
std::vector<char> DofsOfSomeContact(Workspace& work, const VectorXd& q, Random& random) {
  const SceneTables& tables = work.problem().tables;
  const mjModel& m = *tables.model;
  const double reach = kTouching * work.problem().tolerances.user;
  std::vector<int> touching;
  work.finder.Pose(q);
  for (const NearPair& near :
       work.finder.Find(work.problem().options.clearance + reach, Depths::kSkipped)) {
    const bool touches = near.distance < work.problem().required[near.pair] + reach;
    if (touches && tables.pairs[near.pair].moves) touching.push_back(near.pair);
  }
  if (touching.empty()) return std::vector<char>(tables.n, 1);
  std::vector<char> between(tables.n, 0);
  const KeptPair& pair = tables.pairs[touching[random.Bits() % touching.size()]];
  int body1 = m.geom_bodyid[pair.geom1], body2 = m.geom_bodyid[pair.geom2];
  while (body1 != body2) {  // up to the common ancestor; parents have smaller ids
    int& body = body1 > body2 ? body1 : body2;
    for (const JointEntry& joint : tables.joints) {
      if (joint.body != body) continue;
      std::fill_n(between.begin() + joint.col, joint.ndof, 1);
    }
    body = m.body_parentid[body];
  }
  return between;
}

// Configurations in a straight line from one through another, inside the limits.
class Ray {
 public:
  Ray(Workspace& work, const VectorXd& from, const VectorXd& through)
      : tables_(&work.problem().tables), from_(from) {
    Difference(*tables_, from, through, dq_);
  }
  VectorXd At(double t) const {
    VectorXd q;
    Integrate(*tables_, from_, t * dq_, q);
    ClampToLimits(*tables_, q);
    return q;
  }

 private:
  const SceneTables* tables_;
  VectorXd from_;
  VectorXd dq_;
};

}  // namespace

VectorXd MirroredStart(Workspace& work, const VectorXd& q) {
  return Ray(work, work.problem().q_in, q).At(-1.0);
}

VectorXd GaussianStart(Workspace& work, const VectorXd& center, double sigma, double spread,
                       Random& random) {
  const VectorXd steps =
      DofSteps(work, center, spread * std::sqrt(sigma / work.problem().tables.n));
  VectorXd dq(work.problem().tables.n), out;
  const double share = random.Uniform() < 0.5 ? 0.5 : 1.0;
  for (int i = 0; i < work.problem().tables.n; ++i) {
    const bool stays = random.Uniform() >= share;
    dq[i] = stays ? 0.0 : random.Normal() * steps[i];
  }
  ShortenTurns(work.problem().tables, dq);
  Integrate(work.problem().tables, center, dq, out);
  ClampToLimits(work.problem().tables, out);
  return out;
}

VectorXd ContactHop(Workspace& work, const VectorXd& best, double sigma, Hop hop, Random& random) {
  const SceneTables& tables = work.problem().tables;
  const std::vector<char> between = DofsOfSomeContact(work, best, random);
  const double spread = kHopSpreads[random.Bits() % std::size(kHopSpreads)];
  const VectorXd steps = DofSteps(work, work.problem().q_in, spread * std::sqrt(sigma / tables.n));
  const double share = random.Uniform() < 0.5 ? 0.5 : 1.0;
  VectorXd dq, out;
  Difference(tables, work.problem().q_in, best, dq);
  VectorXd hopped = dq;
  for (int i = 0; i < tables.n; ++i) {
    if (!between[i] || random.Uniform() >= share) continue;
    const double noise = random.Normal() * steps[i];
    hopped[i] = hop == Hop::kFromBest ? dq[i] + noise : hop == Hop::kFromInput ? noise : -dq[i];
  }
  VectorXd shortened = hopped;
  ShortenTurns(tables, shortened);
  const VectorXd tangent = (hopped.array() == dq.array()).select(dq, shortened);
  Integrate(tables, work.problem().q_in, tangent, out);
  ClampToLimits(tables, out);
  return out;
}

std::vector<FreeOnRay> FirstFree(Workspace& work, const VectorXd& center,
                                 const std::vector<VectorXd>& far, double largest_sigma) {
  std::vector<Ray> rays;
  for (const VectorXd& q : far) rays.emplace_back(work, center, q);
  std::vector<FreeOnRay> found;
  double before = 0.0;
  // The ray's first free configuration between `before` and t, if that at t is free.
  auto ends = [&](const Ray& ray, double t) {
    VectorXd q = ray.At(t);
    if (work.Spent() || work.norm.Sigma(q) > largest_sigma) return true;
    if (!work.Free(q)) return false;
    double overlapping = before;
    for (int halvings = 0; halvings < kRayHalvings; ++halvings) {
      const double middle = 0.5 * (t + overlapping);
      (work.Free(ray.At(middle)) ? t : overlapping) = middle;
    }
    q = ray.At(t);
    found.push_back({q, work.norm.Sigma(q)});
    largest_sigma = std::min(largest_sigma, kWorthARay * found.back().sigma);
    return true;
  };
  for (double t = kFirstOnRay; before < 1.0 && !rays.empty(); t = std::min(1.0, kNextOnRay * t)) {
    std::erase_if(rays, [&](const Ray& ray) { return ends(ray, t); });
    before = t;
  }
  std::erase_if(found, [&](const FreeOnRay& free) { return free.sigma > largest_sigma; });
  std::stable_sort(found.begin(), found.end(),
                   [](const FreeOnRay& x, const FreeOnRay& y) { return x.sigma < y.sigma; });
  return found;
}

VectorXd Beyond(Workspace& work, const VectorXd& center, const VectorXd& q, double times) {
  return Ray(work, center, q).At(times);
}

VectorXd UniformStart(Workspace& work, const VectorXd& center, Random& random) {
  auto between = [&random](double low, double high) {
    return low + (high - low) * random.Uniform();
  };
  const double reach = 10.0 * work.problem().size;
  VectorXd dq(work.problem().tables.n), q;
  for (const JointEntry& joint : work.problem().tables.joints) {
    const bool scalar = joint.type == mjJNT_HINGE || joint.type == mjJNT_SLIDE;
    for (int k = 0; k < joint.ndof; ++k) {
      const double range = joint.Slides(k) ? reach : mjPI;
      dq[joint.col + k] = between(-range, range);
    }
    if (!scalar || !joint.limited) continue;
    const double span = joint.type == mjJNT_SLIDE ? reach : joint.hi - joint.lo;
    const double low = std::max(joint.lo, center[joint.qadr] - span);
    const double high = std::min(joint.hi, center[joint.qadr] + span);
    dq[joint.col] = between(low, high) - center[joint.qadr];
  }
  Integrate(work.problem().tables, center, dq, q);
  ClampToLimits(work.problem().tables, q);
  return q;
}

std::vector<VectorXd> ConstrainedTranslation(Workspace& work, const std::vector<NearPair>& overlaps,
                                             const VectorXd& from) {
  const SceneTables& tables = work.problem().tables;
  std::vector<VectorXd> starts;
  const int tree = DeepestTree(tables, overlaps);
  if (tree < 0) return starts;
  work.finder.Pose(from);
  const PosedModel& posed = work.finder.posed();
  const std::vector<FreeDirection> free = BaseDirections(work, tree);
  std::vector<int> own, others;
  SplitGeoms(tables, tree, overlaps, own, others);
  if (own.empty() || others.empty()) return starts;
  const Sphere A = Enclose(posed, own, Vector3d::Zero());
  const Sphere B = Enclose(posed, others, A.center_W);
  const double distance = A.radius + B.radius + work.problem().options.clearance;

  auto translate = [&](const Vector3d& direction_W) {
    VectorXd dq = VectorXd::Zero(tables.n), q;
    for (const FreeDirection& f : free) dq[f.col] += distance * direction_W.dot(f.a_W);
    Integrate(tables, from, dq, q);
    ClampToLimits(tables, q);
    starts.push_back(q);
  };
  const Vector3d d = (A.center_W - B.center_W).normalized();
  Vector3d projected = Vector3d::Zero();
  for (const FreeDirection& f : free) projected += d.dot(f.a_W) * f.a_W;
  if (projected.norm() > 0.1) translate(projected.normalized());
  for (const FreeDirection& f : free) {
    translate(f.a_W);
    translate(-f.a_W);
  }
  return starts;
}

}  // namespace mjcf_pdg
