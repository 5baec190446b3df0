// Distances of triangle meshes by asking every triangle: slow, and by another method than the
// bounding volume hierarchies that are tested.
#ifndef MJCF_PDG_TESTS_SUPPORT_BRUTE_MESH_H_
#define MJCF_PDG_TESTS_SUPPORT_BRUTE_MESH_H_

#include <vector>

#include "base/signed_gap.h"
#include "collide/exact/bvh_pair.h"
#include "tests/support/mesh_shapes.h"

namespace mjcf_pdg::test {

// The unsigned distance of a point from the surface.
double BruteDistance(const MeshShape& shape, const Eigen::Vector3d& x);

// The least distance of a triangle of `a` and a triangle of `b`; 0 if some intersect.
double BruteDistance(const MeshShape& a, const MeshShape& b);

// A copy with each point p at R p + t.
MeshShape Moved(const MeshShape& shape, const Eigen::Matrix3d& R, const Eigen::Vector3d& t);

// The shape in the solver's tree of bounding volumes.
TriangleBvh MakeSolid(const MeshShape& shape);

// True if some triangle of one body intersects one of the other.
bool Intersects(const BvhPair& pair);

// Small meshes of several kinds: a knot, a cup, a bumpy globe.
const std::vector<MeshShape>& SmallShapes();

// Expects what the gaps of an overlap promise: there is at least one, all are negative, the deepest
// comes first, and normals and witness points agree with the distances (units of the tree).
void ExpectOverlaps(const std::vector<SignedGap>& gaps);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_BRUTE_MESH_H_
