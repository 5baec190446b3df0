// The hull of points around the origin, grown point by point, and its face nearest to the origin.
//
// Of points of the Minkowski difference of two overlapping bodies: that face is a lower bound of
// their penetration depth, the farthest point along its normal an upper one.
//
// Source: van den Bergen: Proximity queries and penetration depth computation on 3D game objects,
// 2001.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_EXPANDING_POLYTOPE_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_EXPANDING_POLYTOPE_H_

#include <Eigen/Dense>
#include <vector>

#include "collide/convex/simplex.h"

namespace mjcf_pdg {

class ExpandingPolytope {
 public:
  using Corner = Simplex::Corner;

  // Room for so many corners.
  void Reserve(int corners);

  struct Face {
    int corners[3];  // counterclockwise seen from outside
    Eigen::Vector3d n;
    double distance = 0.0;  // of its plane from the origin [m]
  };

  // Begins with four corners around the origin. False if they are too flat.
  bool Start(const Simplex& simplex);
  // A point that is inside changes nothing. False, and the polytope of no more use, where rounding
  // leaves no convex surface.
  bool Add(const Corner& corner);

  const Face& Nearest() const;
  // The mean of a face's corners that is the foot of the origin on its plane.
  Corner Foot(const Face& face) const;

 private:
  struct Edge {
    int from, to;
  };

  bool AddFace(int a, int b, int c);
  bool HorizonIsOneLoop();

  double beside_ = 0.0;          // rounding of distances from a face [m]
  std::vector<Corner> corners_;  // some may be inside by now
  std::vector<Face> faces_;
  std::vector<Edge> horizon_;  // scratch: of the faces that a new corner sees
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_EXPANDING_POLYTOPE_H_
