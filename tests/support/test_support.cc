#include "tests/support/test_support.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <utility>

#include "model/scene_tables.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

std::mutex messages_mutex;
std::vector<std::string> messages;

void KeepMessage(const mjLogMessage* message) {
  if (message->level < mjLOG_WARNING) return;
  const std::lock_guard<std::mutex> lock(messages_mutex);
  messages.emplace_back(message->subject);
  if (message->level < mjLOG_ERROR) return;
  std::fprintf(stderr, "MuJoCo: %s\n", message->subject);
  std::abort();  // MuJoCo would go on with broken data if we returned
}

}  // namespace

MujocoTest::MujocoTest() : previous_(mju_setLogHandler(KeepMessage)) { TakeMessages(); }
MujocoTest::~MujocoTest() { mju_setLogHandler(previous_); }

void MujocoTest::TearDown() {
  for (const std::string& text : TakeMessages()) ADD_FAILURE() << "MuJoCo: " << text;
}

std::vector<std::string> MujocoTest::TakeMessages() {
  const std::lock_guard<std::mutex> lock(messages_mutex);
  return std::exchange(messages, {});
}

ModelPtr LoadModel(const std::string& xml) {
  char error[1000] = "";
  mjSpec* spec = mj_parseXMLString(xml.c_str(), nullptr, error, sizeof(error));
  ModelPtr model(spec ? mj_compile(spec, nullptr) : nullptr);
  if (!model) ADD_FAILURE() << (spec ? mjs_getError(spec) : error) << "\n" << xml;
  if (spec) mj_deleteSpec(spec);
  return model;
}

std::vector<char> ModelBytes(const mjModel* m) {
  std::vector<char> bytes(static_cast<std::size_t>(mj_sizeModel(m)));
  mj_saveModel(m, nullptr, bytes.data(), static_cast<mjtSize>(bytes.size()));
  const char* raw = reinterpret_cast<const char*>(m);
  bytes.insert(bytes.end(), raw, raw + sizeof(mjModel));
  return bytes;
}

double Random::Uniform(double lo, double hi) {
  return lo + (hi - lo) * static_cast<double>(engine_() >> 11) * 0x1p-53;
}

int Random::Index(int n) { return std::min(n - 1, static_cast<int>(Uniform() * n)); }

double Random::Normal() {
  double x, y, s;
  do {
    x = Uniform(-1, 1);
    y = Uniform(-1, 1);
    s = x * x + y * y;
  } while (s >= 1.0 || s == 0.0);
  return x * std::sqrt(-2.0 * std::log(s) / s);
}

VectorXd Random::Normals(int n) {
  VectorXd v(n);
  for (int i = 0; i < n; ++i) v[i] = Normal();
  return v;
}

Vector3d Random::InBox(double half) {
  const double x = Uniform(-half, half), y = Uniform(-half, half);
  return {x, y, Uniform(-half, half)};
}

Vector3d Random::UnitVector() { return Vector3d(Normals(3)).normalized(); }
Quaterniond Random::UnitQuat() {
  const VectorXd v = Normals(4).normalized();
  return {v[0], v[1], v[2], v[3]};
}

std::vector<double> ToVector(const VectorXd& q) { return {q.data(), q.data() + q.size()}; }

VectorXd ToEigen(const std::vector<double>& q) {
  return Eigen::Map<const VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
}

