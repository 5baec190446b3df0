// What constraints.h promises, against the residuals that MuJoCo's own solver gets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "tests/support/test_support.h"
#include "verify/constraints.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::VectorXd;

class ConstraintsContractTest : public MujocoTest {};

// Constraints of every kind between bodies, sites, joints and tendons none of which is the first,
// with mocap bodies, and limits of every kind; `option` is more top-level XML.
std::string Xml(const std::string& option = "") {
  return "<mujoco><compiler angle='radian' autolimits='true'/>" + option + R"(
  <worldbody>
    <body name="held" mocap="true" pos="0 2 0"><geom size=".05"/>
      <site name="grip" pos=".1 .2 .3" euler=".3 .2 .1"/></body>
    <body name="a" pos="1 0 0"><freejoint/><geom size=".1" pos=".1 0 0"/>
      <site name="on_a" pos=".2 .1 0" euler=".5 0 .2"/></body>
    <body name="b" pos="0 1 .5"><joint name="free hinge" axis="1 1 0"/><geom size=".1"/>
      <body name="c" pos=".4 0 0"><joint name="hinge" axis="0 1 1" range="-.6 .9" ref=".2"/>
        <geom size=".1" pos="0 .2 0"/><site name="on_c" pos="0 .3 .1" euler=".1 .7 0"/>
        <body name="e" pos="0 .4 0"><joint name="slide" type="slide" axis="1 0 1" range="-.2 .3"/>
          <geom size=".1"/>
          <body name="f" pos="0 0 .5"><joint name="ball" type="ball" range="0 1.1"/>
            <geom size=".1" pos=".2 0 0"/></body></body></body></body>
    <body name="g" pos="3 0 0"><joint name="turn" axis="0 0 1"/><geom size=".1"/></body>
  </worldbody>
  <tendon>
    <fixed name="t0" range="-.5 .7"><joint joint="turn" coef="2"/>
      <joint joint="slide" coef="-1"/></fixed>
    <spatial name="t1" range=".2 1.3"><site site="on_a"/><site site="on_c"/></spatial>
    <fixed name="t2"><joint joint="hinge" coef="1.5"/></fixed>
    <fixed name="t3" range="-.4 .4"><joint joint="hinge" coef="-1"/></fixed>
  </tendon>
  <equality>
    <connect body1="a" body2="c" anchor=".1 .2 .3"/>
    <weld body1="e" body2="a" anchor=".3 0 .1" relpose=".1 .2 .3 .8 .2 .4 .1"/>
    <weld body1="f" body2="g" torquescale="0"/>
    <weld body1="a" torquescale=".3" anchor="0 .4 0"/>
    <connect site1="on_a" site2="on_c"/>
    <weld site1="on_c" site2="on_a"/>
    <joint joint1="hinge" joint2="turn" polycoef=".1 .5 -.3 .2 .4"/>
    <joint joint1="slide" polycoef=".05"/>
    <tendon tendon1="t2" tendon2="t0" polycoef="-.1 .2 .3 -.4 .1"/>
    <tendon tendon1="t1" polycoef=".3"/>
    <weld body1="held" body2="g"/>
    <connect site1="on_a" site2="grip"/>
    <connect body1="b" body2="g" anchor="0 0 .3" active="false"/>
  </equality></mujoco>)";
}

struct Residuals {
  std::map<int, double> equalities, joints, tendons;  // by id; of limits only those exceeded
};

// Of connects and welds the distance or, if larger, the angle; of limits the excess.
Residuals ByMujoco(const mjModel* m, mjData* d) {
  mj_fwdPosition(m, d);
  std::map<int, std::vector<double>> rows;
  Residuals found;
  for (int k = 0; k < d->nefc; ++k) {
    const int id = d->efc_id[k];
    if (d->efc_type[k] == mjCNSTR_EQUALITY) rows[id].push_back(d->efc_pos[k]);
    if (d->efc_type[k] == mjCNSTR_LIMIT_JOINT) {
      found.joints[id] = std::max(found.joints[id], -d->efc_pos[k]);
    }
    if (d->efc_type[k] == mjCNSTR_LIMIT_TENDON) {
      found.tendons[id] = std::max(found.tendons[id], -d->efc_pos[k]);
    }
  }
  for (const auto& [id, of_row] : rows) {
    const Eigen::Map<const VectorXd> row(of_row.data(), static_cast<Eigen::Index>(of_row.size()));
    double residual = row.head(std::min<Eigen::Index>(3, row.size())).norm();
    if (row.size() == 6) {
      const double scale = m->eq_data[mjNEQDATA * id + 10];
      const double sine = scale > 0.0 ? row.tail(3).norm() / scale : 0.0;
      residual = std::max(residual, 2.0 * std::asin(std::min(1.0, sine)));
    }
    found.equalities[id] = residual;
  }
  return found;
}

