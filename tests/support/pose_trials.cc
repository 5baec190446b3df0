#include "tests/support/pose_trials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "collide/contacts.h"
#include "tests/support/brute_distance.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"
#include "verify/verifier.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kPosesOfAPair = 48;    // poses for each random pair of shapes, which is one model
constexpr double kTolerance = 1e-6;  // share of the scale
// Rounding errors that the oracle allows, as shares of the lengths involved: of a plane's gap, of a
// point inside a primitive, and of a point inside a hull. Faces of hulls are MuJoCo's, with
// vertices in single precision and corners merged by qhull.
constexpr double kPlaneRounding = 1e-13, kInsideRounding = 1e-9, kHullRounding = 2e-6;
// Of overlaps that are much deeper than the tolerance, one in this many is given to the slow
// oracle.
constexpr int kSlowlyAsked = 50;
constexpr double kWrongDepth = 1e-3;  // share of the smaller geom's radius
constexpr std::size_t kWordy = 10;    // most claims in PoseTrials::wrong

// A random size between a hundredth of the scale and the scale, log-uniform.
double Length(double scale, Random& rng) { return scale * std::pow(10.0, rng.Uniform(-2.0, 0.0)); }

Shape RandomConvex(int type, double scale, Random& rng) {
  Shape shape;
  shape.type = type;
  shape.size = {Length(scale, rng), Length(scale, rng), Length(scale, rng)};
  if (type != mjGEOM_MESH) return shape;
  const int count = rng.Chance(0.3) ? 4 + rng.Index(5) : 4 + rng.Index(197);
  for (int k = 0; k < count; ++k) {
    shape.vertices.push_back(rng.UnitVector().cwiseProduct(shape.size));
  }
  return shape;
}

std::string GeomText(const Shape& shape, const std::string& name, std::string& assets) {
  std::string text = "<geom name='" + name + "' mass='1' type='" + TypeName(shape.type) + "'";
  if (shape.type != mjGEOM_MESH) return text + " size='" + Join(shape.size) + "'/>";
  assets += "<mesh name='" + name + "' inertia='shell' vertex='";
  for (const Vector3d& p : shape.vertices) assets += Join(p) + " ";
  assets += "'/>";
  return text + " mesh='" + name + "'/>";
}

Vector3d At(const mjtNum* p) { return {p[0], p[1], p[2]}; }

// How deep the point is inside the geom [m]: negative outside, 0 on the surface, for an ellipsoid
// only roughly the distance.
double Inside(const mjModel& m, const mjData& d, int geom, const Vector3d& p_W) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(d.geom_xmat + 9 * geom);
  const Vector3d x = R.transpose() * (p_W - At(d.geom_xpos + 3 * geom));
  const Vector3d size = At(m.geom_size + 3 * geom);
  switch (m.geom_type[geom]) {
    case mjGEOM_PLANE:
      return -x.z();
    case mjGEOM_SPHERE:
      return size[0] - x.norm();
    case mjGEOM_CAPSULE:
      return size[0] - std::hypot(x.x(), x.y(), std::max(std::abs(x.z()) - size[1], 0.0));
    case mjGEOM_ELLIPSOID:
      return size.minCoeff() * (1.0 - x.cwiseQuotient(size).norm());
    case mjGEOM_CYLINDER:
      return std::min(size[0] - std::hypot(x.x(), x.y()), size[1] - std::abs(x.z()));
    case mjGEOM_BOX:
      return (size - x.cwiseAbs()).minCoeff();
  }
  const int mesh = m.geom_dataid[geom];
  const float* vertices = m.mesh_vert + 3 * m.mesh_vertadr[mesh];
  const auto vertex = [&](int k) {
    return Vector3d(vertices[3 * k], vertices[3 * k + 1], vertices[3 * k + 2]);
  };
  Vector3d middle = Vector3d::Zero();
  const int count = m.mesh_vertnum[mesh];
  for (int k = 0; k < count; ++k) middle += vertex(k) / count;
  const int* graph = m.mesh_graph + m.mesh_graphadr[mesh];
  const int* face = graph + 2 + 3 * graph[0] + 3 * graph[1];
  double inside = 1e300;
  for (int f = 0; f < graph[1]; ++f, face += 3) {
    const Vector3d a = vertex(face[0]);
    Vector3d n = (vertex(face[1]) - a).cross(vertex(face[2]) - a).normalized();
    if (n.dot(middle - a) > 0.0) n = -n;
    inside = std::min(inside, n.dot(a - x));
  }
  return inside;
}

// The poses of one model of two geoms, the second on a free joint.
class Trial {
 public:
  Trial(const Scene& scene, double scale, OtherLibrary library)
      : scene_(scene),
        m_(*scene.model()),
        scale_(scale),
        tolerance_(kTolerance * scale),
        verifier_(scene.verifier_model(), MakeOptions(tolerance_)),
        finder_(scene.tables()),
        library_(std::move(library)),
        data_(mj_makeData(&m_)),
        alone_(m_) {
    // With several contacts of a pair, MuJoCo 4.0.1 ends the process for some poses.
    alone_.opt.disableflags |= mjDSBL_MULTICCD;
  }