VectorXd RandomConfiguration(const Scene& scene, Random& rng, double spread,
                             const std::vector<double>& base) {
  VectorXd q = ToEigen(base.empty() ? scene.DefaultQpos() : base);
  for (const JointEntry& joint : scene.tables().joints) {
    double* entry = q.data() + joint.qadr;
    if (joint.type == mjJNT_HINGE || joint.type == mjJNT_SLIDE) {
      const double range = joint.type == mjJNT_HINGE ? mjPI : spread;
      const double lo = joint.limited ? joint.lo : *entry - range;
      *entry = rng.Uniform(lo, joint.limited ? joint.hi : *entry + range);
      continue;
    }
    if (joint.type == mjJNT_FREE) {
      q.segment<3>(joint.qadr) += rng.InBox(spread);
      entry += 3;
    }
    Quaterniond quat = rng.UnitQuat();
    if (joint.limited) {
      const Vector3d axis = rng.UnitVector();  // first: the order of arguments is not portable
      quat = Eigen::AngleAxisd(rng.Uniform(0, joint.hi), axis);
    }
    Eigen::Map<Eigen::Vector4d>(entry) << quat.w(), quat.x(), quat.y(), quat.z();
  }
  return q;
}

std::string Join(const double* values, int n) {
  std::string text;
  for (int i = 0; i < n; ++i) {
    char number[40];
    std::snprintf(number, sizeof(number), i ? " %.17g" : "%.17g", values[i]);
    text += number;
  }
  return text;
}

std::string Join(const VectorXd& values) {
  return Join(values.data(), static_cast<int>(values.size()));
}

const std::vector<int>& ConvexTypes() {
  static const std::vector<int> kTypes = {mjGEOM_PLANE,     mjGEOM_SPHERE,   mjGEOM_CAPSULE,
                                          mjGEOM_ELLIPSOID, mjGEOM_CYLINDER, mjGEOM_BOX,
                                          mjGEOM_MESH};
  return kTypes;
}

std::string TypeName(int type) {
  static constexpr const char* kNames[] = {"plane",    "hfield", "sphere", "capsule", "ellipsoid",
                                           "cylinder", "box",    "mesh",   "sdf"};
  return kNames[type];
}

Shape RandomShape(int type, Random& rng) {
  Shape shape;
  shape.type = type;
  shape.size = Vector3d::Constant(0.15) + rng.InBox(0.1);
  if (type == mjGEOM_PLANE) shape.size = Vector3d(0, 0, 1);
  if (type != mjGEOM_MESH) return shape;
  const int n = 8 + rng.Index(24);
  for (int i = 0; i < n; ++i) {
    const double reach = rng.Uniform(0.8, 1.0);
    shape.vertices.push_back(reach * rng.UnitVector().cwiseProduct(shape.size));
  }
  return shape;
}

namespace {

std::string MeshAsset(const Shape& shape, const std::string& name) {
  if (shape.type != mjGEOM_MESH) return "";
  std::string text = "<mesh name='" + name + "' vertex='";
  for (const Vector3d& v : shape.vertices) text += Join(v.data(), 3) + " ";
  return text + "'/>";
}

std::string GeomXml(const Shape& shape, const std::string& name) {
  std::string text = "<geom name='" + name + "' type='" + TypeName(shape.type) + "' ";
  text += shape.type == mjGEOM_MESH ? "mesh='" + name + "' "
                                    : "size='" + Join(shape.size.data(), 3) + "' ";
  return text + shape.attributes + "/>";
}

std::string RandomPose(Random& rng, double half) {
  const Vector3d pos = rng.InBox(half);
  const Quaterniond quat = rng.UnitQuat();
  const double wxyz[4] = {quat.w(), quat.x(), quat.y(), quat.z()};
  return " pos='" + Join(pos.data(), 3) + "' quat='" + Join(wxyz, 4) + "' ";
}

std::string RandomJoint(Random& rng, bool limits) {
  static constexpr const char* kTypes[] = {"hinge", "hinge", "slide", "ball"};
  const std::string type = kTypes[rng.Index(4)];
  const Vector3d pos = rng.InBox(0.1), axis = rng.UnitVector();
  std::string text = "<joint type='" + type + "' pos='" + Join(pos.data(), 3) + "' ";
  if (type != "ball") text += "axis='" + Join(axis.data(), 3) + "' ";
  if (!limits || rng.Chance(0.4)) return text + "/>";
  return text + (type == "slide" ? "range='-.2 .3'/>" : "range='0 80'/>");
}

Shape RandomSmallShape(Random& rng, bool meshes) {
  Shape shape = RandomShape(ConvexTypes()[1 + rng.Index(meshes ? 6 : 5)], rng);
  shape.size *= 0.5;
  for (Vector3d& v : shape.vertices) v *= 0.5;
  shape.attributes = RandomPose(rng, 0.05);
  return shape;
}

}  // namespace

