// How deep two triangle meshes overlap, as features from which a contact matrix gets its rows.
//
// Definition. The depth of a point of one surface that is inside the other mesh is its distance
// from that other surface; the direction is that to its nearest point there. The points tried are
// the vertices, the centroids of the triangles and, on every edge, the middle of each segment
// between crossings of the other surface. Where two closed polyhedra overlap and do not coincide,
// one of these points is inside, so that the depth is not 0. The reported depth is the largest that
// branch and bound finds (a point's depth changes no faster than the point moves): at least 1/1.1
// of the largest among these points, unless the budget of boxes ends the search earlier. This is
// the two-sided Hausdorff depth on vertices and edges (Tang, Lee, Kim: Interactive Hausdorff
// distance computation for general polygonal models, 2009). The translational penetration depth is
// at least as large.
//
// A point may lie past the middle of the other mesh, so that its shortest way out is on the far
// side. Then the two surfaces face the same way along it. Such ways out are reported only if there
// are no others.
//
// Where these points are hardly inside, as of meshes that coincide, points inside both meshes are
// tried, too. Where none is found (meshes that are not closed), the depth is the smallest overlap
// of two intersecting triangles.
// Lengths are in tree units (triangle_bvh.h), points and directions in the frame of mesh a.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_BVH_OVERLAP_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_BVH_OVERLAP_H_

#include <optional>
#include <vector>

#include "collide/exact/bvh_pair.h"

namespace mjcf_pdg {

// A translation by which one point of an overlap gets out: gap.distance = n · (p2 - p1) < 0.
struct WayOut {
  SignedGap gap;
  // The two surfaces face each other along n (their outward normals oppose), as at a contact.
  bool faces_apart = true;
};

// True if a mesh has a connected piece with a point inside the other mesh. If no triangles
// intersect, that piece is wholly inside.
bool Contained(const BvhPair& pair);

// The number of boxes of the two hierarchies of which AppendOverlaps measures a vertex: for a quick
// search, and for one that is thorough enough to find the threads of a nut on its bolt.
constexpr int kFewParts = 75, kManyParts = 1700;

// Measures the overlap of two meshes that intersect or contain each other: appends at least one gap
// with distance <= 0, in the order and number of AppendDeepest. `most_parts` is kFewParts or
// kManyParts.
void AppendOverlaps(const BvhPair& pair, int most_parts, std::vector<SignedGap>& out);

// Appends the gaps of `ways`, the deepest first: those whose surfaces face each other or, if there
// are none, one of the others. Of ways of nearly the same direction whose p1 are closer than
// `patch` the deepest is kept. Sorts `ways`.
void AppendDeepest(std::vector<WayOut>& ways, double patch, std::vector<SignedGap>& out);

// Faces that rest on each other cross by rounding of their vertices. If a translation of mesh b by
// kGrazing along a normal of the two triangles `crossing`, which intersect, separates the meshes,
// returns that translation as a gap of distance -kGrazing; else nothing.
std::optional<SignedGap> Graze(const BvhPair& pair, const NearestTriangles& crossing);

// The shortest translation that separates the two triangles `crossing`, which intersect.
SignedGap TriangleGap(const BvhPair& pair, const NearestTriangles& crossing);

// The smallest overlap of the projections of two triangles on the axes of the separating-axis test.
// A translation of the second triangle by it along n, a unit vector, separates the two. Negative if
// they are apart along some axis. Either triangle may be degenerate; if no axis has a length,
// returns infinity and leaves n alone.
double TriangleOverlap(const Vector3d first[3], const Vector3d second[3], Vector3d& n);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_BVH_OVERLAP_H_
