// Distances of meshes by asking every triangle: slow, and another road than trees.
#ifndef MJCF_PDG_TESTS_SUPPORT_BRUTE_MESH_H_
#define MJCF_PDG_TESTS_SUPPORT_BRUTE_MESH_H_

#include <vector>

#include "base/signed_gap.h"
#include "collide/exact/bvh_pair.h"
#include "tests/support/mesh_shapes.h"

namespace mjcf_pdg::test {

// From the surface, inside or outside.
double BruteDistance(const MeshShape& shape, const Eigen::Vector3d& x);

// Over all pairs of triangles; 0 when some intersect.
double BruteDistance(const MeshShape& a, const MeshShape& b);

// The shape at a pose of a free body.
MeshShape Moved(const MeshShape& shape, const Eigen::Matrix3d& R, const Eigen::Vector3d& t);

TriangleBvh MakeSolid(const MeshShape& shape);

// Some triangles do.
bool Intersects(const BvhPair& pair);

// Small meshes of several kinds: a knot, a cup, a bumpy globe.
const std::vector<MeshShape>& SmallShapes();

// What the rows of every overlap promise, in tree units; there is at least one.
void ExpectOverlaps(const std::vector<SignedGap>& gaps);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_BRUTE_MESH_H_
