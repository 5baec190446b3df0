// The support function h(u) = max over x of u · x of a convex geom, as the maximum of smooth pieces
// with their first and second derivatives: the vertices of a box or mesh, the ends of a capsule,
// the rims of a cylinder, or twelve points of a cap that is nearly parallel to the plane. Wherever
// two geoms touch, a few pieces of each say how their distance changes.
//
// SupportPoints (collide/convex) answers which point is farthest. Here all pieces near the farthest
// are needed, since a plane that touches a face or an edge touches several.
#ifndef MJCF_PDG_SRC_GRADIENT_SUPPORT_PIECES_H_
#define MJCF_PDG_SRC_GRADIENT_SUPPORT_PIECES_H_

#include <vector>

#include "model/kinematics.h"

namespace mjcf_pdg {

// One piece, in the frame of its geom.
struct SupportPiece {
  enum class Kind {
    kPoint,      // a ball of this radius about p: a vertex, the centre of a sphere
    kRim,        // the circle of this radius about the z axis at height p.z
    kEllipsoid,  // half axes p
  };
  Kind kind = Kind::kPoint;
  int id = 0;  // the same piece of the same geom has the same number
  Vector3d p_G = Vector3d::Zero();
  double radius = 0.0;
};

// h, its gradient x (the farthest point) and its second derivative, all at a direction of length 1.
// Along its axis a rim has no derivatives: x is one of its points, and the second derivative 0.
struct SupportValue {
  double h = 0.0;                        // [m]
  Vector3d x_G = Vector3d::Zero();       // [m]
  Matrix3d second_G = Matrix3d::Zero();  // [m]
};
SupportValue Evaluate(const SupportPiece& piece, const Vector3d& u_G);

// Replaces `pieces` by those of the geom, which must have support points (SupportPoints::Knows),
// that reach within `slab` [m] of the farthest along the unit vector u_G; of a finely cut mesh only
// the nearest 32.
void FindPieces(const SceneTables& tables, int geom, const Vector3d& u_G, double slab,
                std::vector<SupportPiece>& pieces);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_GRADIENT_SUPPORT_PIECES_H_
