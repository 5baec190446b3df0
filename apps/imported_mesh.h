// One mesh file on its way into a scene: read, repaired, measured, and what is to be said about it.
#ifndef MJCF_PDG_APPS_IMPORTED_MESH_H_
#define MJCF_PDG_APPS_IMPORTED_MESH_H_

#include <string>
#include <vector>

#include "import/mesh_repair.h"
#include "mesh/mesh_components.h"
#include "mesh/triangle_mesh.h"

namespace mjcf_pdg::app {

struct ImportedMesh {
  std::string file;
  std::string name;   // of mesh, geom, body and OBJ file: letters, digits and _ - . only
  TriangleMesh mesh;  // repaired
  MeshRepairs repairs;
  MeshTopology topology;
  SolidProperties solid;    // means something if is_solid
  bool is_solid = false;    // closed, and with a volume: exact inertia, exact collisions
  Eigen::AlignedBox3d box;  // [m]
};

// Throws Error if nothing can be made of the file. Names differ from those in `taken`.
ImportedMesh ImportMesh(const std::string& path, double scale,
                        const std::vector<ImportedMesh>& taken);

struct Flaw {
  std::string label;  // for the table
  std::string words;  // what is wrong and what was done about it
};
std::vector<Flaw> FindFlaws(const ImportedMesh& mesh);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_IMPORTED_MESH_H_
