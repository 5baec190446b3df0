// One mesh file for `import`: read, repaired and measured, and what has to be said about it.
#ifndef MJCF_PDG_APPS_IMPORT_IMPORTED_MESH_H_
#define MJCF_PDG_APPS_IMPORT_IMPORTED_MESH_H_

#include <string>
#include <vector>

#include "import/mesh_repair.h"
#include "mesh/mesh_components.h"
#include "mesh/triangle_mesh.h"

namespace mjcf_pdg::app {

struct ImportedMesh {
  std::string file;   // path as given
  std::string name;   // of the mesh, geom, body and OBJ file; letters, digits, '_', '-' and '.'
  TriangleMesh mesh;  // repaired
  MeshRepairs repairs;
  MeshTopology topology;
  SolidProperties solid;    // meaningful if is_solid
  bool is_solid = false;    // closed and with a volume: gets exact inertia and exact collisions
  Eigen::AlignedBox3d box;  // bounding box of the vertices [m]
};

// Reads a mesh file whose unit is `scale` metres. Its name differs from those in `taken`. Throws
// Error if the file cannot be read or has only degenerate triangles.
ImportedMesh ImportMesh(const std::string& path, double scale,
                        const std::vector<ImportedMesh>& taken);

struct Flaw {
  std::string label;  // one or two words, for the table
  std::string words;  // what is wrong and what was done about it
};
// The repaired flaws, those that remain, and a size or place that suggests a wrong unit.
std::vector<Flaw> FindFlaws(const ImportedMesh& mesh);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_IMPORT_IMPORTED_MESH_H_
