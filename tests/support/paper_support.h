// What the tests of the paper's steps share with its tables: a problem ready to be solved, and the
// two links of Fig. 12.
#ifndef MJCF_PDG_TESTS_SUPPORT_PAPER_SUPPORT_H_
#define MJCF_PDG_TESTS_SUPPORT_PAPER_SUPPORT_H_

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "problem/workspace.h"
#include "tests/support/test_support.h"
#include "verify/verifier.h"

namespace mjcf_pdg::test {

// A scene, its Workspace as the solver sets it up (q_in is qpos0 until SetInput), and its verifier.
struct PosedProblem {
  explicit PosedProblem(const std::string& xml, const Options& user_options = {})
      : scene(Scene::FromString(xml)),
        options(user_options),
        work(scene.tables(), options),
        verifier(scene.verifier_model(), options) {
    SetInput(ToEigen(scene.DefaultQpos()));
  }
  PosedProblem(const PosedProblem&) = delete;

  void SetInput(const VectorXd& q_in) { work.Begin(q_in); }

  // The smallest signed distance of a kept pair less the clearance [m], at most 1 m. For models
  // whose margins allow no overlap.
  double Margin(const VectorXd& q) {
    return verifier.Check(ToVector(q)).min_distance - options.clearance;
  }
  bool Free(const VectorXd& q) { return verifier.Check(ToVector(q)).free; }

  Scene scene;
  Options options;
  Workspace work;
  Verifier verifier;
};

// MJCF with `inside` in its worldbody and `extra` before that.
inline std::string InWorld(const std::string& inside, const std::string& extra = {}) {
  return "<mujoco><compiler angle='radian' boundmass='1e-3' boundinertia='1e-6'/>" + extra +
         "<worldbody>" + inside + "</worldbody></mujoco>";
}

// Fig. 12: two sticks of 1 m and 1 kg each, joined by a hinge, hang from a hinge at the height d
// [m] above the ground.
inline std::string TwoLinksXml(double d) {
  const double radius = 1e-3;  // of the capsules that stand for sticks; they hang higher by as much
  const std::string stick =
      "<joint axis='0 1 0'/><inertial pos='0 0 -.5' mass='1' "
      "diaginertia='.08333333333333333 .08333333333333333 1e-9'/>"
      "<geom type='capsule' size='.001' fromto='0 0 0 0 0 -1'/>";
  const double height = d + radius;
  return InWorld("<geom type='plane' size='5 5 1'/><body pos='0 0 " + std::to_string(height) +
                 "'>" + stick + "<body pos='0 0 -1'>" + stick + "</body></body>");
}

// The least σ of Eq. 32 [m²] subject to cos θ1 + cos(θ1 + θ2) = d, by a fine search over θ1.
inline double TwoLinksOptimum(double d) {
  constexpr int kSteps = 400000;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    const double theta1 = M_PI * i / kSteps;
    const double second = d - std::cos(theta1);
    if (std::abs(second) > 1.0) continue;
    for (const double sign : {1.0, -1.0}) {
      const double theta2 = sign * std::acos(second) - theta1;
      const double s1 = std::sin(theta1 / 2), s2 = std::sin(theta2 / 2);
      least = std::min(least, 0.5 * (4 * s1 * s1 * 8 / 3 + 4 * s2 * s2 / 3));
    }
  }
  return least;
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_PAPER_SUPPORT_H_
