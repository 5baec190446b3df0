// The files of meshes, height fields, skins and textures that a written scene refers to.
#ifndef MJCF_PDG_APPS_OUTPUT_ASSET_FILES_H_
#define MJCF_PDG_APPS_OUTPUT_ASSET_FILES_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace mjcf_pdg::app {

// Names the asset files of `spec` relative to `folder`, which the scene is written to, where they
// are.
void RelocateAssets(mjSpec* spec, const std::string& folder);

struct AssetCopy {
  std::string from;  // the file
  std::string to;    // relative to the folder of the scene
};

// Names the asset files of `spec` as copies in the folder assets/ beside the scene, each by its own
// name or, where another file has that already, a numbered one. Returns the copies to make.
std::vector<AssetCopy> GatherAssets(mjSpec* spec);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OUTPUT_ASSET_FILES_H_
