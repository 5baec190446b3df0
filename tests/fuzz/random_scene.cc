#include "tests/fuzz/random_scene.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;

std::string Text(double value) { return Join(&value, 1); }
std::string Text(const Vector3d& v) { return Join(v.data(), 3); }

double LogUniform(double low, double high, Random& rng) {
  return std::exp(rng.Uniform(std::log(low), std::log(high)));
}

// What has been drawn so far, and what may be referred to by name.
class Draft {
 public:
  Draft(double scale, Random& rng) : scale_(scale), rng_(rng) {}

  void AddBody(int parent, bool moves);
  void AddObstacle(bool mocap);
  void AddRelations();
  std::string Xml() const;

 private:
  struct Body {
    int parent = -1;  // -1: the world
    std::string head, inside;
  };

  std::string Pose(double spread);
  std::string Geom();
  std::string Joint();
  std::string CoupledJoints();
  void AddEquality();
  void AddTendon();
  std::string AnyBody() {
    return "b" + std::to_string(rng_.Index(static_cast<int>(bodies_.size())));
  }
  std::string AnyGeom() { return "g" + std::to_string(rng_.Index(geoms_)); }
  const std::string& AnyScalarJoint() {
    return scalar_joints_[rng_.Index(static_cast<int>(scalar_joints_.size()))];
  }

  const double scale_;
  Random& rng_;
  std::vector<Body> bodies_;
  std::vector<std::string> scalar_joints_;
  std::string assets_, contact_, equality_, tendon_;
  std::string last_geom_;  // its attributes, for coincident geoms
  int geoms_ = 0, joints_ = 0, fixed_tendons_ = 0, tendons_ = 0;
};

std::string Draft::Pose(double spread) {
  if (rng_.Chance(0.1)) return "";  // where its parent is
  const Eigen::Quaterniond r = rng_.Chance(0.2) ? Eigen::Quaterniond::Identity() : rng_.UnitQuat();
  const double quat[] = {r.w(), r.x(), r.y(), r.z()};
  return " pos='" + Text(rng_.InBox(spread * scale_)) + "' quat='" + Join(quat, 4) + "'";
}

std::string Draft::Geom() {
  const std::string name = "g" + std::to_string(geoms_++);
  if (!last_geom_.empty() && rng_.Chance(0.15)) return "<geom name='" + name + last_geom_;
  const std::vector<int>& types = ConvexTypes();
  int type = mjGEOM_PLANE;
  while (type == mjGEOM_PLANE) type = types[rng_.Index(static_cast<int>(types.size()))];
  // Sizes span three orders inside one scene: needles, plates, specks.
  const auto length = [this] { return scale_ * LogUniform(3e-3, 1.0, rng_); };
  const Vector3d size(length(), length(), length());
  std::string shape = " size='" + Text(size) + "'";
  if (type == mjGEOM_MESH) {
    assets_ += "<mesh name='" + name + "' inertia='shell' vertex='";
    const int count = 4 + rng_.Index(rng_.Chance(0.5) ? 6 : 60);
    for (int k = 0; k < count; ++k) {
      assets_ += Text(rng_.UnitVector().cwiseProduct(size)) + " ";
    }
    assets_ += "'/>";
    shape = " mesh='" + name + "'";
  }
  std::string more;
  if (rng_.Chance(0.1)) more += " margin='" + Text(0.1 * scale_ * rng_.Uniform()) + "'";
  if (rng_.Chance(0.1)) more += " gap='" + Text(0.1 * scale_ * rng_.Uniform()) + "'";
  if (rng_.Chance(0.1)) more += " contype='" + std::to_string(rng_.Index(4)) + "'";
  if (rng_.Chance(0.1)) more += " conaffinity='" + std::to_string(rng_.Index(4)) + "'";
  last_geom_ = "' type='" + TypeName(type) + "'" + shape + " mass='" +
               Text(LogUniform(1e-6, 1e6, rng_)) + "'" + more + Pose(0.5) + "/>";
  return "<geom name='" + name + last_geom_;
}

std::string Draft::Joint() {
  const std::string name = "j" + std::to_string(joints_++);
  const int kind = rng_.Index(5);  // hinges and slides twice
  const std::string head = "<joint name='" + name + "'";
  const std::string pos = " pos='" + Text(rng_.InBox(0.5 * scale_)) + "'";
  if (kind == 4) {
    const std::string range =
        rng_.Chance(0.5) ? " range='0 " + Text(rng_.Uniform(0.01, 3.1)) + "'" : "";
    return head + " type='ball'" + pos + range + "/>";
  }
  scalar_joints_.push_back(name);
  const bool slide = kind < 2;
  const double unit = slide ? scale_ : 1.0;
  const double low = unit * rng_.Uniform(-2.0, 0.1), width = unit * LogUniform(1e-3, 3.0, rng_);
  std::string more = pos + " axis='" + Text(rng_.UnitVector()) + "'";
  if (rng_.Chance(0.5)) more += " range='" + Text(low) + " " + Text(low + width) + "'";
  if (rng_.Chance(0.1)) more += " ref='" + Text(unit * rng_.Uniform(-1.0, 1.0)) + "'";
  return head + (slide ? " type='slide'" : "") + more + "/>";
}

