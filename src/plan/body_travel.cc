#include "plan/body_travel.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {

BodyTravel::BodyTravel(const SceneTables& tables) : tables_(tables), posed_(tables.model) {
  for (int body = 1; body < tables.model->nbody; ++body) {
    const double radius = tables.body_spheres[body].radius;
    if (tables.body_moves[body] && radius > 0.0 && std::isfinite(radius)) bodies_.push_back(body);
  }
  before_.resize(bodies_.size());
}

BodyTravel::Pose BodyTravel::PoseOf(int body) const {
  const mjData* data = posed_.data();
  const Matrix3d R = AsMatrix(data->xmat + 9 * body);
  return {AsVector(data->xpos + 3 * body) + R * tables_.body_spheres[body].center_B, R};
}

double BodyTravel::InRadii(const VectorXd& from, const VectorXd& to) {
  posed_.Pose(from);
  std::transform(bodies_.begin(), bodies_.end(), before_.begin(),
                 [this](int body) { return PoseOf(body); });
  posed_.Pose(to);
  double most = 0.0;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Pose after = PoseOf(bodies_[k]);
    const double turned = (after.R - before_[k].R).norm() / std::sqrt(2.0);  // the chord of 1 m
    const double moved = (after.center_W - before_[k].center_W).norm();
    most = std::max(most, moved / tables_.body_spheres[bodies_[k]].radius + turned);
  }
  return most;
}

double TypicalTravel(const ConfigurationSpace& space, double length) {
  constexpr int kMotions = 101;  // odd, so that one is the median; not tuned
  BodyTravel travel(space.tables());
  ompl::RNG rng(1);
  VectorXd from, to;
  std::vector<double> travels(kMotions);
  for (double& radii : travels) {
    space.Sample(rng, from);
    space.Sample(rng, to);
    const double distance = space.Distance(from, to);
    space.Interpolate(from, to, std::min(1.0, length / distance), to);
    radii = travel.InRadii(from, to);
  }
  const auto median = travels.begin() + kMotions / 2;
  std::nth_element(travels.begin(), median, travels.end());
  return *median;
}

}  // namespace mjcf_pdg
