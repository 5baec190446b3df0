// mjcf-pdg import: mesh files of any common format as a scene that MuJoCo reads.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/console/text.h"
#include "apps/import/import_scene.h"
#include "apps/import/imported_mesh.h"
#include "apps/options.h"
#include "apps/output/output_files.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

struct ImportArguments {
  std::vector<std::string> meshes;
  std::string scene, json;
  double density = 1000.0;  // MuJoCo's default: water
  double scale = 1.0;
};

std::vector<double> Numbers(const Eigen::MatrixXd& values) {
  return {values.data(), values.data() + values.size()};
}

std::string ImportJson(const std::vector<ImportedMesh>& meshes, double density) {
  std::string lines;
  for (const ImportedMesh& mesh : meshes) {
    nlohmann::ordered_json json = {{"file", mesh.file}, {"name", mesh.name}};
    json["free"] = &mesh == &meshes.front();
    json["triangles"] = mesh.mesh.triangles.cols();
    json["vertices"] = mesh.mesh.vertices.cols();
    json["parts"] = mesh.topology.components;
    json["closed"] = mesh.topology.open_edges == 0;
    json["open_edges"] = mesh.topology.open_edges;
    json["size"] = Numbers(mesh.box.sizes());
    json["area"] = SurfaceArea(mesh.mesh);
    json["inertia_from"] = mesh.is_solid ? "exact" : "convex";
    if (mesh.is_solid) {
      json["volume"] = mesh.solid.volume;
      json["mass"] = density * mesh.solid.volume;
      json["center"] = Numbers(mesh.solid.center);
      json["inertia"] = Numbers(density * mesh.solid.inertia);
    }
    json["repaired"] = {{"degenerate", mesh.repairs.repeated_corners},
                        {"duplicates", mesh.repairs.duplicates},
                        {"non_manifold_edges", mesh.repairs.non_manifold_edges},
                        {"turned", mesh.repairs.turned},
                        {"inward_parts", mesh.repairs.inward_components}};
    json["warnings"] = nlohmann::ordered_json::array();
    for (const Flaw& flaw : FindFlaws(mesh)) json["warnings"].push_back(flaw.words);
    lines += JsonLine(json);
  }
  return lines;
}

std::string ImportTable(const std::vector<ImportedMesh>& meshes) {
  Table table({"mesh", "body", "triangles", "vertices", "parts", "closed", "volume m^3", "size m",
               "flaws"});
  for (const ImportedMesh& mesh : meshes) {
    std::string flaws, size;
    for (const Flaw& flaw : FindFlaws(mesh)) flaws += (flaws.empty() ? "" : ", ") + flaw.label;
    for (const double side : Numbers(mesh.box.sizes())) {
      size += (size.empty() ? "" : " x ") + Short(side);
    }
    table.AddRow(
        {mesh.name, &mesh == &meshes.front() ? "free" : "static",
         std::to_string(mesh.mesh.triangles.cols()), std::to_string(mesh.mesh.vertices.cols()),
         std::to_string(mesh.topology.components), mesh.topology.open_edges == 0 ? "yes" : "no",
         mesh.is_solid ? Short(mesh.solid.volume) : "-", size, flaws.empty() ? "none" : flaws});
  }
  return table.ToString();
}

int RunImport(const ImportArguments& arguments) {
  const fs::path scene_path = arguments.scene;
  if (scene_path.extension() != ".xml") {
    throw Error("-o: '" + arguments.scene + "' does not end in .xml");
  }
  std::vector<ImportedMesh> meshes;
  for (const std::string& path : arguments.meshes) {
    meshes.push_back(ImportMesh(path, arguments.scale, meshes));
  }
  std::vector<SceneFile> files = MakeScene(scene_path.stem().string(), meshes, arguments.density);
  CheckScene(files, meshes);

  OutputFiles outputs;
  const auto beside_scene = [&](const std::string& name) {
    return (scene_path.parent_path() / name).string();
  };
  outputs.AddFolder("-o", fs::path(beside_scene(files.back().name)).parent_path().string());
  // The scene is added last, so that it appears only after its meshes.
  for (auto file = files.rbegin(); file != files.rend(); ++file) {
    outputs.Add("-o", beside_scene(file->name), arguments.meshes);
    outputs.Stage(beside_scene(file->name), file->content);
  }
  outputs.Add("--json", arguments.json, arguments.meshes);
  outputs.Stage(arguments.json, ImportJson(meshes, arguments.density));
  outputs.Commit();

  for (const ImportedMesh& mesh : meshes) {
    for (const Flaw& flaw : FindFlaws(mesh)) {
      WriteWarning(mesh.file + ": " + flaw.words);
    }
  }
  if (!outputs.uses_stdout()) WriteStdout(ImportTable(meshes));
  return kExitFree;
}

}  // namespace

Verb AddImportVerb(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "import", "Mesh files (obj, stl, ply, dae, 3ds, glb, ...) as a scene with exact inertia");
  auto arguments = std::make_shared<ImportArguments>();
  command
      ->add_option(
          "MESH", arguments->meshes,
          "each file is one body and one geom, placed as its coordinates say; the first is "
          "free, the others are static")
      ->type_name("FILE")
      ->required();
  AddPath(*command, "-o", "the scene (.xml); its meshes go to a folder NAME_meshes beside it",
          arguments->scene)
      ->required();
  AddNumber(*command, {"--density", "KG/M^3", "of all bodies", {.above_low = true}},
            arguments->density);
  AddNumber(
      *command,
      {"--scale",
       "S",
       "metres per unit of the files (0.001: millimetres), on top of the unit that a dae file "
       "states; units of 3mf files are ignored",
       {.above_low = true}},
      arguments->scale);
  AddJson(*command, arguments->json);
  return {command, [arguments] { return RunImport(*arguments); }};
}

}  // namespace mjcf_pdg::app