void Draft::AddBody(int parent, bool moves) {
  Body body;
  body.parent = parent;
  body.head = "<body name='b" + std::to_string(bodies_.size()) + "'" + Pose(1.0) + ">";
  if (moves && parent < 0 && rng_.Chance(0.5)) {
    body.inside = "<freejoint name='j" + std::to_string(joints_++) + "'/>";
  } else if (moves) {
    // MuJoCo lets no rotation follow a ball.
    for (int k = rng_.Index(3); k >= 0 && body.inside.find("'ball'") == std::string::npos; --k) {
      body.inside += Joint();
    }
  }
  for (int k = rng_.Index(3); k >= 0; --k) body.inside += Geom();
  if (rng_.Chance(0.3)) {
    body.inside += "<site name='s" + std::to_string(bodies_.size()) + "' size='" +
                   Text(0.01 * scale_) + "'" + Pose(0.5) + "/>";
  }
  bodies_.push_back(body);
}

void Draft::AddObstacle(bool mocap) {
  AddBody(-1, false);
  if (mocap) bodies_.back().head.insert(5, " mocap='true'");
}

void Draft::AddTendon() {
  const std::string name = "t" + std::to_string(tendons_++);
  const double low = rng_.Uniform(-1.0, 1.0), high = low + rng_.Uniform(0.01, 2.0);
  const std::string range = rng_.Chance(0.3) ? " range='" + Text(low) + " " + Text(high) + "'" : "";
  if (scalar_joints_.size() >= 2) {
    // Coefficients per unit of length, so that the tendon's length is as the joints' ranges are.
    tendon_ += "<fixed name='" + name + "'" + range + "><joint joint='" + AnyScalarJoint() +
               "' coef='" + Text(rng_.Uniform(-2.0, 2.0)) + "'/></fixed>";
    return;
  }
  std::string sites;
  int found = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::string site = "s" + std::to_string(b);
    if (bodies_[b].inside.find("'" + site + "'") == std::string::npos) continue;
    sites += "<site site='" + site + "'/>";
    ++found;
  }
  if (found < 2) {
    --tendons_;
    return;
  }
  tendon_ += "<spatial name='" + name + "'>" + sites + "</spatial>";
}

std::string Draft::CoupledJoints() {
  const std::string one = AnyScalarJoint(), other = AnyScalarJoint();
  const bool two = one != other && rng_.Chance(0.8);
  return "<joint joint1='" + one + "'" + (two ? " joint2='" + other + "'" : "");
}

void Draft::AddEquality() {
  const std::string active = rng_.Chance(0.2) ? " active='false'" : "";
  const double data[] = {0.1 * rng_.Uniform(), rng_.Uniform(-2.0, 2.0),
                         rng_.Chance(0.5) ? 0.3 : 0.0, 0.0, 0.0};
  const std::string poly = " polycoef='" + Join(data, 5) + "'";
  const std::string one = AnyBody(), other = AnyBody();
  switch (rng_.Index(4)) {
    case 0:
      if (scalar_joints_.empty()) return;
      equality_ += CoupledJoints() + poly + active + "/>";
      return;
    case 1:
      if (tendons_ < 2) return;
      equality_ += "<tendon tendon1='t0' tendon2='t1'" + poly + active + "/>";
      return;
    case 2:
      equality_ += "<connect body1='" + one + "'" +
                   (rng_.Chance(0.7) && one != other ? " body2='" + other + "'" : "") +
                   " anchor='" + Text(rng_.InBox(0.5 * scale_)) + "'" + active + "/>";
      return;
    default:
      equality_ += "<weld body1='" + one + "'" +
                   (rng_.Chance(0.7) && one != other ? " body2='" + other + "'" : "") + active +
                   "/>";
  }
}