  // Poses the geoms at the configuration `q`: the pose of the second.
  void Pose(const std::vector<double>& q) {
    q_ = q;
    mju_copy(data_->qpos, q.data(), 7);
    mj_kinematics(&m_, data_.get());
    mj_comPos(&m_, data_.get());
  }
  // Moves the second geom along the normal of the certificate until its signed distance is about
  // `distance` [m]. Does nothing if the geoms are 1 m or more apart.
  void MoveTo(double distance) {
    const Verdict& verdict = verifier_.Check(q_);
    if (verdict.contacts.empty() && verdict.min_distance >= 1.0) return;
    const verify::Certificate found = verifier_.CertificateOf(0, 1);
    for (int k = 0; k < 3; ++k) q_[k] += (distance - found.gap) * found.n[k];
    Pose(q_);
  }

  // Compares the verifier's claim with the oracle, and counts it.
  void Judge(Random& rng, PoseTally& tally, PoseTrials& trials) {
    const bool free = verifier_.IsFree(q_);
    const bool agrees = verifier_.Check(q_).free == free;
    const verify::Certificate found = verifier_.CertificateOf(0, 1);
    ++tally.poses;
    if (found.proof == verify::Proof::kUnproven) {
      ++tally.unproven;
    } else {
      ++(free ? tally.free : tally.overlapping);
    }
    std::string wrong;
    if (!agrees) wrong = "IsFree and Check differ; ";
    if (free != (found.proof == verify::Proof::kPlane)) wrong += "no proof; ";
    wrong += free ? RefutePlane(found) : RefutePoints(found, rng, tally);
    if (found.proof != verify::Proof::kUnproven) {
      AskMujoco(free, tally);
      AskSolver(free, tally);
      AskLibrary(free, found.gap, tally);
    }
    if (wrong.empty()) return;
    if (++trials.wrong_count > static_cast<long>(kWordy)) return;
    trials.wrong.push_back(wrong + (free ? "free: " : "not free: ") + TypeName(m_.geom_type[0]) +
                           " " + Join(m_.geom_size, 3) + ", " + TypeName(m_.geom_type[1]) + " " +
                           Join(m_.geom_size + 3, 3) + ", scale " + Join(&scale_, 1) + ", q " +
                           Join(q_.data(), 7));
  }

 private:
  static Options MakeOptions(double tolerance) {
    Options options;
    options.tolerance = tolerance;
    return options;
  }
  double Lengths() const {
    return m_.geom_rbound[0] + m_.geom_rbound[1] + At(data_->geom_xpos + 3).norm();
  }

  // Says what is wrong with a claim "free": its plane must show an overlap of at most the
  // tolerance.
  std::string RefutePlane(const verify::Certificate& found) const {
    const double gap =
        m_.geom_type[0] == mjGEOM_PLANE
            ? BruteDistance(&m_, data_.get(), 0, 1).distance
            : -Support(&m_, data_.get(), 0, found.n) - Support(&m_, data_.get(), 1, -found.n);
    const bool unit = std::abs(found.n.norm() - 1.0) < 1e-12;
    if (unit && gap >= -tolerance_ - kPlaneRounding * Lengths()) return "";
    return "the plane shows an overlap of " + Join(&gap, 1) + "; ";
  }

  // Says what is wrong with a claim "not free": its point must be in both shapes, and the slow
  // oracle must find no plane that shows an overlap of at most the tolerance.
  std::string RefutePoints(const verify::Certificate& found, Random& rng, PoseTally& tally) {
    const bool hull = m_.geom_type[0] == mjGEOM_MESH || m_.geom_type[1] == mjGEOM_MESH;
    const double rounding = (hull ? kHullRounding : kInsideRounding) * Lengths();
    if (found.proof == verify::Proof::kPoints) {
      const double depth[] = {Inside(m_, *data_, 0, found.p1), Inside(m_, *data_, 1, found.p2)};
      if (!(depth[0] >= -rounding && depth[1] >= -rounding)) {
        return "the common point is outside: " + Join(depth, 2) + "; ";
      }
      const double apart = (found.p2 - found.p1).norm();
      if (!(apart <= kInsideRounding * Lengths())) {
        return "two points instead of one: " + Join(&apart, 1) + "; ";
      }
    }
    const bool clear = found.gap < -100.0 * tolerance_;
    if (clear && rng.Index(kSlowlyAsked) != 0) return "";
    const double brute = BruteDistance(&m_, data_.get(), 0, 1).distance;
    CompareDepth(brute, tally);
    if (brute < -tolerance_ + kPlaneRounding * Lengths()) return "";
    return "a plane shows an overlap of no more than " + Join(&brute, 1) + "; ";
  }

  void AskMujoco(bool free, PoseTally& tally) {
    mj_collision(&alone_, data_.get());
    double deepest = 0.0;
    for (int c = 0; c < data_->ncon; ++c) deepest = std::min(deepest, data_->contact[c].dist);
    const double distance = mj_geomDistance(&alone_, data_.get(), 0, 1, scale_, nullptr);
    tally.collision_missed += !free && data_->ncon == 0;
    tally.collision_invented += free && deepest < -tolerance_;
    tally.distance_missed += !free && !(distance < -tolerance_);
    tally.distance_invented += free && distance < -tolerance_;
  }