void SetRandom(const mjModel& m, mjData& d, Random& rng) {
  const VectorXd dq = rng.Uniform(0.05, 0.8) * rng.Normals(static_cast<int>(m.nv));
  mju_copy(d.qpos, m.qpos0, static_cast<int>(m.nq));
  mj_integratePos(&m, d.qpos, dq.data(), 1.0);
  const Eigen::Quaterniond turn = rng.UnitQuat();
  mju_copy(d.mocap_quat, Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z()).data(), 4);
}

TEST_F(ConstraintsContractTest, ResidualsAreMujocosOwn) {
  const ModelPtr m = LoadModel(Xml());
  const DataPtr d(mj_makeData(m.get())), other(mj_makeData(m.get()));
  Random rng(1);
  std::vector<int> joints_out(m->njnt, 0), tendons_out(m->ntendon, 0);
  for (int trial = 0; trial < 200; ++trial) {
    SetRandom(*m, *d, rng);
    std::vector<char> active(m->neq);
    for (char& each : active) each = rng.Chance(0.7);
    for (int e = 0; e < m->neq; ++e) d->eq_active[e] = 1;
    mju_copy(other->qpos, d->qpos, static_cast<int>(m->nq));
    mju_copy(other->mocap_quat, d->mocap_quat, 4);
    mj_kinematics(m.get(), other.get());
    const Residuals by_mujoco = ByMujoco(m.get(), d.get());

    std::vector<verify::EqualityExcess> violated = {{-7, 1.0}};  // it appends
    double largest = verify::CheckEqualities(*m, active, *other, violated);
    EXPECT_EQ(violated.front().equality, -7);
    double expected = 0.0;
    int violations = 0;
    for (const auto& [id, residual] : by_mujoco.equalities) {
      if (!active[id]) continue;
      expected = std::max(expected, residual);
      violations += residual > 1e-6;
    }
    EXPECT_NEAR(largest, expected, 1e-7);
    EXPECT_EQ(static_cast<int>(violated.size()) - 1, violations);
    for (std::size_t k = 1; k < violated.size(); ++k) {
      EXPECT_TRUE(active[violated[k].equality]);
      EXPECT_NEAR(violated[k].residual, by_mujoco.equalities.at(violated[k].equality), 1e-7)
          << violated[k].equality;
    }

    std::vector<verify::LimitExcess> outside = {{-7, 1.0}};
    largest = verify::CheckLimits(*m, {other->qpos, static_cast<std::size_t>(m->nq)}, outside);
    ASSERT_EQ(outside.size(), by_mujoco.joints.size() + 1);
    expected = 0.0;
    for (std::size_t k = 1; k < outside.size(); ++k) {
      EXPECT_NEAR(outside[k].excess, by_mujoco.joints.at(outside[k].joint), 1e-9);
      expected = std::max(expected, outside[k].excess);
      ++joints_out[outside[k].joint];
    }
    EXPECT_EQ(largest, expected);

    std::vector<char> held(m->ntendon);
    for (int t = 0; t < m->ntendon; ++t) held[t] = m->tendon_limited[t] && rng.Chance(0.8);
    std::vector<verify::TendonExcess> stretched = {{-7, 1.0, 1.0}};
    mj_kinematics(m.get(), other.get());
    largest = verify::CheckTendons(*m, held, *other, stretched);
    expected = 0.0;
    int out = 0;
    for (const auto& [id, excess] : by_mujoco.tendons) {
      out += held[id];
      if (held[id]) expected = std::max(expected, excess);
    }
    EXPECT_NEAR(largest, expected, 1e-12);
    EXPECT_EQ(static_cast<int>(stretched.size()) - 1, out);
    for (std::size_t k = 1; k < stretched.size(); ++k) {
      const int id = stretched[k].tendon;
      EXPECT_TRUE(held[id]);
      EXPECT_NEAR(stretched[k].excess, by_mujoco.tendons.at(id), 1e-12);
      EXPECT_NEAR(stretched[k].length, d->ten_length[id], 1e-12);
      ++tendons_out[id];
    }
  }
  for (int j = 0; j < m->njnt; ++j) EXPECT_EQ(joints_out[j] > 10, m->jnt_limited[j] != 0) << j;
  for (int t = 0; t < m->ntendon; ++t) {
    EXPECT_EQ(tendons_out[t] > 10, m->tendon_limited[t] != 0) << t;
  }
}