std::string TwoGeomXml(const TwoGeoms& scene) {
  return "<mujoco>" + scene.extra + "<asset>" + MeshAsset(scene.first, "g1") +
         MeshAsset(scene.second, "g2") + "</asset><worldbody><body name='b1' " + scene.pose1 + ">" +
         scene.joint1 + GeomXml(scene.first, "g1") + "</body><body name='b2' " + scene.pose2 + ">" +
         scene.joint2 + GeomXml(scene.second, "g2") + "</body></worldbody></mujoco>";
}

std::string RandomRobotXml(Random& rng, const RobotOptions& options) {
  std::vector<std::string> inside(options.bodies);
  std::vector<int> parent(options.bodies, -1);
  std::string assets, world = "<geom name='floor' type='plane' size='0 0 1' pos='0 0 -0.8'/>";
  for (int b = 0; b < options.bodies; ++b) {
    if (b > 0) parent[b] = std::max(0, b - 1 - rng.Index(3));
    const Shape shape = RandomSmallShape(rng, options.meshes);
    const std::string name = "g" + std::to_string(b);
    assets += MeshAsset(shape, name);
    inside[b] = RandomJoint(rng, options.limits) + GeomXml(shape, name);
    if (b == 0 && options.free_base) inside[b] = "<freejoint name='base'/>" + GeomXml(shape, name);
    if (b > 0 && rng.Chance(0.2)) inside[b] = GeomXml(shape, name);  // welded to its parent
  }
  for (int b = options.bodies - 1; b >= 0; --b) {
    std::string& above = b == 0 ? world : inside[parent[b]];
    above += "<body name='b" + std::to_string(b) + "'" + RandomPose(rng, 0.3) + ">";
    above += inside[b] + "</body>";
  }
  for (int i = 0; i < options.obstacles; ++i) {
    const Shape shape = RandomSmallShape(rng, options.meshes);
    const std::string name = "o" + std::to_string(i);
    assets += MeshAsset(shape, name);
    world += "<body name='" + name + "'" + RandomPose(rng, 0.6) + ">";
    world += GeomXml(shape, name) + "</body>";
  }
  return "<mujoco><asset>" + assets + "</asset><worldbody>" + world + "</worldbody></mujoco>";
}

std::string ArmXml() {
  return R"(<mujoco><worldbody>
    <geom name="wall" type="box" size=".02 1 1" pos=".7 0 .5"/>
    <body name="crate" pos=".4 .3 .1"><geom name="crate" type="box" size=".1 .1 .1"/></body>
    <body name="stand" pos="0 0 .1"><geom name="stand" type="cylinder" size=".08 .1"/>
      <body name="turret" pos="0 0 .15"><joint name="yaw" axis="0 0 1" range="-170 170"/>
        <geom name="turret" type="box" size=".06 .05 .05"/>
        <body name="upper" pos="0 0 .08"><joint name="shoulder" axis="0 1 0" range="-100 100"/>
          <geom name="upper" type="capsule" size=".04" fromto="0 0 0 .3 0 .05"/>
          <body name="fore" pos=".3 0 .05" euler="0 20 0">
            <joint name="reach" type="slide" axis="1 0 .1" range="-.05 .2"/>
            <geom name="fore" type="capsule" size=".03" fromto=".02 0 0 .25 0 0"/>
            <body name="tool" pos=".28 0 0"><joint name="wrist" axis="1 .2 0" pos="-.02 .01 0"/>
            <geom name="tool" type="box" size=".03 .08 .02" pos=".03 .03 0"/>
            </body></body></body></body></body></worldbody></mujoco>)";
}

