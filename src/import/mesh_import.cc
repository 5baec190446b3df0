#include "import/mesh_import.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "import/mesh_file.h"
#include "import/polygon.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

constexpr double kMaxCoordinate = 1e10;  // MuJoCo's own limit (mjMAXVAL)

// A mesh of the file at one place of its node tree.
struct Part {
  const aiMesh* mesh;
  Eigen::Affine3d pose;  // scale included, in the file's axes
};

struct Size {
  std::uint64_t vertices = 0, triangles = 0;
};

void CollectParts(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& parent,
                  std::vector<Part>* parts) {
  Eigen::Affine3d pose = parent;
  pose.matrix() = parent.matrix() * Eigen::Map<const Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>>(
                                        &node.mTransformation.a1)
                                        .cast<double>();
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    parts->push_back({scene.mMeshes[node.mMeshes[i]], pose});
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    CollectParts(scene, *node.mChildren[i], pose, parts);
  }
}

// Undoes the rotation from z up to y up that assimp gives to 3ds files.
Eigen::Affine3d AxesOfFile(const std::string& path) {
  Eigen::Affine3d turn = Eigen::Affine3d::Identity();
  if (MeshFormat(path) == "3ds") turn.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return turn;
}

Size SizeOf(const std::vector<Part>& parts) {
  Size size;
  for (const Part& part : parts) {
    size.vertices += part.mesh->mNumVertices;
    for (unsigned i = 0; i < part.mesh->mNumFaces; ++i) {
      size.triangles += std::max(part.mesh->mFaces[i].mNumIndices, 2u) - 2;
    }
  }
  return size;
}

// A mesh in single precision. It has a type of its own because GCC 12 drops the rounding of
// (double)(float)x from vectorized code.
struct FloatMesh {
  Eigen::Matrix3Xf vertices;
  Eigen::Matrix3Xi triangles;
};

Eigen::Vector3d Position(const aiMesh& mesh, unsigned vertex) {
  const aiVector3D& v = mesh.mVertices[vertex];
  return {v.x, v.y, v.z};
}

// Cuts a polygon into triangles. assimp's own triangulation drops corners in the middle of a side,
// which leaves cracks.
std::vector<std::array<int, 3>> CutFace(const aiMesh& mesh, const aiFace& face) {
  Eigen::Matrix3Xd corners(3, face.mNumIndices);
  for (unsigned k = 0; k < face.mNumIndices; ++k) {
    corners.col(k) = Position(mesh, face.mIndices[k]);
  }
  std::vector<std::array<int, 3>> triangles = CutPolygon(corners);
  for (std::array<int, 3>& triangle : triangles) {
    for (int& corner : triangle) corner = static_cast<int>(face.mIndices[corner]);
  }
  return triangles;
}

// Writes a part to the columns of `mesh` after the first `*filled` ones, and adds to these counts.
void FillPart(const Part& part, const std::string& path, Size* filled, FloatMesh* mesh) {
  const aiMesh& source = *part.mesh;
  const bool mirrored = part.pose.linear().determinant() < 0.0;
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    const Eigen::Vector3d p = part.pose * Position(source, i);
    if (!p.allFinite()) throw Error(path + ": a vertex is not finite");
    if (p.cwiseAbs().maxCoeff() > kMaxCoordinate) {
      throw Error(path + ": a coordinate is beyond 1e10 m");
    }
    mesh->vertices.col(static_cast<Eigen::Index>(filled->vertices + i)) = p.cast<float>();
  }
  for (unsigned i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    const std::span<const unsigned> indices(face.mIndices, face.mNumIndices);
    if (indices.size() < 3 || std::ranges::max(indices) >= source.mNumVertices) {
      throw Error(path + ": a face has a corner that does not exist");
    }
    for (const std::array<int, 3>& triangle : CutFace(source, face)) {
      auto corners = mesh->triangles.col(static_cast<Eigen::Index>(filled->triangles++));
      for (int k = 0; k < 3; ++k) corners[k] = static_cast<int>(filled->vertices) + triangle[k];
      if (mirrored) std::swap(corners[1], corners[2]);
    }
  }
  filled->vertices += source.mNumVertices;
}