TEST_F(ConstraintsContractTest, WhatIsHeldFollowsFromOptionsAndFlags) {
  const ModelPtr m = LoadModel(Xml());
  ASSERT_EQ(m->neq, 13);
  SceneOptions options;
  std::vector<char> all(m->neq, 1), off_mocap = all;
  off_mocap[10] = off_mocap[11] = 0;
  EXPECT_EQ(verify::EqualitiesToHold(*m, options), off_mocap);
  options.equality = EqualityMode::kAll;
  EXPECT_EQ(verify::EqualitiesToHold(*m, options), all);
  options.equality = EqualityMode::kIgnore;
  EXPECT_EQ(verify::EqualitiesToHold(*m, options), std::vector<char>(m->neq, 0));
  const std::vector<char> none(m->ntendon, 0), limited = {1, 1, 0, 1};
  EXPECT_EQ(verify::TendonsToHold(*m, options), none);
  options.hold_tendon_limits = true;
  EXPECT_EQ(verify::TendonsToHold(*m, options), limited);
  for (const std::string flag : {"constraint", "limit", "equality"}) {
    const ModelPtr flagged = LoadModel(Xml("<option><flag " + flag + "='disable'/></option>"));
    for (const bool follows : {false, true}) {
      SCOPED_TRACE(flag + (follows ? " followed" : ""));
      options = {};
      options.hold_tendon_limits = true;
      options.model_flags = follows;
      const bool no_equalities = flag == "equality" || (follows && flag == "constraint");
      EXPECT_EQ(verify::EqualitiesToHold(*flagged, options),
                no_equalities ? std::vector<char>(m->neq, 0) : off_mocap);
      EXPECT_EQ(verify::TendonsToHold(*flagged, options),
                follows && flag != "equality" ? none : limited);
    }
    std::vector<double> q(flagged->qpos0, flagged->qpos0 + flagged->nq);
    q[flagged->jnt_qposadr[2]] = 2.0;
    std::vector<verify::LimitExcess> outside;
    const double excess = verify::CheckLimits(*flagged, q, outside);
    EXPECT_EQ(outside.size(), flag == "equality" ? 1u : 0u);
    EXPECT_NEAR(excess, flag == "equality" ? 1.1 : 0.0, 1e-12);
  }
}

TEST_F(ConstraintsContractTest, WhatIsWithinAMicrometreOfItsLimitIsInside) {
  const ModelPtr m = LoadModel(Xml());
  for (const char* name : {"hinge", "slide", "ball"}) {
    const int joint = mj_name2id(m.get(), mjOBJ_JOINT, name), adr = m->jnt_qposadr[joint];
    for (const double beyond : {-0.1, 0.9e-6, 1.1e-6}) {
      for (const bool high : {true, false}) {
        std::vector<double> q(m->qpos0, m->qpos0 + m->nq);
        const double limit = m->jnt_range[2 * joint + high];
        if (m->jnt_type[joint] == mjJNT_BALL) {
          const double half = 0.5 * (m->jnt_range[2 * joint + 1] + beyond);
          const double sign = high ? 2.0 : -3.0;  // of any length, and either sign
          q[adr] = sign * std::cos(half);
          q[adr + 2] = sign * std::sin(half);
        } else {
          q[adr] = high ? limit + beyond : limit - beyond;
        }
        std::vector<verify::LimitExcess> outside;
        EXPECT_NEAR(verify::CheckLimits(*m, q, outside), std::max(beyond, 0.0), 1e-12) << name;
        ASSERT_EQ(outside.size(), beyond > 1e-6 ? 1u : 0u) << name;
        if (!outside.empty()) {
          EXPECT_EQ(outside[0].joint, joint);
          EXPECT_NEAR(outside[0].excess, beyond, 1e-12);
        }
      }
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
