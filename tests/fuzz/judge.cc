#include "tests/fuzz/judge.h"

#include <algorithm>
#include <cmath>

#include "tests/support/brute_distance.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kRounding = 1e-13;          // of a plane's gap [lengths involved]
constexpr double kLimits = 1.001e-6;         // as the SPEC of "free" allows [m or rad]
constexpr double kEqualities = 1.8e-6;       // three residuals of 1e-6, as one vector [m or rad]
constexpr double kEqualityRounding = 1e-12;  // of residuals [lengths involved]

Vector3d At(const mjtNum* p) { return {p[0], p[1], p[2]}; }
Quaterniond Quat(const mjtNum* p) { return {p[0], p[1], p[2], p[3]}; }

}  // namespace

Judge::Judge(const mjModel& m) : m_(m), d_(mj_makeData(&m)) {
  for (int a = 0; a < m.ngeom; ++a) {
    for (int b = a + 1; b < m.ngeom; ++b) {
      if (Kept(a, b)) pairs_.emplace_back(a, b);
    }
  }
}

bool Judge::Kept(int geom1, int geom2) const {
  const int body1 = m_.geom_bodyid[geom1], body2 = m_.geom_bodyid[geom2];
  const int weld1 = m_.body_weldid[body1], weld2 = m_.body_weldid[body2];
  // Without degrees of freedom are the world and mocap bodies.
  if (m_.body_dofnum[weld1] == 0 && m_.body_dofnum[weld2] == 0) return false;
  for (int p = 0; p < m_.npair; ++p) {
    const auto [low, high] = std::minmax(m_.pair_geom1[p], m_.pair_geom2[p]);
    if (low == geom1 && high == geom2) return true;
  }
  const bool asked = (m_.geom_contype[geom1] & m_.geom_conaffinity[geom2]) ||
                     (m_.geom_contype[geom2] & m_.geom_conaffinity[geom1]);
  if (!asked || weld1 == weld2) return false;
  const int above1 = m_.body_weldid[m_.body_parentid[weld1]];
  const int above2 = m_.body_weldid[m_.body_parentid[weld2]];
  if (weld1 != 0 && weld2 != 0 && (weld1 == above2 || weld2 == above1)) return false;
  const int signature = (std::min(body1, body2) << 16) + std::max(body1, body2);
  const int* const begin = m_.exclude_signature;
  const int* const end = begin + m_.nexclude;
  return std::find(begin, end, signature) == end;
}

std::string Judge::RefutePair(int geom1, int geom2, double tolerance, const PlaneHint& hint) const {
  const Vector3d between = At(d_->geom_xpos + 3 * geom2) - At(d_->geom_xpos + 3 * geom1);
  const double radius1 = m_.geom_rbound[geom1], radius2 = m_.geom_rbound[geom2];
  const bool plane = m_.geom_type[geom1] == mjGEOM_PLANE || m_.geom_type[geom2] == mjGEOM_PLANE;
  if (!plane && between.norm() > radius1 + radius2) return "";
  // Coordinates of the world are rounded, too.
  const double lengths = radius1 + radius2 + At(d_->geom_xpos + 3 * geom1).norm() +
                         At(d_->geom_xpos + 3 * geom2).norm();
  const double least = -tolerance - kRounding * lengths;
  const auto parts = [&](const Vector3d& n) {
    return Support(&m_, d_.get(), geom1, n) + Support(&m_, d_.get(), geom2, -n) <= -least;
  };
  if (!plane && between.norm() > 0.0 && parts(between.normalized())) return "";
  const double gap = BruteDistance(&m_, d_.get(), geom1, geom2).distance;
  if (gap >= least) return "";
  if (!plane) {
    const Vector3d n = hint(geom1, geom2);
    if (std::abs(n.norm() - 1.0) < 1e-12 && (parts(n) || parts(-n))) return "";
  }
  return "geoms " + std::to_string(geom1) + " (" + TypeName(m_.geom_type[geom1]) + ") and " +
         std::to_string(geom2) + " (" + TypeName(m_.geom_type[geom2]) + ") overlap by " +
         Join(&gap, 1) + "; ";
}

