// A scene at an overlapping configuration, its lower bound, and free configurations to hold against
// it.
#ifndef MJCF_PDG_TESTS_BOUND_BOUND_CHECK_H_
#define MJCF_PDG_TESTS_BOUND_BOUND_CHECK_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bound/lower_bound.h"
#include "tests/support/test_support.h"
#include "verify/verifier.h"

namespace mjcf_pdg::test {

inline constexpr double kTolerance = 1e-6;

inline VectorXd Configuration(std::initializer_list<double> values) {
  return ToEigen(std::vector<double>(values));
}

// A scene at q_in, and what the bound needs to know of it.
struct AtStart {
  AtStart(const Scene& s, const VectorXd& q, Metric m = Metric::kSequential,
          const Options& user = {})
      : scene(s),
        metric(m),
        options(user),
        norm(s.tables(), m),
        finder(s.tables()),
        verifier(s.verifier_model(), user),
        q_in(Normalized(s.tables(), q)) {
    norm.SetReference(q_in);
    finder.Pose(q_in);
    const std::vector<KeptPair>& pairs = scene.tables().pairs;
    required.resize(static_cast<Eigen::Index>(pairs.size()));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      required[static_cast<Eigen::Index>(i)] =
          (pairs[i].moves ? options.clearance : 0.0) - pairs[i].allowed;
    }
    near = finder.Find(options.clearance + 1e-3);
  }

  double Bound(int max_cells = 200) const {
    return LowerBound().Sigma({scene.tables(), norm, finder.posed(), near, required, metric,
                               options.tolerance, max_cells});
  }
  // With all pairs at once, where `known` is the σ of a free configuration.
  double Tightened(double known, int nodes, int max_cells = 200) const {
    LowerBound bound;
    bound.Sigma({scene.tables(), norm, finder.posed(), near, required, metric, options.tolerance,
                 max_cells});
    return bound.Tighten(known, nodes, nullptr);
  }
  bool Free(const VectorXd& q) { return verifier.Check(ToVector(q)).free; }

  Scene scene;
  Metric metric;
  Options options;
  NormEvaluator norm;
  ContactFinder finder;
  Verifier verifier;
  VectorXd q_in, required;
  std::vector<NearPair> near;
};

// σ of a good free configuration: random ones, the best improved by random steps. Infinite if none.
inline double SearchFree(AtStart& at, Random& rng) {
  const SceneTables& tables = at.scene.tables();
  double best = std::numeric_limits<double>::infinity();
  VectorXd q_best, q = at.q_in;
  auto consider = [&] {
    ClampToLimits(tables, q);
    const double sigma = at.norm.Sigma(q);
    if (sigma >= best || !at.Free(q)) return false;
    best = sigma;
    q_best = q;
    return true;
  };
  for (int i = 0; i < 200; ++i) {
    Integrate(tables, at.q_in, std::pow(10.0, rng.Uniform(-3.0, 0.3)) * rng.Normals(tables.n), q);
    consider();
  }
  if (!std::isfinite(best)) return best;
  double step = 0.1;
  for (int i = 0; i < 600; ++i) {
    // A step towards q_in and a little aside.
    VectorXd dq;
    Difference(tables, q_best, at.q_in, dq);
    dq = dq * rng.Uniform(0.0, 2.0 * step) + step * dq.norm() * rng.Normals(tables.n) / 3.0;
    Integrate(tables, q_best, dq, q);
    step = std::clamp(consider() ? 1.5 * step : 0.93 * step, 1e-4, 0.5);
  }
  return best;
}

// For random configurations of a scene: the bound holds, and is no trifle.
struct Ratios {
  std::vector<double> values;     // √(bound / σ of a free configuration)
  std::vector<double> tightened;  // the same of all pairs at once

  void Try(const Scene& scene, Random& rng, Metric metric, double spread = 0.3) {
    AtStart at(scene, RandomConfiguration(scene, rng, spread), metric);
    if (at.Free(at.q_in)) return;
    const double sigma = SearchFree(at, rng);
    if (!std::isfinite(sigma)) return;
    for (const int cells : {0, 60, 400}) {
      const double bound = at.Bound(cells);
      EXPECT_GE(bound, 0.0);
      EXPECT_LE(bound, sigma) << "max_cells " << cells << ", q_in " << Join(at.q_in);
    }
    values.push_back(std::sqrt(at.Bound() / sigma));
    for (const int nodes : {1, 30, 400}) {
      const double known = nodes == 30 ? 9.0 * sigma : 1.5 * sigma;  // need not be the nearest
      const double bound = at.Tightened(known, nodes);
      EXPECT_GE(bound, at.Bound());
      EXPECT_LE(bound, sigma) << "nodes " << nodes << ", q_in " << Join(at.q_in);
    }
    tightened.push_back(std::sqrt(at.Tightened(sigma, 400) / sigma));
  }
  double Median() { return MedianOf(values); }
  double MedianTightened() { return MedianOf(tightened); }

 private:
  static double MedianOf(std::vector<double>& ratios) {
    if (ratios.empty()) return 0.0;
    std::sort(ratios.begin(), ratios.end());
    return ratios[ratios.size() / 2];
  }
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_BOUND_BOUND_CHECK_H_