  // The solver's signed distance [m], cut off at the scale.
  double SolversDistance() {
    finder_.ForgetConvex();  // each pose for itself
    finder_.Pose(Eigen::Map<const Eigen::VectorXd>(q_.data(), 7));
    NearPair near;
    return finder_.Distance(0, scale_, near) ? near.distance : scale_;
  }
  void AskSolver(bool free, PoseTally& tally) {
    const double distance = SolversDistance();
    tally.solver_missed += !free && !(distance < -0.5 * tolerance_);
    tally.solver_invented += free && distance < -1.5 * tolerance_;
  }
  void CompareDepth(double truth, PoseTally& tally) {
    ++tally.depths;
    const bool plane = m_.geom_type[0] == mjGEOM_PLANE;
    const double size = plane ? m_.geom_rbound[1] : std::min(m_.geom_rbound[0], m_.geom_rbound[1]);
    tally.solver_wrong_depths += std::abs(SolversDistance() - truth) > kWrongDepth * size;
  }
  void AskLibrary(bool free, double gap, PoseTally& tally) const {
    const std::optional<bool> overlap = library_ ? library_(*data_) : std::nullopt;
    if (!overlap) return;
    ++tally.library_asked;
    tally.library_missed += !free && !*overlap;
    tally.library_invented += free && *overlap && gap > 0.5 * tolerance_;
  }

  const Scene& scene_;
  const mjModel& m_;
  const double scale_, tolerance_;
  Verifier verifier_;
  ContactFinder finder_;
  OtherLibrary library_;
  DataPtr data_;
  mjModel alone_;  // the copy of the model's struct that MuJoCo is asked with
  std::vector<double> q_;
};

// A rotation by quarter turns, and an offset at which faces, edges and middles meet.
std::vector<double> AlignedPose(const mjModel& m, Random& rng) {
  Eigen::Quaterniond r = Eigen::Quaterniond::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    r = r * Eigen::AngleAxisd(0.5 * M_PI * rng.Index(4), Vector3d::Unit(axis));
  }
  Vector3d p = Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double reach = m.geom_size[axis] + m.geom_size[3 + rng.Index(3)];
    p[axis] = 0.5 * (rng.Index(5) - 2) * reach;
  }
  return FreePose(p, r.normalized());
}

using LibraryOf = std::function<OtherLibrary(const mjModel&)>;

void RunPair(const std::array<int, 2>& types, const LibraryOf& library, Random& rng,
             PoseTrials& trials) {
  const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
  std::string assets;
  const std::string first = GeomText(RandomConvex(types[0], scale, rng), "g1", assets);
  const std::string second = GeomText(RandomConvex(types[1], scale, rng), "g2", assets);
  // An inertia of its own: that of a thin, tiny mesh may round to nothing.
  const Vector3d inertia = Vector3d::Constant(scale * scale);
  const Scene scene =
      Scene::FromString("<mujoco><asset>" + assets + "</asset><worldbody>" + first +
                        "<body><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='" +
                        Join(inertia) + "'/>" + second + "</body></worldbody></mujoco>");
  Trial trial(scene, scale, library ? library(*scene.model()) : OtherLibrary());
  for (int k = 0; k < kPosesOfAPair; ++k) {
    if (k % 4 == 0) {
      trial.Pose(AlignedPose(*scene.model(), rng));
      trial.Judge(rng, trials.aligned, trials);
      continue;
    }
    const double spread = scale * std::pow(10.0, rng.Uniform(-1.5, 0.0));
    trial.Pose(FreePose(rng.InBox(spread), rng.UnitQuat()));
    if (k % 4 == 1) {
      trial.Judge(rng, trials.random, trials);
      continue;
    }
    const double beyond[] = {1e-9, 1e-3, 0.05, 0.5, 2.0, 5.0};  // in tolerances
    const double sign = rng.Chance(0.5) ? 1.0 : -1.0;
    trial.MoveTo(kTolerance * scale * (sign * beyond[rng.Index(6)] - 1.0));
    trial.Judge(rng, trials.near, trials);
  }
}

}  // namespace

PoseTrials RunPoseTrials(long poses, std::uint64_t seed, const LibraryOf& library) {
  const std::vector<int> types = {mjGEOM_PLANE,    mjGEOM_SPHERE, mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                                  mjGEOM_CYLINDER, mjGEOM_BOX,    mjGEOM_MESH};
  Random rng(seed);
  PoseTrials trials;
  for (long done = 0; done < poses;) {
    for (std::size_t i = 0; i < types.size(); ++i) {
      for (std::size_t j = std::max<std::size_t>(i, 1); j < types.size() && done < poses; ++j) {
        RunPair({types[i], types[j]}, library, rng, trials);
        done += kPosesOfAPair;
      }
    }
  }
  return trials;
}

}  // namespace mjcf_pdg::test
