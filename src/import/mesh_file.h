// What has to be looked at in a mesh file before assimp gets it: assimp 5.2 misreads some files
// without a word.
#ifndef MJCF_PDG_SRC_IMPORT_MESH_FILE_H_
#define MJCF_PDG_SRC_IMPORT_MESH_FILE_H_

#include <string>

namespace mjcf_pdg {

// The ending of a path in lower case, without the dot.
std::string MeshFormat(const std::string& path);

// Throws Error, which names the file: missing, empty, unreadable, ends too early (PLY, ASCII STL),
// in a unit that is no length (COLLADA), or with corners that do not exist (GLB).
//
// Returns what assimp is to be given instead of the file, or nothing if the file will do. Dropped
// are a byte order mark, which would hide the first line, and padding behind the triangles of a
// binary STL file; an ASCII STL file in capitals comes in small letters.
std::string CheckMeshFile(const std::string& path);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_MESH_FILE_H_
