// Triangles as the verifier takes them from the model, and what it asks of them.
#ifndef MJCF_PDG_SRC_VERIFY_EXACT_TRIANGLES_H_
#define MJCF_PDG_SRC_VERIFY_EXACT_TRIANGLES_H_

#include <array>
#include <vector>

#include "verify/convex/convex_shape.h"

namespace mjcf_pdg::verify {

using Triangles = std::vector<std::array<Vector3d, 3>>;  // geom frame [m]

// The 12 triangles of a box with these half-sizes [m].
Triangles BoxTriangles(const Vector3d& half);
// The mesh's own triangles if `exact`, else those of the convex hull that MuJoCo's compiler found.
Triangles MeshTriangles(const mjModel& m, int mesh, bool exact);

// Returns the length [m] of the least translation that separates two triangles: the least overlap
// of their projections on the axes of the separating axis test. The unit vector `direction` is
// where the second triangle must go. Returns 0 if the triangles only touch.
double LeastMove(const std::array<Vector3d, 3>& s, const std::array<Vector3d, 3>& t,
                 Vector3d& direction);

// The number of edges that triangles do not traverse equally often in both directions; corners with
// equal coordinates count as one. If it is 0, the surface is closed and has an inside.
int CountOpenEdges(const Triangles& triangles);

// True if the triangles enclose the convex hull of `vertices`, which are their corners: the surface
// is closed, in one piece, and each triangle is on the hull, but for rounding to single precision.
bool IsBoundaryOfHull(const Triangles& triangles, const VertexTree& vertices);

// The connected pieces, each as the ascending indices of its triangles. Triangles are connected if
// corners of theirs have equal coordinates.
std::vector<std::vector<int>> Pieces(const Triangles& triangles);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_EXACT_TRIANGLES_H_
