#include "verify/constraints.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace mjcf_pdg::verify {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// How far a joint may be outside its range in a configuration that is free [rad or m].
constexpr double kRangeTolerance = 1e-6;

// How far a constraint may be violated in a configuration that is free [m or rad].
constexpr double kResidualTolerance = 1e-6;

Vector3d VectorOf(const mjtNum* p) { return {p[0], p[1], p[2]}; }
Quaterniond RotationOf(const mjtNum* q) { return Quaterniond(q[0], q[1], q[2], q[3]).normalized(); }

bool IsJoin(int type) { return type == mjEQ_CONNECT || type == mjEQ_WELD; }

// What a coupling leaves of the first value: by how much it differs from the polynomial of the
// second (null: a constant), both from their values in the reference pose.
double Uncoupled(const mjtNum* c, double first, const double* second) {
  if (!second) return first - c[0];
  const double x = *second;
  return first - (c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4]))));
}

double JointCoupling(const mjModel& m, const mjData& d, int e) {
  const auto turned = [&](int joint) {
    const int adr = m.jnt_qposadr[joint];
    return d.qpos[adr] - m.qpos0[adr];
  };
  const double second = m.eq_obj2id[e] < 0 ? 0.0 : turned(m.eq_obj2id[e]);
  return Uncoupled(m.eq_data + mjNEQDATA * e, turned(m.eq_obj1id[e]),
                   m.eq_obj2id[e] < 0 ? nullptr : &second);
}

double TendonCoupling(const mjModel& m, const mjData& d, int e) {
  const auto pulled = [&](int tendon) { return d.ten_length[tendon] - m.tendon_length0[tendon]; };
  const double second = m.eq_obj2id[e] < 0 ? 0.0 : pulled(m.eq_obj2id[e]);
  return Uncoupled(m.eq_data + mjNEQDATA * e, pulled(m.eq_obj1id[e]),
                   m.eq_obj2id[e] < 0 ? nullptr : &second);
}

// The frame in which one side of a join is fixed, in world axes: a site, or an anchor of a body.
struct Frame {
  Vector3d position_W;
  Quaterniond rotation_W;
};

Frame SiteFrame(const mjModel& m, const mjData& d, int site) {
  const Quaterniond body = RotationOf(d.xquat + 4 * m.site_bodyid[site]);
  return {VectorOf(d.site_xpos + 3 * site), body * RotationOf(m.site_quat + 4 * site)};
}

Frame AnchorFrame(const mjData& d, int body, const mjtNum* anchor_B) {
  const Quaterniond rotation = RotationOf(d.xquat + 4 * body);
  return {VectorOf(d.xpos + 3 * body) + rotation * VectorOf(anchor_B), rotation};
}

double Join(const mjModel& m, const mjData& d, int e) {
  const mjtNum* data = m.eq_data + mjNEQDATA * e;
  const bool weld = m.eq_type[e] == mjEQ_WELD;
  const int object1 = m.eq_obj1id[e], object2 = std::max(0, m.eq_obj2id[e]);
  Frame frame1, frame2;
  if (m.eq_objtype[e] == mjOBJ_SITE) {
    frame1 = SiteFrame(m, d, object1);
    frame2 = SiteFrame(m, d, object2);
  } else {
    // Of a weld the first three numbers are the anchor in body 2, of a connect that in body 1.
    frame1 = AnchorFrame(d, object1, weld ? data + 3 : data);
    frame2 = AnchorFrame(d, object2, weld ? data : data + 3);
    if (weld) frame1.rotation_W = frame1.rotation_W * RotationOf(data + 6);
  }
  const double apart = (frame1.position_W - frame2.position_W).norm();
  const double torque_scale = data[10];
  if (!weld || !(torque_scale > 0.0)) return apart;
  return std::max(apart, frame1.rotation_W.angularDistance(frame2.rotation_W));
}

double Violation(const mjModel& m, const mjData& d, int e) {
  if (IsJoin(m.eq_type[e])) return Join(m, d, e);
  const bool joints = m.eq_type[e] == mjEQ_JOINT;
  return std::abs(joints ? JointCoupling(m, d, e) : TendonCoupling(m, d, e));
}

