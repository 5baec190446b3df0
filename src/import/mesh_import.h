// Mesh files of any common format, through assimp: the only place that knows it. Not part of the
// library, whose users need no assimp: linked into the program and the tests.
#ifndef MJCF_PDG_SRC_IMPORT_MESH_IMPORT_H_
#define MJCF_PDG_SRC_IMPORT_MESH_IMPORT_H_

#include <string>

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

// All triangles of a file (obj, stl, ply, dae, 3ds, glb, ...): parts placed as the file's node tree
// says, polygons cut into triangles, all coordinates times `scale` and rounded to single precision,
// which is what MuJoCo keeps of a mesh. Axes stay as in the file, whatever it calls "up". Vertices
// are not welded.
//
// Throws Error, which names the file: missing, empty, unreadable, no triangles, a coordinate that
// is not finite or beyond 1e10 m, more than kMaxTriangles. assimp runs in a forked process (it does
// not survive some damaged files): call from a program with one thread.
TriangleMesh ReadMeshFile(const std::string& path, double scale = 1.0);

inline constexpr int kMaxTriangles = 5'000'000;  // MuJoCo takes about 1 KB for each

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_MESH_IMPORT_H_
