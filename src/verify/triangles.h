// Triangles as the independent check takes them from the model, and what it asks of them.
#ifndef MJCF_PDG_SRC_VERIFY_TRIANGLES_H_
#define MJCF_PDG_SRC_VERIFY_TRIANGLES_H_

#include <array>
#include <vector>

#include "verify/convex_shape.h"

namespace mjcf_pdg::verify {

using Triangles = std::vector<std::array<Vector3d, 3>>;  // geom frame [m]

Triangles BoxTriangles(const Vector3d& half);
// A mesh's own triangles, or those of its convex hull.
Triangles MeshTriangles(const mjModel& m, int mesh, bool exact);

// How far two triangles must be moved apart at most, and where the first must stay: the least
// overlap of their shadows over the axes that can part them; 0 when they only touch.
double LeastMove(const std::array<Vector3d, 3>& s, const std::array<Vector3d, 3>& t,
                 Vector3d& direction);

// Edges that are not shared by as many triangles one way as the other; corners at the same place
// are one. With none the surface is closed: there is an inside.
int CountOpenEdges(const Triangles& triangles);

// Closed, in one piece, and every triangle lies on the convex hull of `vertices`, which are those
// of the triangles: what they enclose is the hull. Single-precision rounding is forgiven.
bool IsBoundaryOfHull(const Triangles& triangles, const VertexTree& vertices);

// The connected pieces, by the indices of their triangles.
std::vector<std::vector<int>> Pieces(const Triangles& triangles);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_TRIANGLES_H_
