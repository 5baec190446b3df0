// How deep two triangle meshes overlap, as rows for a contact matrix.
//
// Definition. A point of one surface inside the other mesh has as depth its distance from that
// other surface. Asked are the vertices, the triangles' middles and, of every edge, the middles of
// its parts inside: where two closed polyhedra overlap one of these is inside, unless they
// coincide, so the depth is never 0 there. `depth` is the largest one found by branch and bound (a
// point's depth changes no faster than the point moves), within a budget of nodes and 10 %. The
// direction is that of the shortest way out. This is the two-sided Hausdorff depth on vertices and
// edges (Tang, Lee, Kim: Interactive Hausdorff distance computation for general polygonal models,
// 2009), not the penetration depth by translation: that one is at least as large.
//
// A deepest point may lie past the middle of the other mesh, with its shortest way out on the far
// side: ways out along which the two surfaces face the same way are used only if there is no other.
//
// Where no such point is found (meshes that are not closed; meshes that coincide), the depth is the
// largest of the least overlaps of two intersecting triangles: triangle-sized.
// Tree units (triangle_bvh.h), in the frame of mesh a.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_BVH_OVERLAP_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_BVH_OVERLAP_H_

#include <optional>
#include <vector>

#include "collide/exact/bvh_pair.h"

namespace mjcf_pdg {

// A way out of an overlap: distance = n · (p2 - p1) < 0, as SignedGap.
struct WayOut {
  SignedGap gap;
  bool faces_apart = true;  // the surfaces face each other along it
};

// A point of some piece of one mesh is inside the other. To be asked when no triangles intersect.
bool Contained(const BvhPair& pair);

// How many parts of the two meshes to look at for the depth of an overlap: a quick look, and one
// that finds the threads of a nut.
constexpr int kFewParts = 75, kManyParts = 1700;

// The overlap of two meshes that intersect or contain each other: appends at least one gap of
// distance <= 0, those along which the surfaces face each other first, of those the deepest; others
// are at other places or in other directions. Of the meshes at most `most_parts` parts are looked
// at.
void AppendOverlaps(const BvhPair& pair, int most_parts, std::vector<SignedGap>& out);

// The deepest first; those of the same place and direction left out, then those beyond the most.
void AppendDeepest(std::vector<WayOut>& ways, double patch, std::vector<SignedGap>& out);

// The overlap of two meshes of which some triangles intersect, as of faces that rest on each other
// and cross by rounding: if a move of kGrazing along the normal of one of `crossing` parts the
// meshes, that. None if not.
std::optional<SignedGap> Graze(const BvhPair& pair, const NearestTriangles& crossing);

// What two crossing triangles tell by themselves: the least move that parts them.
SignedGap TriangleGap(const BvhPair& pair, const NearestTriangles& crossing);

// The least overlap of two triangles' projections on an axis: how far they must be moved apart, at
// most, and the direction from the first to the second. Negative when an axis separates them.
// Both triangles may be degenerate.
double TriangleOverlap(const Vector3d first[3], const Vector3d second[3], Vector3d& n);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_BVH_OVERLAP_H_
