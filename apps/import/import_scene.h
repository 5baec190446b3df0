// Makes the scene that `import` writes: MJCF and OBJ text.
#ifndef MJCF_PDG_APPS_IMPORT_IMPORT_SCENE_H_
#define MJCF_PDG_APPS_IMPORT_IMPORT_SCENE_H_

#include <string>
#include <vector>

#include "apps/import/imported_mesh.h"

namespace mjcf_pdg::app {

struct SceneFile {
  std::string name;  // relative to the scene's folder
  std::string content;
};

// Returns the MJCF file and then an OBJ file for each mesh. The first mesh becomes a free body, the
// others are fixed. Body frames are those of the files' coordinates, so that the free body's qpos
// is the motion of its file's coordinates. `density` is in kg/m³.
std::vector<SceneFile> MakeScene(const std::string& scene_name,
                                 const std::vector<ImportedMesh>& meshes, double density);

// Throws Error if MuJoCo does not compile the scene. The Error names the mesh file that is to
// blame, if one is.
void CheckScene(const std::vector<SceneFile>& files, const std::vector<ImportedMesh>& meshes);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_IMPORT_IMPORT_SCENE_H_