std::string BallChainXml(bool limited) {
  const std::string range = limited ? "<default><joint range='0 60'/></default>" : "";
  return "<mujoco>" + range + R"(<worldbody>
    <geom name="floor" type="plane" size="0 0 1" pos="0 0 -.5"/>
    <body name="a" pos="0 0 .3" quat=".8 .2 -.5 .3"><joint name="ja" type="ball" pos=".02 0 .03"/>
      <geom name="a" type="capsule" size=".04" fromto="0 0 0 .2 .05 0"/>
      <body name="b" pos=".25 .05 0" quat=".3 .1 .9 -.2">
        <joint name="jb" type="ball" pos="-.03 .01 0"/>
        <geom name="b" type="box" size=".1 .04 .03" pos=".05 .02 0"/>
        <body name="c" pos=".2 0 .02"><joint name="jc" type="ball"/>
        <geom name="c" type="ellipsoid" size=".1 .05 .04" pos=".08 0 .01"/>
      </body></body></body></worldbody></mujoco>)";
}

std::string TwoTreesXml() {
  return R"(<mujoco><worldbody><geom name="floor" type="plane" size="0 0 1" pos="0 0 -.3"/>
    <body name="a" pos="0 0 .2" quat=".9 .1 .3 -.2"><freejoint name="fa"/>
      <geom name="a" type="box" size=".1 .07 .05" pos=".03 0 .01"/>
      <body name="a2" pos=".15 0 0" quat=".7 0 .7 .1"><joint name="ha" axis=".3 1 .2"/>
        <geom name="a2" type="capsule" size=".03 .1" pos="0 .02 .1" density="3000"/></body></body>
    <body name="b" pos=".4 .1 .3"><freejoint name="fb"/>
      <geom name="b" type="ellipsoid" size=".12 .08 .05" density="500"/>
      <body name="b2" pos="0 .12 .02"><joint name="bb" type="ball" pos="0 -.02 0"/>
        <geom name="b2" type="cylinder" size=".04 .09" pos="0 .06 .03"/>
    </body></body></worldbody></mujoco>)";
}

std::string OffCentreXml() {
  return R"(<mujoco><worldbody><geom name="post" type="cylinder" size=".05 .4" pos=".4 .2 0"/>
    <body name="cart" pos=".1 0 .1" quat=".6 .4 -.5 .2">
      <joint name="x" type="slide" axis="1 .1 0"/><joint name="y" type="slide" axis="0 1 .2"/>
      <joint name="turn" axis=".1 .2 1" pos=".1 -.05 .02"/>
      <geom name="cart" type="box" size=".12 .08 .04" pos=".02 .03 0"/>
      <body name="arm" pos=".15 .05 .04" quat=".5 -.3 .7 .1">
        <joint name="sway" axis="1 0 0" pos="-.04 .03 .01"/>
        <joint name="twist" type="ball" pos=".02 .02 -.05"/>
        <joint name="slide" type="slide" axis=".5 .5 1" pos=".1 0 0"/>
        <geom name="arm" type="capsule" size=".03" fromto="0 0 0 .2 .03 .1"/>
        <body name="pad" pos=".22 .04 .1"><geom name="pad" type="box" size=".05 .02 .05"/></body>
        <body name="tip" pos=".2 0 .15" quat=".2 .9 .1 .4">
          <joint name="lift" type="slide" axis="0 .2 1"/><joint name="nod" axis="0 1 1"
          pos=".03 0 -.02"/><geom name="tip" type="cylinder" size=".04 .06" pos=".02 0 .05"/>
      </body></body></body></worldbody></mujoco>)";
}

}  // namespace mjcf_pdg::test
