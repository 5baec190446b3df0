// A scene a thousand times smaller or larger, solved with a tolerance to match, behaves the same:
// lengths in the solver, the verifier and CCDg follow from the tolerance and the size of the scene.
// The scale is a power of two, so that even rounding agrees.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "mjcf_pdg/pdg.h"
#include "tests/support/scaled_model.h"
#include "tests/support/test_support.h"
#include "tests/support/trials.h"

namespace mjcf_pdg::test {
namespace {

class ScaleTest : public MujocoTest {};

struct Agreement {
  int problems = 0, status = 0, iterations = 0, sigma = 0;
};

// Status, iterations and σ of solves of `scene`, and of the same scaled.
void Compare(const Scene& scene, const std::vector<std::vector<double>>& rows, double scale,
             Agreement& agreement) {
  const ModelPtr model = Scaled(*scene.model(), scale);
  const Scene scaled = Scene::FromModel(model.get());
  Options options, scaled_options;
  options.effort = scaled_options.effort = Effort::kFast;
  scaled_options.tolerance = scale * options.tolerance;
  Solver solver(scene, options), scaled_solver(scaled, scaled_options);
  for (const std::vector<double>& q : rows) {
    const Result one = solver.Solve(q);
    const Result other = scaled_solver.Solve(Scaled(*scene.model(), q, scale));
    if (one.status == Status::kAlreadyFree && other.status == one.status) continue;
    const double sigma = other.sigma / (scale * scale);
    ++agreement.problems;
    agreement.status += one.status == other.status;
    agreement.iterations += one.stats.iterations == other.stats.iterations;
    agreement.sigma += std::abs(sigma - one.sigma) <= 1e-3 * one.sigma;
  }
}

TEST_F(ScaleTest, AThousandTimesSmallerOrLargerIsTheSame) {
  for (const double scale : {std::ldexp(1.0, -10), std::ldexp(1.0, 10)}) {
    Agreement agreement;
    Random rng(31);
    for (int model = 0; model < 20; ++model) {
      RobotOptions robot;
      robot.bodies = 3 + model % 6;
      robot.free_base = model % 2 == 1;
      const Scene scene = Scene::FromString(RandomRobotXml(rng, robot));
      std::vector<std::vector<double>> rows;
      for (int k = 0; k < Trials(130); ++k) rows.push_back(ToVector(RandomConfiguration(scene, rng, 0.3)));
      Compare(scene, rows, scale, agreement);
    }
    for (const char* path : {"/puma/puma_car.xml", "/hand/hand_bottle.xml", "/rigid/spoon_cup.xml",
                             "/rigid/l_shape_torus_knot.xml", "/rigid/nut_on_bolt.xml"}) {
      const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + path);
      std::vector<std::vector<double>> rows;
      for (std::size_t k = 0; k < scene.KeyNames().size(); ++k) {
        rows.push_back(scene.KeyQpos(static_cast<int>(k)));
      }
      Compare(scene, rows, scale, agreement);
    }
    std::printf("  scale %g: of %d problems %d have the same status, %d iterations, %d sigma\n",
                scale, agreement.problems, agreement.status, agreement.iterations, agreement.sigma);
    EXPECT_GE(agreement.problems, Trials(960));
    EXPECT_GE(agreement.status, 0.99 * agreement.problems);
    EXPECT_GE(agreement.iterations, 0.99 * agreement.problems);
    EXPECT_GE(agreement.sigma, 0.99 * agreement.problems);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