bool OnMocap(const mjModel& m, int e) {
  for (int object : {m.eq_obj1id[e], m.eq_obj2id[e]}) {
    if (object < 0) continue;
    const int body = m.eq_objtype[e] == mjOBJ_SITE ? m.site_bodyid[object] : object;
    if (m.body_mocapid[m.body_rootid[body]] >= 0) return true;
  }
  return false;
}

}  // namespace

double CheckLimits(const mjModel& m, std::span<const double> q, std::vector<LimitExcess>& outside) {
  double largest = 0.0;
  if (m.opt.disableflags & (mjDSBL_LIMIT | mjDSBL_CONSTRAINT)) return largest;
  for (int j = 0; j < m.njnt; ++j) {
    const int type = m.jnt_type[j];
    if (!m.jnt_limited[j] || type == mjJNT_FREE) continue;
    const double* value = q.data() + m.jnt_qposadr[j];
    const double low = m.jnt_range[2 * j], high = m.jnt_range[2 * j + 1];
    double excess = 0.0;
    if (type == mjJNT_BALL) {
      const double sine = std::hypot(value[1], value[2], value[3]);
      excess = 2.0 * std::atan2(sine, std::abs(value[0])) - high;
    } else {
      excess = std::max(low - *value, *value - high);
    }
    largest = std::max(largest, excess);
    if (excess > kRangeTolerance) outside.push_back({j, excess});
  }
  return largest;
}

std::vector<char> EqualitiesToHold(const mjModel& m, const SceneOptions& options) {
  std::vector<char> hold(m.neq, 0);
  const EqualityMode mode = options.equality;
  const int flags = mjDSBL_EQUALITY | (options.model_flags ? mjDSBL_CONSTRAINT : 0);
  const bool none = mode == EqualityMode::kIgnore || (m.opt.disableflags & flags);
  for (int e = 0; e < m.neq && !none; ++e) {
    const int type = m.eq_type[e];
    if (IsJoin(type)) {
      hold[e] = mode == EqualityMode::kAll || !OnMocap(m, e);
    } else {
      hold[e] = type == mjEQ_JOINT || type == mjEQ_TENDON;
    }
  }
  return hold;
}

double CheckEqualities(const mjModel& m, const std::vector<char>& active, mjData& d,
                       std::vector<EqualityExcess>& violated) {
  bool tendons_posed = false;
  double largest = 0.0;
  for (int e = 0; e < m.neq; ++e) {
    if (!active[e]) continue;
    if (m.eq_type[e] == mjEQ_TENDON && !tendons_posed) {
      mj_comPos(&m, &d);
      mj_tendon(&m, &d);
      tendons_posed = true;
    }
    const double violation = Violation(m, d, e);
    if (!(violation <= kResidualTolerance)) violated.push_back({e, violation});
    largest = std::max(largest, violation);
  }
  return largest;
}

std::vector<char> TendonsToHold(const mjModel& m, const SceneOptions& options) {
  std::vector<char> hold(m.ntendon, 0);
  const int flags = options.model_flags ? mjDSBL_LIMIT | mjDSBL_CONSTRAINT : 0;
  if (!options.hold_tendon_limits || (m.opt.disableflags & flags)) return hold;
  std::copy(m.tendon_limited, m.tendon_limited + m.ntendon, hold.begin());
  return hold;
}

double CheckTendons(const mjModel& m, const std::vector<char>& held, mjData& d,
                    std::vector<TendonExcess>& outside) {
  if (std::find(held.begin(), held.end(), 1) == held.end()) return 0.0;
  mj_comPos(&m, &d);
  mj_tendon(&m, &d);
  double largest = 0.0;
  for (int t = 0; t < m.ntendon; ++t) {
    if (!held[t]) continue;
    const double length = d.ten_length[t];
    const double low = m.tendon_range[2 * t], high = m.tendon_range[2 * t + 1];
    const double excess = std::max(low - length, length - high);
    if (!(excess <= kResidualTolerance)) outside.push_back({t, length, excess});
    largest = std::max(largest, excess);
  }
  return largest;
}

}  // namespace mjcf_pdg::verify