void Draft::AddRelations() {
  if (rng_.Chance(0.3)) {
    for (int k = rng_.Index(3); k >= 0; --k) AddTendon();
  }
  if (rng_.Chance(0.4)) {
    for (int k = rng_.Index(3); k >= 0; --k) AddEquality();
  }
  if (rng_.Chance(0.2)) {
    const std::string one = AnyBody(), other = AnyBody();
    if (one != other) contact_ += "<exclude body1='" + one + "' body2='" + other + "'/>";
  }
  if (rng_.Chance(0.2)) {
    const std::string one = AnyGeom(), other = AnyGeom();
    if (one != other) contact_ += "<pair geom1='" + one + "' geom2='" + other + "'/>";
  }
}

std::string Draft::Xml() const {
  std::vector<std::string> inside;
  for (const Body& body : bodies_) inside.push_back(body.inside);
  std::string world;
  for (int b = static_cast<int>(bodies_.size()) - 1; b >= 0; --b) {
    const int parent = bodies_[b].parent;
    (parent < 0 ? world : inside[parent]) += bodies_[b].head + inside[b] + "</body>";
  }
  if (rng_.Chance(0.3)) world += "<geom name='floor' type='plane' size='0 0 1'/>";
  // MuJoCo refuses inertias below 1e-15, which small light bodies have.
  return "<mujoco><compiler angle='radian' boundmass='1e-14' boundinertia='1e-14'/><asset>" +
         assets_ + "</asset><worldbody>" + world + "</worldbody><contact>" + contact_ +
         "</contact><tendon>" + tendon_ + "</tendon><equality>" + equality_ +
         "</equality></mujoco>";
}

// A box that overlaps up to two thousand geoms of a grid.
std::string Grid(double scale, Random& rng) {
  const int side = 10 + rng.Index(35);
  std::string world;
  for (int i = 0; i < side * side; ++i) {
    const Vector3d at(scale * (i / side), scale * (i % side), 0.0);
    world += std::string("<geom type='") + (i % 2 ? "sphere" : "box") + "' pos='" + Text(at) +
             "' size='" + Text(Vector3d::Constant(0.3 * scale)) + "'/>";
  }
  const Vector3d half(scale * side * rng.Uniform(0.2, 1.0), scale * side * 0.5, 0.3 * scale);
  return "<mujoco><worldbody>" + world + "<body pos='" + Text(Vector3d(half.x(), half.y(), 0.0)) +
         "'><joint type='slide' axis='0 0 1'/><joint axis='" + Text(rng.UnitVector()) +
         "'/><geom type='box' size='" + Text(half) + "'/></body></worldbody></mujoco>";
}

}  // namespace

RandomScene DrawScene(Random& rng) {
  RandomScene scene;
  scene.scale = rng.Chance(0.3) ? 1.0 : LogUniform(1e-4, 1e4, rng);
  if (rng.Chance(1.0 / 30.0)) {
    scene.xml = Grid(scene.scale, rng);
    return scene;
  }
  Draft draft(scene.scale, rng);
  const int bodies = 1 + rng.Index(6);
  for (int b = 0; b < bodies; ++b) {
    draft.AddBody(b == 0 || rng.Chance(0.3) ? -1 : rng.Index(b), b == 0 || rng.Chance(0.9));
  }
  for (int k = rng.Index(4); k > 0; --k) draft.AddObstacle(rng.Chance(0.3));
  draft.AddRelations();
  scene.xml = draft.Xml();
  return scene;
}

std::vector<double> DrawConfiguration(const mjModel& m, double scale, Random& rng) {
  std::vector<double> q(m.qpos0, m.qpos0 + m.nq);
  const double spread = scale * LogUniform(0.1, 5.0, rng);
  const auto quaternion = [&](double* at) {
    const Eigen::Quaterniond r = rng.UnitQuat();
    const double length = rng.Chance(0.2) ? LogUniform(1e-3, 1e3, rng) : 1.0;
    const double values[] = {r.w(), r.x(), r.y(), r.z()};
    for (int k = 0; k < 4; ++k) at[k] = length * values[k];
  };
  for (int j = 0; j < m.njnt; ++j) {
    double* at = q.data() + m.jnt_qposadr[j];
    switch (m.jnt_type[j]) {
      case mjJNT_FREE:
        for (int k = 0; k < 3; ++k) at[k] += rng.Uniform(-spread, spread);
        quaternion(at + 3);
        break;
      case mjJNT_BALL:
        quaternion(at);
        break;
      default: {
        const bool slide = m.jnt_type[j] == mjJNT_SLIDE;
        const bool inside = m.jnt_limited[j] && rng.Chance(0.8);
        const double low = m.jnt_range[2 * j], high = m.jnt_range[2 * j + 1];
        *at =
            inside ? rng.Uniform(low, high) : *at + rng.Uniform(-1.0, 1.0) * (slide ? spread : 4.0);
      }
    }
  }
  return q;
}

}  // namespace mjcf_pdg::test
