#include "tests/fuzz/problem.h"

#include <algorithm>
#include <cmath>

#include "tests/fuzz/judge.h"
#include "verify/verifier.h"

namespace mjcf_pdg::test {

Problem::Problem(Random& rng) : drawn(DrawScene(rng)) {
  try {
    scene.emplace(Scene::FromString(drawn.xml));
  } catch (const Error&) {
    return;
  }
  q = DrawConfiguration(*scene->model(), drawn.scale, rng);
  // The default tolerance is large for small scenes and small for large ones.
  if (rng.Chance(0.5)) options.tolerance = std::clamp(1e-6 * drawn.scale, 1e-10, 1e-2);
  options.seed = static_cast<std::uint64_t>(rng.Index(1000));
}

std::string Problem::Words() const {
  return " in " + drawn.xml + " at " + Join(q.data(), static_cast<int>(q.size())) +
         " with tolerance " + Join(&options.tolerance, 1);
}

std::string Refute(const Problem& problem, const std::vector<double>& q) {
  Verifier verifier(problem.scene->verifier_model(), problem.options);
  verifier.IsFree(q);
  return Judge(*problem.scene->model())
      .Refute(q, problem.options.tolerance, [&verifier](int geom1, int geom2) -> Eigen::Vector3d {
        try {
          return verifier.CertificateOf(geom1, geom2).n;
        } catch (const Error&) {
          return Eigen::Vector3d::Zero();  // no kept pair of the verifier's
        }
      });
}

bool Finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool Finite(const std::vector<Contact>& contacts) {
  return std::all_of(contacts.begin(), contacts.end(), [](const Contact& c) {
    return std::isfinite(c.distance) && std::isfinite(c.position_W[0] + c.position_W[1]) &&
           std::isfinite(c.position_W[2] + c.normal_W[0] + c.normal_W[1] + c.normal_W[2]);
  });
}

}  // namespace mjcf_pdg::test
