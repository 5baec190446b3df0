// How little motion reaches a sum of overlaps, where some of the way is bent by turning.
//
// Part of normals_tree.h.
#ifndef MJCF_PDG_SRC_BOUND_FARTHEST_MOTION_H_
#define MJCF_PDG_SRC_BOUND_FARTHEST_MOTION_H_

#include <Eigen/Dense>
#include <span>

#include "bound/lower_bound_chain.h"

namespace mjcf_pdg {

// A mover's coordinates in x, which are whitened: their squares add up to the mover's term of S.
// First come its slides (0, 1 or 3), then its turns (0, 1 or 3).
struct Coordinates {
  static constexpr int kMost = 6;
  int at = 0, slides = 0, turns = 0;

  int size() const { return slides + turns; }
  double SquaredNorm(const Eigen::VectorXd& x) const { return x.segment(at, size()).squaredNorm(); }
};

// A block of a symmetric matrix Q: d on its diagonal, and B (its upper left corner for one turn)
// added where the mover turns.
struct BendBlock {
  double d = 0.0;
  Matrix3d B = Matrix3d::Zero();
};

// How much of a sum of overlaps a motion x undoes at most: g·x + ½ xᵀQx + E |x|.
struct Undoing {
  std::span<const Coordinates> coordinates;
  std::span<const BendBlock> bends;  // one for each of the coordinates
  const Eigen::VectorXd& g;
  double E = 0.0;

  // A length that a motion must exceed to undo T > 0: the best that `looks` multipliers prove, of
  // the dual  min over μ of  ½ gᵀ(μ - Q)⁻¹g + ½ μ r²  (every μ above all eigenvalues of Q holds).
  // `guess` is about the length. x, of the size of g, is set to where the undoing is largest.
  double LeastLength(double T, double guess, int looks, Eigen::VectorXd& x) const;

 private:
  // No less than the eigenvalues of Q, and 0.
  double MostBent() const;
  // For one multiplier; x = (μ - Q)⁻¹ g.
  double LengthFor(double mu, double T, Eigen::VectorXd& x) const;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_FARTHEST_MOTION_H_
