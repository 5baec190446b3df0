#include "bound/farthest_motion.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {
namespace {

constexpr double kClose = 0.02;  // a multiplier is good enough if |x| is so near the length [1]

}  // namespace

double Undoing::MostBent() const {
  double most = 0.0;
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    double bend = 0.0;
    const Matrix3d& B = bends[k].B;
    if (coordinates[k].turns == 1) bend = B(0, 0);
    if (coordinates[k].turns == 3) {  // Gershgorin
      const Vector3d off = B.cwiseAbs().rowwise().sum() - B.diagonal().cwiseAbs();
      bend = (B.diagonal() + off).maxCoeff();
    }
    most = std::max(most, bends[k].d + (coordinates[k].slides > 0 ? std::max(0.0, bend) : bend));
  }
  return most;
}

double Undoing::LengthFor(double mu, double T, Eigen::VectorXd& x) const {
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    const Coordinates& at = coordinates[k];
    const double stiff = mu - bends[k].d;
    const int turn = at.at + at.slides;
    if (at.slides == 1) x[at.at] = g[at.at] / stiff;
    if (at.slides == 3) x.segment<3>(at.at) = g.segment<3>(at.at) / stiff;
    if (at.turns == 1) x[turn] = g[turn] / (stiff - bends[k].B(0, 0));
    if (at.turns == 3) {
      const Matrix3d P = stiff * Matrix3d::Identity() - bends[k].B;
      x.segment<3>(turn) = P.inverse() * g.segment<3>(turn);
    }
  }
  // The root of  ½ g·x + ½ μ r² + E r = T.
  const double left = T - 0.5 * g.dot(x);
  return left > 0.0 ? 2.0 * left / (E + std::sqrt(E * E + 2.0 * mu * left)) : 0.0;
}

double Undoing::LeastLength(double T, double guess, int looks, Eigen::VectorXd& x) const {
  x.setZero();
  const double scale = g.norm() / guess;
  if (!(T > 0.0) || !(scale > 0.0) || !std::isfinite(scale)) return 0.0;
  // At the best μ, |x| is the length. As (μ - q) |x| = |g| for some q between the eigenvalues, each
  // look says where that is.
  constexpr double kLeastAbove = 1e-2;  // of g / guess: so much μ stays above what bends
  const double least = MostBent() + kLeastAbove * scale;
  double mu = std::max(scale, least), best_mu = mu, best = -1.0;
  for (int k = 0; k < looks; ++k) {
    const double length = LengthFor(mu, T, x), far = x.norm();
    if (length > best) {
      best = length;
      best_mu = mu;
    }
    if (std::abs(length - far) <= kClose * far) break;
    mu = length > 0.0 ? std::max(least, mu + scale * guess * (1.0 / length - 1.0 / far)) : 2.0 * mu;
  }
  if (mu != best_mu) LengthFor(best_mu, T, x);
  return best;
}

}  // namespace mjcf_pdg
