#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "apps/input/npy.h"
#include "apps/input/qpos_file.h"
#include "import/mesh_import.h"
#include "mesh/triangle_mesh.h"
#include "mjcf_pdg/pdg.h"
#include "tests/fuzz/cases.h"
#include "tests/fuzz/random_scene.h"
#include "tests/support/temporary_folder.h"

namespace mjcf_pdg::test {
namespace {

constexpr std::size_t kWidth = 4;  // values of a row

struct Bytes {
  std::string name;  // of the file
  std::string content;
};

std::string SomeNumber(Random& rng) {
  static const char* const numbers[] = {"nan",    "-nan",       "inf", "1e308",       "-1e308",
                                        "1e-308", "0",          "-1",  "99999999999", "1e999",
                                        "0x10",   "2147483648", "",    "1e-20"};
  return numbers[rng.Index(static_cast<int>(std::size(numbers)))];
}

// A few changes: of bits, of runs of bytes, of numbers.
std::string Damaged(std::string bytes, Random& rng) {
  const auto place = [&] {
    return static_cast<std::size_t>(rng.Index(static_cast<int>(bytes.size())));
  };
  for (int k = rng.Chance(0.7) ? 1 : rng.Index(5); k > 0 && !bytes.empty(); --k) {
    const std::size_t at = place(),
                      run = std::min<std::size_t>(1 + rng.Index(20), bytes.size() - at);
    switch (rng.Index(7)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << rng.Index(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(rng.Index(256));
        break;
      case 2:
        bytes.erase(at, run);
        break;
      case 3:
        bytes.insert(place(), bytes.substr(at, run));
        break;
      case 4:
        bytes.resize(at);
        break;
      default: {  // in place of a number
        const std::size_t begin = bytes.find_first_of("0123456789-", at);
        if (begin == std::string::npos) break;
        const std::size_t end = bytes.find_first_not_of("0123456789.eE+-", begin);
        bytes.replace(begin, std::min(end, bytes.size()) - begin, SomeNumber(rng));
      }
    }
  }
  return bytes;
}

std::string Little(std::uint32_t value) {
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

std::string Floats(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values)
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

// A tetrahedron in one of the formats.
Bytes Mesh(Random& rng) {
  switch (rng.Index(6)) {
    case 0:
      return {"m.obj",
              "# t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1 3 2\nf 1//1 2//1 4//1\n"
              "f 2 3 4\nf -2 -4 -1\n"};
    case 1:
      return {"m.stl",
              "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
              "vertex 0 1 0\nendloop\nendfacet\nendsolid t\n"};
    case 2:
      return {"m.stl", std::string(80, ' ') + Little(2) +
                           Floats({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string(2, '\0') +
                           Floats({0, 1, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0}) + std::string(2, '\0')};
    case 3:
      return {"m.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
              "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
              "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"};
    case 4:
      return {"m.ply",
              "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty "
              "float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
              "end_header\n" +
                  Floats({0, 0, 0, 1, 0, 0, 0, 1, 0}) + '\3' + Little(0) + Little(1) + Little(2)};
    default:
      return {"m.off",
              "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"};
  }
}

Bytes Rows(Random& rng) {
  const int rows = 1 + rng.Index(4), kind = rng.Index(4);
  std::string content = kind == 0 ? app::NpyHeader(rows, kWidth) : "";
  for (int r = 0; r < rows; ++r) {
    const Eigen::VectorXd q = rng.Normals(kWidth);
    switch (kind) {
      case 0:
        content.append(reinterpret_cast<const char*>(q.data()), sizeof(double) * kWidth);
        break;
      case 3:
        content += "{\"index\":" + std::to_string(r) + ",\"qpos\":[";
        for (std::size_t k = 0; k < kWidth; ++k) content += (k ? "," : "") + Join(&q[k], 1);
        content += "],\"sigma\":0.5}\n";
        break;
      default:
        for (std::size_t k = 0; k < kWidth; ++k) {
          content += (k ? (kind == 1 ? ", " : " ") : "") + Join(&q[k], 1);
        }
        content += "\n";
    }
  }
  static const char* const names[] = {"q.npy", "q.csv", "q.txt", "q.jsonl"};
  return {names[kind], content};
}

std::string Write(const TemporaryFolder& folder, const Bytes& bytes) {
  const std::string path = folder / bytes.name;
  std::ofstream(path, std::ios::binary) << bytes.content;
  return path;
}

CaseOutcome ReadModel(const std::string& xml) {
  const Scene scene = Scene::FromString(xml);
  const std::vector<double> q = scene.DefaultQpos();
  scene.CheckConfiguration(q);
  const Verdict verdict = Verify(scene, q);
  const bool finite = std::isfinite(verdict.min_distance) && std::isfinite(verdict.limit_excess);
  return {"model", finite ? "" : "a number of the verdict is not finite"};
}

CaseOutcome ReadRows(const std::string& path) {
  const bool text = path.find(".npy") == std::string::npos;  // a .npy may hold infinite numbers
  app::QposFile file(path, kWidth);
  std::vector<double> row;
  for (std::string origin; file.Next(row, origin);) {
    const bool finite =
        std::all_of(row.begin(), row.end(), [](double v) { return std::isfinite(v); });
    if (row.size() != kWidth || (text && !finite)) return {"rows", "a row is no configuration"};
  }
  return {"rows", ""};
}

CaseOutcome ReadMesh(const std::string& path) {
  const TriangleMesh mesh = ReadMeshFile(path);
  if (!mesh.vertices.allFinite()) return {"mesh", "a vertex is not finite"};
  const bool corners = mesh.triangles.size() > 0 && mesh.triangles.minCoeff() >= 0 &&
                       mesh.triangles.maxCoeff() < mesh.vertices.cols();
  if (!corners) return {"mesh", "a corner does not exist"};
  return {"mesh", ""};
}

}  // namespace

CaseOutcome BytesCase(std::uint64_t seed) {
  Random rng(seed);
  const int kind = rng.Index(10);  // meshes are slow: each is read in a process of its own
  Bytes bytes = kind == 0 ? Mesh(rng) : kind < 5 ? Bytes{"m.xml", DrawScene(rng).xml} : Rows(rng);
  bytes.content = Damaged(bytes.content, rng);
  const TemporaryFolder folder;
  CaseOutcome outcome;
  try {
    if (kind == 0) {
      outcome = ReadMesh(Write(folder, bytes));
    } else if (kind < 5) {
      outcome = ReadModel(bytes.content);
    } else {
      outcome = ReadRows(Write(folder, bytes));
    }
  } catch (const Error&) {
    return {"refused", ""};
  }
  if (!outcome.wrong.empty()) outcome.wrong += " in " + bytes.name + ": " + bytes.content;
  return outcome;
}

}  // namespace mjcf_pdg::test
