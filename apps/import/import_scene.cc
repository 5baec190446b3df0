#include "apps/import/import_scene.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>

#include "apps/console/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

constexpr int kErrorSize = 2000;
constexpr double kAnyDensity = 1000.0;  // [kg/m³], for scenes that are only compiled
constexpr char kFreeColour[] = "0.85 0.35 0.25 1", kStandingColour[] = "0.6 0.65 0.7 1";

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

// Appends the shortest text that reads back as the same number.
template <typename T>
void AppendNumber(T value, std::string* text) {
  char buffer[32];
  text->append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

std::string ObjText(const TriangleMesh& mesh) {
  std::string text;
  for (const auto& p : mesh.vertices.colwise()) {
    text += 'v';
    for (const double x : p) {
      text += ' ';
      AppendNumber(static_cast<float>(x), &text);
    }
    text += '\n';
  }
  for (const auto& corners : mesh.triangles.colwise()) {
    text += 'f';
    for (const int corner : corners) {
      text += ' ';
      AppendNumber(corner + 1, &text);
    }
    text += '\n';
  }
  return text;
}

std::string BodyText(const ImportedMesh& mesh, bool is_free, const std::string& density) {
  const std::string name = "name=\"" + mesh.name + "\"";
  return "    <body " + name + ">\n" + (is_free ? "      <freejoint " + name + "/>\n" : "") +
         "      <geom " + name + " type=\"mesh\" mesh=\"" + mesh.name + "\" density=\"" + density +
         "\" rgba=\"" + (is_free ? kFreeColour : kStandingColour) + "\"/>\n    </body>\n";
}

std::string MjcfText(const std::string& scene_name, const std::string& mesh_folder,
                     const std::vector<ImportedMesh>& meshes, double density) {
  std::string assets, bodies, solids, density_text;
  AppendNumber(density, &density_text);
  for (const ImportedMesh& mesh : meshes) {
    assets += "    <mesh name=\"" + mesh.name + "\" file=\"" + mesh.name + ".obj\" inertia=\"" +
              (mesh.is_solid ? "exact" : "convex") + "\"/>\n";
    bodies += BodyText(mesh, &mesh == &meshes.front(), density_text);
    if (mesh.is_solid) solids += (solids.empty() ? "" : " ") + mesh.name;
  }
  const std::string custom =
      "  <custom>\n    <text name=\"mjcf_pdg.exact_mesh\" data=\"" + solids + "\"/>\n  </custom>\n";
  return "<!-- Made by mjcf-pdg import. A free body's qpos is the motion of its file's "
         "coordinates. "
         "-->\n<mujoco model=\"" +
         Escaped(scene_name) + "\">\n  <compiler meshdir=\"" + Escaped(mesh_folder) + "\"/>\n" +
         (solids.empty() ? "" : custom) + "  <asset>\n" + assets + "  </asset>\n  <worldbody>\n" +
         bodies +
         "  </worldbody>\n  <keyframe>\n    <key name=\"imported\" qpos=\"0 0 0 1 0 0 0\"/>\n"
         "  </keyframe>\n</mujoco>\n";
}

// Compiles the scene in memory. Returns an empty string, or MuJoCo's error without the place in the
// file, because that file is never written.
std::string MujocosComplaint(const std::vector<SceneFile>& files) {
  mjVFS vfs;
  mj_defaultVFS(&vfs);
  const std::unique_ptr<mjVFS, void (*)(mjVFS*)> owner(&vfs, mj_deleteVFS);
  for (const SceneFile& file : files) {
    if (mj_addBufferVFS(&vfs, file.name.c_str(), file.content.data(),
                        static_cast<int>(file.content.size())) != 0) {
      throw Error(file.name + ": MuJoCo cannot hold it in memory");
    }
  }
  std::string error(kErrorSize, '\0');
  const std::unique_ptr<mjModel, void (*)(mjModel*)> model(
      mj_loadXML(files.front().name.c_str(), &vfs, error.data(), kErrorSize), mj_deleteModel);
  if (model) return "";
  error.resize(std::min(error.find('\0'), error.find("\nElement ")));
  const std::string prefix = "Error: ";
  return OneLine(error.rfind(prefix, 0) == 0 ? error.substr(prefix.size()) : error);
}

}  // namespace

std::vector<SceneFile> MakeScene(const std::string& scene_name,
                                 const std::vector<ImportedMesh>& meshes, double density) {
  const std::string folder = scene_name + "_meshes";
  std::vector<SceneFile> files = {
      {scene_name + ".xml", MjcfText(scene_name, folder, meshes, density)}};
  for (const ImportedMesh& mesh : meshes) {
    files.push_back({folder + "/" + mesh.name + ".obj", ObjText(mesh.mesh)});
  }
  return files;
}

void CheckScene(const std::vector<SceneFile>& files, const std::vector<ImportedMesh>& meshes) {
  const std::string complaint = MujocosComplaint(files);
  if (complaint.empty()) return;
  for (const ImportedMesh& mesh : meshes) {
    const std::string cause = MujocosComplaint(MakeScene("alone", {mesh}, kAnyDensity));
    if (!cause.empty()) throw Error(mesh.file + ": MuJoCo refuses it: " + cause);
  }
  throw Error("MuJoCo refuses the scene: " + complaint);
}

}  // namespace mjcf_pdg::app
