#include "mesh_import.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include "mjcf_pdg/types.h"
#include "ply_check.h"

namespace mjcf_pdg {
namespace {

constexpr double kMaxCoordinate = 1e10;  // MuJoCo's own limit (mjMAXVAL)

// In lower case.
std::string Ending(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending;
}

void CheckFile(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) throw Error(path + ": no such file");
  if (!std::filesystem::is_regular_file(path, ec)) throw Error(path + ": is not a file");
  if (std::filesystem::file_size(path, ec) == 0) throw Error(path + ": the file is empty");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(path + ": cannot be read");
  if (Ending(path) == ".ply" && !IsWholePly(stream)) {
    throw Error(path + ": the file ends too early or its header is wrong");
  }
}

struct Part {
  const aiMesh* mesh;
  Eigen::Affine3d pose;  // in the file's axes
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

// assimp turns 3ds files by this, from z up to y up.
Eigen::Affine3d AxesOfFile(const std::string& path) {
  Eigen::Affine3d turn = Eigen::Affine3d::Identity();
  if (Ending(path) == ".3ds") turn.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return turn;
}

Size SizeOf(const std::vector<Part>& parts) {
  Size size;
  for (const Part& part : parts) {
    size.vertices += part.mesh->mNumVertices;
    size.triangles += part.mesh->mNumFaces;
  }
  return size;
}

// A mesh of its own type, because GCC 12 drops the rounding from (double)(float)x in vectorized
// code.
struct FloatMesh {
  Eigen::Matrix3Xf vertices;
  Eigen::Matrix3Xi triangles;
};

// Fills the columns after the first `begin.vertices` and `begin.triangles`.
void FillPart(const Part& part, const std::string& path, Size begin, FloatMesh* mesh) {
  const aiMesh& source = *part.mesh;
  const bool mirrored = part.pose.linear().determinant() < 0.0;
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    const aiVector3D& v = source.mVertices[i];
    const Eigen::Vector3d p = part.pose * Eigen::Vector3d(v.x, v.y, v.z);
    if (!p.allFinite()) throw Error(path + ": a vertex is not finite");
    if (p.cwiseAbs().maxCoeff() > kMaxCoordinate) {
      throw Error(path + ": a coordinate is beyond 1e10 m");
    }
    mesh->vertices.col(static_cast<Eigen::Index>(begin.vertices + i)) = p.cast<float>();
  }
  for (unsigned i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices != 3 ||
        *std::max_element(face.mIndices, face.mIndices + 3) >= source.mNumVertices) {
      throw Error(path + ": a face has a corner that does not exist");
    }
    auto corners = mesh->triangles.col(static_cast<Eigen::Index>(begin.triangles + i));
    for (int k = 0; k < 3; ++k) corners[k] = static_cast<int>(begin.vertices + face.mIndices[k]);
    if (mirrored) std::swap(corners[1], corners[2]);
  }
}

}  // namespace

TriangleMesh ReadMeshFile(const std::string& path, double scale) {
  CheckFile(path);
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TEXCOORDS | aiComponent_COLORS |
                                  aiComponent_TEXTURES | aiComponent_MATERIALS |
                                  aiComponent_ANIMATIONS);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* const scene = importer.ReadFile(
      path, aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_SortByPType);
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
  for (const Part& part : parts) {
    FillPart(part, path, filled, &mesh);
    filled.vertices += part.mesh->mNumVertices;
    filled.triangles += part.mesh->mNumFaces;
  }
  return {mesh.vertices.cast<double>(), std::move(mesh.triangles)};
}

}  // namespace mjcf_pdg