// Reads the file, or `instead` in place of its bytes if that is not empty.
FloatMesh ReadThroughAssimp(const std::string& path, const std::string& instead, double scale) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TEXCOORDS | aiComponent_COLORS |
                                  aiComponent_TEXTURES | aiComponent_MATERIALS |
                                  aiComponent_ANIMATIONS);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  constexpr unsigned kSteps = aiProcess_RemoveComponent | aiProcess_SortByPType;
  const aiScene* const scene = instead.empty()
                                   ? importer.ReadFile(path, kSteps)
                                   : importer.ReadFileFromMemory(instead.data(), instead.size(),
                                                                 kSteps, MeshFormat(path).c_str());
  if (!scene || !scene->mRootNode) {
    throw Error(path + ": cannot be read as a mesh: " + importer.GetErrorString());
  }
  std::vector<Part> parts;
  const Eigen::Affine3d axes = AxesOfFile(path) * Eigen::Scaling(scale);
  CollectParts(*scene, *scene->mRootNode, axes, &parts);
  const Size size = SizeOf(parts);
  if (size.triangles == 0) throw Error(path + ": has no triangles");
  for (const std::uint64_t count : {size.triangles, size.vertices / 3}) {
    if (count <= kMaxTriangles) continue;
    throw Error(path + ": has " + std::to_string(count) + " triangles, more than " +
                std::to_string(kMaxTriangles));
  }
  FloatMesh mesh = {Eigen::Matrix3Xf(3, size.vertices), Eigen::Matrix3Xi(3, size.triangles)};
  Size filled;
  for (const Part& part : parts) FillPart(part, path, &filled, &mesh);
  return mesh;
}

// ---- assimp 5.2 crashes on some damaged files and hangs on others: it gets its own process ----

constexpr rlim_t kMaxSeconds = 60;  // processor time; a million triangles take one or two seconds

void Send(int pipe, const void* data, std::size_t size) {
  const char* next = static_cast<const char*>(data);
  for (ssize_t sent = 0; size > 0; next += sent, size -= static_cast<std::size_t>(sent)) {
    sent = ::write(pipe, next, size);
    if (sent <= 0) ::_exit(1);
  }
}

// The child process: writes to the pipe the counts of vertices and triangles, then both arrays,
// then the error message, which is empty unless the counts are zero.
[[noreturn]] void ReadAndSend(const std::string& path, const std::string& instead, double scale,
                              int pipe) {
  const rlimit no_core = {0, 0}, time = {kMaxSeconds, kMaxSeconds};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &time);
  if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) ::dup2(nowhere, 2);
  FloatMesh mesh;
  std::string complaint;
  try {
    mesh = ReadThroughAssimp(path, instead, scale);
  } catch (const Error& e) {
    complaint = e.what();
  } catch (const std::exception& e) {
    complaint = path + ": cannot be read as a mesh: " + e.what();
  }
  const std::array<Eigen::Index, 2> counts = {mesh.vertices.cols(), mesh.triangles.cols()};
  Send(pipe, counts.data(), sizeof counts);
  Send(pipe, mesh.vertices.data(), sizeof(float) * mesh.vertices.size());
  Send(pipe, mesh.triangles.data(), sizeof(int) * mesh.triangles.size());
  Send(pipe, complaint.data(), complaint.size());
  ::_exit(0);
}

std::string Receive(int pipe) {
  std::string bytes;
  std::array<char, 1 << 16> buffer;
  for (ssize_t n = 0; (n = ::read(pipe, buffer.data(), buffer.size())) > 0;) {
    bytes.append(buffer.data(), static_cast<std::size_t>(n));
  }
  return bytes;
}

FloatMesh Unpack(const std::string& bytes) {
  std::array<Eigen::Index, 2> counts;
  std::memcpy(counts.data(), bytes.data(), sizeof counts);
  FloatMesh mesh = {Eigen::Matrix3Xf(3, counts[0]), Eigen::Matrix3Xi(3, counts[1])};
  if (counts[1] == 0) throw Error(bytes.substr(sizeof counts));
  const std::size_t vertex_bytes = sizeof(float) * mesh.vertices.size();
  std::memcpy(mesh.vertices.data(), bytes.data() + sizeof counts, vertex_bytes);
  std::memcpy(mesh.triangles.data(), bytes.data() + sizeof counts + vertex_bytes,
              sizeof(int) * mesh.triangles.size());
  return mesh;
}

}  // namespace

TriangleMesh ReadMeshFile(const std::string& path, double scale) {
  const std::string instead = CheckMeshFile(path);
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("cannot make a pipe");
  const pid_t child = ::fork();
  if (child == 0) ReadAndSend(path, instead, scale, ends[1]);
  ::close(ends[1]);
  const std::string bytes = child > 0 ? Receive(ends[0]) : "";
  ::close(ends[0]);
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child) {
    throw std::runtime_error("cannot start a process to read " + path);
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw Error(path + ": the file is damaged: assimp does not survive it");
  }
  const FloatMesh mesh = Unpack(bytes);
  return {mesh.vertices.cast<double>(), mesh.triangles};
}

}  // namespace mjcf_pdg
