// Reads mesh files of any common format through assimp; no other file uses assimp's importer.
// Linked into the program and the tests, not into the library, whose users need no assimp.
#ifndef MJCF_PDG_SRC_IMPORT_MESH_IMPORT_H_
#define MJCF_PDG_SRC_IMPORT_MESH_IMPORT_H_

#include <string>

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

// Returns all triangles of a file (obj, stl, ply, dae, 3ds, glb, ...). Parts are placed by the
// file's node tree and polygons are cut into triangles. Coordinates are multiplied by `scale`,
// which makes them metres, and rounded to single precision, because MuJoCo keeps no more of a mesh.
// Axes stay as in the file, whichever it calls "up". Vertices are not welded.
//
// Throws Error, which names the file, if CheckMeshFile (mesh_file.h) does, if assimp cannot read
// the file, or if it has no triangles, more than kMaxTriangles, or a coordinate that is not finite
// or beyond 1e10 m. assimp runs in a forked process, because some damaged files crash it: call this
// from a program with one thread.
TriangleMesh ReadMeshFile(const std::string& path, double scale = 1.0);

inline constexpr int kMaxTriangles = 5'000'000;  // MuJoCo needs about 1 KB for each

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_MESH_IMPORT_H_
