#include "apps/import/imported_mesh.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "apps/console/text.h"
#include "import/mesh_import.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

constexpr double kUnlikelySize = 100.0;  // [m]; a larger mesh is probably in millimetres
constexpr double kCoarse = 1e-5;         // rounding that is reported, as a share of the mesh's size

std::string UniqueName(const std::string& path, const std::vector<ImportedMesh>& taken) {
  std::string stem = std::filesystem::path(path).stem().string();
  for (char& c : stem) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '.';
    if (!plain) c = '_';
  }
  std::string name = stem;
  const auto is_taken = [&] {
    return name == "world" ||  // MuJoCo's own body
           std::any_of(taken.begin(), taken.end(),
                       [&](const ImportedMesh& mesh) { return mesh.name == name; });
  };
  for (int i = 2; is_taken(); ++i) {
    name = stem + "_" + std::to_string(i);
  }
  return name;
}

std::string Count(int n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

std::string Triangles(int n) { return Count(n, "triangle", "triangles"); }
std::string Edges(int n) { return Count(n, "edge", "edges"); }

void AddRepairs(const ImportedMesh& mesh, std::vector<Flaw>* flaws) {
  const MeshRepairs& repairs = mesh.repairs;
  if (repairs.repeated_corners > 0) {
    flaws->push_back(
        {"degenerate", Triangles(repairs.repeated_corners) + " with a corner twice: removed"});
  }
  if (repairs.duplicates > 0) {
    flaws->push_back({"duplicates", Triangles(repairs.duplicates) + " there before: removed"});
  }
  if (repairs.non_manifold_edges > 0) {
    flaws->push_back({"non-manifold", Edges(repairs.non_manifold_edges) +
                                          " of more than two triangles: cut apart there"});
  }
  if (repairs.turned > 0) {
    flaws->push_back(
        {"mixed", Triangles(repairs.turned) + " oriented against the neighbours: turned over"});
  }
  if (repairs.inward_components > 0) {
    flaws->push_back({"inward", Count(repairs.inward_components, "closed part", "closed parts") +
                                    " inside out: turned over"});
  }
}

void AddRemaining(const ImportedMesh& mesh, std::vector<Flaw>* flaws) {
  const MeshTopology& topology = mesh.topology;
  if (topology.zero_area > 0) {
    flaws->push_back({"no area", Triangles(topology.zero_area) + " without area: kept"});
  }
  if (topology.nested_components > 0) {
    flaws->push_back({"nested", Count(topology.nested_components, "closed part", "closed parts") +
                                    " inside another: counted twice in volume and mass"});
  }
  if (mesh.is_solid) return;
  const std::string consequence = ": inertia and collisions are those of its convex hull";
  if (topology.open_edges > 0) {
    flaws->push_back({"open", "not closed (" + Edges(topology.open_edges) + ")" + consequence});
  } else {
    flaws->push_back({"no volume", "encloses no volume" + consequence});
  }
}

void AddDoubtfulScale(const ImportedMesh& mesh, std::vector<Flaw>* flaws) {
  const double size = mesh.box.sizes().maxCoeff();
  if (size > kUnlikelySize) {
    flaws->push_back({"huge", Short(size) + " m large: MuJoCo's unit is the metre; see --scale"});
  }
  const double far =
      std::max(mesh.box.min().cwiseAbs().maxCoeff(), mesh.box.max().cwiseAbs().maxCoeff());
  const double rounding = 0x1.0p-24 * far;
  if (rounding > kCoarse * size) {
    flaws->push_back({"far away", Short(far) +
                                      " m from the origin, where single precision rounds "
                                      "by up to " +
                                      Short(rounding) + " m"});
  }
}

}  // namespace

ImportedMesh ImportMesh(const std::string& path, double scale,
                        const std::vector<ImportedMesh>& taken) {
  ImportedMesh imported;
  imported.file = path;
  imported.name = UniqueName(path, taken);
  imported.mesh = RepairMesh(WeldVertices(ReadMeshFile(path, scale)), &imported.repairs);
  if (imported.mesh.triangles.cols() == 0) throw Error(path + ": all triangles are degenerate");
  imported.topology = FindTopology(imported.mesh);
  imported.solid = FindSolidProperties(imported.mesh);
  imported.box.extend(imported.mesh.vertices.rowwise().minCoeff());
  imported.box.extend(imported.mesh.vertices.rowwise().maxCoeff());
  // Rounding error of the volume, which is all that a flat surface closed upon itself has.
  const double nothing = 1e-9 * imported.box.sizes().maxCoeff() * SurfaceArea(imported.mesh);
  imported.is_solid = imported.topology.open_edges == 0 && imported.solid.volume > nothing;
  return imported;
}

std::vector<Flaw> FindFlaws(const ImportedMesh& mesh) {
  std::vector<Flaw> flaws;
  AddRepairs(mesh, &flaws);
  AddRemaining(mesh, &flaws);
  AddDoubtfulScale(mesh, &flaws);
  return flaws;
}

}  // namespace mjcf_pdg::app
