#include "apps/audit/same_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/random.h"

namespace mjcf_pdg::app {

ModelPtr Compiled(const std::string& text, const std::string& path) {
  mjVFS vfs;
  mj_defaultVFS(&vfs);
  ModelPtr model(nullptr, mj_deleteModel);
  std::array<char, 1000> error;
  if (mj_addBufferVFS(&vfs, path.c_str(), text.data(), static_cast<int>(text.size())) == 0) {
    model.reset(mj_loadXML(path.c_str(), &vfs, error.data(), static_cast<int>(error.size())));
  }
  mj_deleteVFS(&vfs);
  return model;
}

bool Near(const mjtNum* a, const mjtNum* b, mjtSize n, double tolerance) {
  for (mjtSize k = 0; k < n; ++k) {
    if (!(std::abs(a[k] - b[k]) <= tolerance)) return false;
  }
  return true;
}

DataPtr At(const mjModel& model, const mjtNum* q) {
  DataPtr data(mj_makeData(&model), mj_deleteData);
  mju_copy(data->qpos, q, static_cast<int>(model.nq));
  mj_kinematics(&model, data.get());
  return data;
}

int Width(const mjModel& model, int joint) {
  constexpr std::array kWidth{7, 4, 1, 1};  // of mjJNT_FREE, BALL, SLIDE, HINGE
  return kWidth[static_cast<std::size_t>(model.jnt_type[joint])];
}

namespace {

bool SameQuaternions(const mjtNum* a, const mjtNum* b, mjtSize n) {
  for (mjtSize k = 0; k < n; ++k) {
    if (!(1.0 - std::abs(mju_dot(a + 4 * k, b + 4 * k, 4)) <= kSameModel)) return false;
  }
  return true;
}

// Every body stands where it did, at q.
bool SamePoses(const mjModel& a, const mjModel& b, const mjtNum* q) {
  const DataPtr in_a = At(a, q), in_b = At(b, q);
  double farthest = a.stat.extent;
  for (int k = 0; k < 3 * a.nbody; ++k) farthest = std::max(farthest, std::abs(in_a->xpos[k]));
  return Near(in_a->xpos, in_b->xpos, 3 * a.nbody, kSameModel * farthest) &&
         SameQuaternions(in_a->xquat, in_b->xquat, a.nbody);
}

// What follows from qpos0 and means something: equality constraints, and the rest of springs. A
// coupling of joints is about their distance from qpos0, that of tendons from their length there.
bool SameRules(const mjModel& a, const mjModel& b) {
  if (!Near(a.eq_data, b.eq_data, a.neq * mjNEQDATA, kSameModel) ||
      !Near(a.tendon_lengthspring, b.tendon_lengthspring, 2 * a.ntendon, kSameModel)) {
    return false;
  }
  for (int k = 0; k < a.neq; ++k) {
    for (const int id : {a.eq_obj1id[k], a.eq_obj2id[k]}) {
      const bool moved =
          id >= 0 && ((a.eq_type[k] == mjEQ_JOINT &&
                       a.qpos0[a.jnt_qposadr[id]] != b.qpos0[b.jnt_qposadr[id]]) ||
                      (a.eq_type[k] == mjEQ_TENDON &&
                       std::abs(a.tendon_length0[id] - b.tendon_length0[id]) > kSameModel));
      if (moved) return false;
    }
  }
  for (int joint = 0; joint < a.njnt; ++joint) {
    const mjtNum* poly = a.jnt_stiffnesspoly + mjNPOLY * joint;
    const bool springs = a.jnt_stiffness[joint] != 0.0 ||
                         std::any_of(poly, poly + mjNPOLY, [](mjtNum k) { return k != 0.0; });
    const int at = a.jnt_qposadr[joint];
    if (springs && !Near(a.qpos_spring + at, b.qpos_spring + at, Width(a, joint), kSameModel)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool IsSameModel(const mjModel& before, const mjModel& after) {
  if (before.nq != after.nq || before.nbody != after.nbody || before.nkey != after.nkey ||
      before.neq != after.neq || before.ntendon != after.ntendon ||
      !Near(before.key_qpos, after.key_qpos, before.nkey * before.nq, kSameModel) ||
      !SameRules(before, after)) {
    return false;
  }
  Random random(1);
  std::vector<double> q(before.qpos0, before.qpos0 + before.nq);
  for (int sample = 0; sample < 5; ++sample) {  // a pose that is right at a few is right
    if (!SamePoses(before, after, q.data())) return false;
    for (double& x : q) x += 2.0 * random.Uniform() - 1.0;
    mj_normalizeQuat(&before, q.data());
  }
  return true;
}

}  // namespace mjcf_pdg::app
