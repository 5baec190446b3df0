// The scene that `import` writes: MJCF and OBJ text.
#ifndef MJCF_PDG_APPS_IMPORT_SCENE_H_
#define MJCF_PDG_APPS_IMPORT_SCENE_H_

#include <string>
#include <vector>

#include "apps/imported_mesh.h"

namespace mjcf_pdg::app {

struct SceneFile {
  std::string name;  // relative to the scene's folder
  std::string content;
};

// The MJCF first, then a mesh file for each mesh. The first mesh is a free body, the others stand;
// body frames are the origin of the files' coordinates, so that the free body's qpos is the motion
// of its file's coordinates. Density in kg/m³.
std::vector<SceneFile> MakeScene(const std::string& scene_name,
                                 const std::vector<ImportedMesh>& meshes, double density);

// Throws Error if MuJoCo does not compile it, which names the mesh file if it is that.
void CheckScene(const std::vector<SceneFile>& files, const std::vector<ImportedMesh>& meshes);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_IMPORT_SCENE_H_
