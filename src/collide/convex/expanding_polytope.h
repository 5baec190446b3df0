// A convex polytope around the origin that grows point by point, and its face nearest to the
// origin: the expanding polytope algorithm (EPA), by which ConvexDistance measures penetration
// depths.
//
// The points are support points of the Minkowski difference of two overlapping bodies. The distance
// of the nearest face from the origin is a lower bound of their penetration depth; the support
// function along that face's normal is an upper bound.
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

  // Makes room for this number of corners, so that a polytope of that size allocates no memory.
  void Reserve(int corners);

  struct Face {
    int corners[3];         // numbers of the corners, counterclockwise seen from outside
    Eigen::Vector3d n;      // outward unit normal
    double distance = 0.0;  // of its plane from the origin [m]
  };

  // Starts anew with the tetrahedron `simplex`, which must have four corners. Returns false if it
  // is too flat or the origin is outside; the polytope is then unusable.
  bool Start(const Simplex& simplex);
  // Extends the polytope to the convex hull of itself and the corner. A corner that is inside
  // changes nothing. Returns false if rounding errors prevent a convex surface; the polytope is
  // then unusable.
  bool Add(const Corner& corner);

  // The face whose plane is nearest to the origin. The reference is valid until the next Add.
  const Face& Nearest() const;
  // The projection of the origin on the face's plane: x, with the points p1 and p2 of the bodies
  // that have the same barycentric coordinates in the face.
  Corner Foot(const Face& face) const;

 private:
  struct Edge {
    int from, to;
  };

  // False if the face is degenerate or the origin is on its outer side.
  bool AddFace(int a, int b, int c);
  // Sorts horizon_ so that each edge begins where the one before ends. False if that is impossible.
  bool HorizonIsOneLoop();

  double beside_ = 0.0;          // tolerance for rounding of distances from a face [m]
  std::vector<Corner> corners_;  // all that were added, also those inside the polytope
  std::vector<Face> faces_;
  std::vector<Edge> horizon_;  // scratch of Add: the border of the faces that the new corner sees
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_EXPANDING_POLYTOPE_H_