std::string Judge::RefuteLimits(const std::vector<double>& q) const {
  for (int j = 0; j < m_.njnt; ++j) {
    if (!m_.jnt_limited[j] || m_.jnt_type[j] == mjJNT_FREE) continue;
    const double* at = q.data() + m_.jnt_qposadr[j];
    double value = *at, low = m_.jnt_range[2 * j];
    if (m_.jnt_type[j] == mjJNT_BALL) {
      value = 2.0 * std::atan2(Quat(at).vec().norm(), std::abs(at[0]));
      low = 0.0;
    }
    if (value >= low - kLimits && value <= m_.jnt_range[2 * j + 1] + kLimits) continue;
    return "joint " + std::to_string(j) + " is outside its range; ";
  }
  return "";
}

// As MuJoCo's documentation defines the constraints; the largest of parts in [m] and [rad].
double Judge::EqualityResidual(int e, const std::vector<double>& q) const {
  const int one = m_.eq_obj1id[e], other = m_.eq_obj2id[e];
  const mjtNum* data = m_.eq_data + mjNEQDATA * e;
  const auto polynomial = [data](double x) {
    return data[0] + x * (data[1] + x * (data[2] + x * (data[3] + x * data[4])));
  };
  const auto joint = [&](int j) { return q[m_.jnt_qposadr[j]] - m_.qpos0[m_.jnt_qposadr[j]]; };
  const auto tendon = [&](int t) { return d_->ten_length[t] - m_.tendon_length0[t]; };
  const auto point = [&](int body, const mjtNum* p) -> Vector3d {
    return At(d_->xpos + 3 * body) + Quat(d_->xquat + 4 * body) * At(p);
  };
  switch (m_.eq_type[e]) {
    case mjEQ_JOINT:
      return std::abs(joint(one) - (other < 0 ? data[0] : polynomial(joint(other))));
    case mjEQ_TENDON:
      return std::abs(tendon(one) - (other < 0 ? data[0] : polynomial(tendon(other))));
    case mjEQ_CONNECT:
      return (point(one, data) - point(other, data + 3)).norm();
    case mjEQ_WELD: {
      const double apart = (point(one, data + 3) - point(other, data)).norm();
      const Quaterniond turned =
          Quat(d_->xquat + 4 * other).conjugate() * (Quat(d_->xquat + 4 * one) * Quat(data + 6));
      return std::max(apart, std::abs(data[10]) * turned.vec().norm());
    }
  }
  ADD_FAILURE() << "an equality constraint of type " << m_.eq_type[e];
  return 0.0;
}

std::string Judge::RefuteEqualities(const std::vector<double>& q) const {
  double lengths = 1.0;
  for (int b = 0; b < m_.nbody; ++b) lengths = std::max(lengths, At(d_->xpos + 3 * b).norm());
  for (const double value : q) lengths = std::max(lengths, std::abs(value));
  for (int e = 0; e < m_.neq; ++e) {
    const bool bodies = m_.eq_type[e] == mjEQ_CONNECT || m_.eq_type[e] == mjEQ_WELD;
    const bool mocap =
        bodies && (m_.body_mocapid[m_.eq_obj1id[e]] >= 0 || m_.body_mocapid[m_.eq_obj2id[e]] >= 0);
    if (!m_.eq_active0[e] || mocap) continue;
    const double residual = EqualityResidual(e, q);
    if (residual <= kEqualities + kEqualityRounding * lengths) continue;
    return "equality constraint " + std::to_string(e) + " is violated by " + Join(&residual, 1) +
           "; ";
  }
  return "";
}

std::string Judge::Refute(const std::vector<double>& q, double tolerance, const PlaneHint& hint) {
  std::copy(q.begin(), q.end(), d_->qpos);
  mj_kinematics(&m_, d_.get());
  mj_comPos(&m_, d_.get());
  mj_tendon(&m_, d_.get());
  std::string wrong = RefuteLimits(q) + RefuteEqualities(q);
  for (const auto& [geom1, geom2] : pairs_) {
    wrong += RefutePair(geom1, geom2, tolerance, hint);
    if (!wrong.empty()) break;
  }
  return wrong;
}

}  // namespace mjcf_pdg::test
