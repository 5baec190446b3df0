// Checks of a mesh file before assimp reads it: assimp 5.2 silently misreads some files.
#ifndef MJCF_PDG_SRC_IMPORT_MESH_FILE_H_
#define MJCF_PDG_SRC_IMPORT_MESH_FILE_H_

#include <string>

namespace mjcf_pdg {

// The extension of a path in lower case, without the dot.
std::string MeshFormat(const std::string& path);

// Throws Error, which names the file, if it is missing, empty or unreadable, ends too early (PLY,
// ASCII STL), promises more than it has room for (OFF), has a unit that is no length (COLLADA), or
// has corners that do not exist (GLB).
//
// Returns the bytes that assimp must be given instead of the file, or an empty string if it can
// read the file itself. Left out are a byte order mark, which would hide the first line, and
// padding after the triangles of a binary STL file. An ASCII STL file in capitals is returned in
// small letters.
std::string CheckMeshFile(const std::string& path);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_MESH_FILE_H_
