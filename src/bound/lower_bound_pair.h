// What parting one overlapping pair costs at least: by moment arms, and over all directions.
//
// Part of lower_bound.h; symbols are those of the derivation at the head of lower_bound.cc.
#ifndef MJCF_PDG_SRC_BOUND_LOWER_BOUND_PAIR_H_
#define MJCF_PDG_SRC_BOUND_LOWER_BOUND_PAIR_H_

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "base/tuning.h"
#include "bound/lower_bound_chain.h"
#include "bound/lower_bound_geom.h"
#include "problem/budget.h"

namespace mjcf_pdg {

// A bound serves a search, which needs the time more: it ends when its share of a budget in seconds
// is spent, and what it has proven by then holds. `budget` null: no limit.
inline bool BoundIsLate(const BudgetMeter* budget) {
  return budget && budget->Late(tuning::budget::kBound);
}

struct PairProblem {
  // What carries geom 1 and geom 2 relative to each other, all finite: first[i] to first[i + 1] of
  // the pool.
  const MoverPool* pool = nullptr;
  std::array<int, 3> first = {};
  std::array<ConvexGeom, 2> geom;
  double required = 0.0;  // δ [m]
  double needed = 0.0;    // δ - d [m]
  bool plane = false;     // geom 1 is a plane that does not move relative to geom 2's base
  Vector3d n_W = Vector3d::UnitZ();  // of the overlap, from geom 1 to geom 2; a plane's normal
  // √S along one direction, from the farthest points: SearchDirections looks for no more than this,
  // though other points may prove a little more.
  double hope = 0.0;

  Chain ChainOf(int i) const { return std::span(*pool).subspan(first[i], first[i + 1] - first[i]); }

  // By moment arms, S; `floor` if that is more.
  double MomentArmS(double floor) const;
  // What is asked of a √S: not less than `floor` is told, and above `enough` it need not be as
  // large as can be proven. Where two points overlap by `overlap` [m], `enough` is proven.
  struct Wanted {
    double floor = 0.0, enough = std::numeric_limits<double>::infinity();
    double overlap = std::numeric_limits<double>::infinity();
  };
  // What γ and κ are nowhere larger than, for any points of the geoms and any direction.
  struct Ease {
    double gamma = 0.0, kappa = 0.0;
  };
  Ease MostEase() const;
  // The overlap t along a direction [m] with which (2) proves this √S.
  static double EnoughOverlap(const Ease& ease, double root);
  // √S for all unit vectors within eps, at most a right angle, of n: the best of the points tried.
  // Infinite if nothing moves the geoms that way.
  double RootFor(const Vector3d& n, double eps, const Wanted& wanted) const;
  double RootFor(const Vector3d& n, double eps) const { return RootFor(n, eps, Wanted{}); }
  // √S if geom 1 were the half-space below a plane of normal n in which geom 2 is `depth` [m] deep.
  double RootIfPlane(const Vector3d& n, double depth) const;
  // √S if geom 1 is a plane: a half-space is left along its normal only.
  double RootForPlane(const BudgetMeter* budget) const;

  // t of (2) for a - b = v, the least for all unit vectors within eps, at most a right angle, of n.
  double Overlap(const Vector3d& v, const Vector3d& n, double eps) const;
  // What γ is nowhere larger than for the points a and b, in any direction.
  double MostGamma(const Vector3d& a, const Vector3d& b) const;
  // Points a, b whose overlap is large for all unit vectors within eps of n.
  std::pair<Vector3d, Vector3d> FarthestOver(const Vector3d& n, double eps) const;
  // The points of geom 1 farthest along n1, and of geom 2 farthest against n2. Of a plane with the
  // normal n, the point below the other.
  std::pair<Vector3d, Vector3d> FarthestAlong(const Vector3d& n, const Vector3d& n1,
                                              const Vector3d& n2) const;

 private:
  // The unit vectors within eps of n.
  struct Cap {
    Vector3d n;
    double eps = 0.0, cos = 1.0, sin = 0.0;
  };
  static Cap CapOf(const Vector3d& n, double eps);
  double Overlap(const Vector3d& v, const Cap& cap) const;
  Matrix3d Compliance(const Vector3d& a, const Vector3d& b) const;  // G
  std::pair<Vector3d, Vector3d> FarthestOver(const Cap& cap, double enough) const;
  // √S by (2) for the points a and b and all of the cap.
  double RootAt(const Vector3d& a, const Vector3d& b, const Cap& cap, const Wanted& wanted) const;
};

// A piece of a cube's face seen from its centre, as a part of the sphere of directions.
struct DirectionCell {
  double root = 0.0;  // √S proven for all directions in it
  int face = 0;
  double u = 0.0, v = 0.0, half = 1.0;

  Vector3d Direction(double du, double dv) const;
  double Radius(const Vector3d& n) const;
  bool operator<(const DirectionCell& other) const {
    return root > other.root;
  }  // heap: least on top
};

// Cells with which SearchDirections begins. It goes on by cutting one cell into four.
inline constexpr int kFirstCells = 6 * 3 * 3;

// A cell with which a search begins, its middle and its radius.
struct FirstCell {
  DirectionCell cell;
  Vector3d n;
  double radius = 0.0;
};
const std::array<FirstCell, kFirstCells>& FirstCells();

// √S for all directions, by branch and bound. Gives up once the pair cannot beat `floor` (√S) or no
// cells are left; sooner in a budget of time (null: none). `heap` is scratch.
double SearchDirections(const PairProblem& pair, double floor, const BudgetMeter* budget,
                        int& cells_left, std::vector<DirectionCell>& heap);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LOWER_BOUND_PAIR_H_
