#include "apps/html/scene_block.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "apps/html/packed.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kPixels = 65536;  // of a texture that are read: a mean needs no more

struct Triangles {
  std::vector<float> vertices;  // x, y, z each [m]
  std::vector<std::uint32_t> faces;
};

Triangles MeshTriangles(const mjModel& m, int mesh) {
  Triangles t;
  const float* v = m.mesh_vert + 3 * m.mesh_vertadr[mesh];
  t.vertices.assign(v, v + 3 * m.mesh_vertnum[mesh]);
  const int* f = m.mesh_face + 3 * m.mesh_faceadr[mesh];
  t.faces.assign(f, f + 3 * m.mesh_facenum[mesh]);
  return t;
}

// The surface of a height field.
Triangles FieldTriangles(const mjModel& m, int field) {
  Triangles t;
  const int rows = m.hfield_nrow[field], columns = m.hfield_ncol[field];
  const mjtNum* size = m.hfield_size + 4 * field;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const double height = m.hfield_data[m.hfield_adr[field] + r * columns + c];
      for (const double x : {size[0] * (2.0 * c / (columns - 1) - 1.0),
                             size[1] * (2.0 * r / (rows - 1) - 1.0), size[2] * height}) {
        t.vertices.push_back(static_cast<float>(x));
      }
      if (r + 1 == rows || c + 1 == columns) continue;
      const auto at = static_cast<std::uint32_t>(r * columns + c);
      const auto up = at + static_cast<std::uint32_t>(columns);
      t.faces.insert(t.faces.end(), {at, at + 1, up + 1, at, up + 1, up});
    }
  }
  return t;
}

template <typename T>
void AppendBytes(const std::vector<T>& values, std::string& bytes) {
  bytes.append(BytesOf(values));
  bytes.resize((bytes.size() + 3) / 4 * 4);  // so that the next array is aligned
}

// Where the mesh lies in `bytes`, to which it is appended.
Json AppendMesh(const Triangles& t, std::string& bytes) {
  std::array<float, 3> low, high;
  low.fill(0.0f);
  high.fill(0.0f);
  for (std::size_t k = 0; k < t.vertices.size(); ++k) {
    low[k % 3] = k < 3 ? t.vertices[k] : std::min(low[k % 3], t.vertices[k]);
    high[k % 3] = k < 3 ? t.vertices[k] : std::max(high[k % 3], t.vertices[k]);
  }
  std::vector<std::uint16_t> packed;
  for (std::size_t k = 0; k < t.vertices.size(); ++k) {
    const float extent = high[k % 3] - low[k % 3];
    const float share = extent > 0.0f ? (t.vertices[k] - low[k % 3]) / extent : 0.0f;
    packed.push_back(static_cast<std::uint16_t>(std::lround(65535.0f * share)));
  }
  Json mesh = {{"nv", packed.size() / 3}, {"nf", t.faces.size() / 3}, {"low", low}, {"high", high}};
  mesh["vertices"] = bytes.size();
  AppendBytes(packed, bytes);
  mesh["faces"] = bytes.size();
  AppendBytes(t.faces, bytes);
  return mesh;
}

const char* ShapeName(int type) {
  switch (type) {
    case mjGEOM_PLANE:
      return "plane";
    case mjGEOM_SPHERE:
      return "sphere";
    case mjGEOM_CAPSULE:
      return "capsule";
    case mjGEOM_ELLIPSOID:
      return "ellipsoid";
    case mjGEOM_CYLINDER:
      return "cylinder";
    case mjGEOM_BOX:
      return "box";
    default:
      return "mesh";
  }
}

bool Collides(const mjModel& m, int geom) {
  if (m.geom_contype[geom] || m.geom_conaffinity[geom]) return true;
  for (int p = 0; p < m.npair; ++p) {
    if (m.pair_geom1[p] == geom || m.pair_geom2[p] == geom) return true;
  }
  return false;
}

// The mean colour of the material's texture; white without one. Textures themselves are left out.
std::array<float, 3> MeanTexture(const mjModel& m, int material) {
  std::array<float, 3> mean = {1.0f, 1.0f, 1.0f};
  const int* roles = m.mat_texid + mjNTEXROLE * material;
  const int texture = roles[mjTEXROLE_RGB] >= 0 ? roles[mjTEXROLE_RGB] : roles[mjTEXROLE_RGBA];
  if (texture < 0 || m.tex_nchannel[texture] < 3) return mean;
  const auto channels = static_cast<std::size_t>(m.tex_nchannel[texture]);
  const std::size_t pixels = static_cast<std::size_t>(m.tex_height[texture]) *
                             static_cast<std::size_t>(m.tex_width[texture]);
  const mjtByte* data = m.tex_data + m.tex_adr[texture];
  const std::size_t stride = pixels / kPixels + 1;
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < pixels; k += stride, ++count) sum += data[channels * k + c];
    if (count > 0.0) mean[c] = static_cast<float>(sum / (255.0 * count));
  }
  return mean;
}

Json GeomJson(const mjModel& m, int g) {
  const mjtNum* size = m.geom_size + 3 * g;
  const mjtNum* p = m.geom_pos + 3 * g;
  const mjtNum* q = m.geom_quat + 4 * g;
  const int material = m.geom_matid[g];
  const float* rgba = material >= 0 ? m.mat_rgba + 4 * material : m.geom_rgba + 4 * g;
  std::array<float, 3> mean = {1.0f, 1.0f, 1.0f};
  if (material >= 0) mean = MeanTexture(m, material);
  return {{"id", g},
          {"body", m.geom_bodyid[g]},
          {"type", ShapeName(m.geom_type[g])},
          {"size", {size[0], size[1], size[2]}},
          {"pose", {p[0], p[1], p[2], q[0], q[1], q[2], q[3]}},
          {"rgba", {mean[0] * rgba[0], mean[1] * rgba[1], mean[2] * rgba[2], rgba[3]}},
          {"group", m.geom_group[g]},
          {"collides", Collides(m, g)}};
}

}  // namespace

std::string SceneBlock(const mjModel& m) {
  Json scene = {{"nbody", m.nbody}, {"meshes", Json::array()}, {"geoms", Json::array()}};
  std::string bytes;
  // Where the meshes and height fields that geoms use are in the list; -1: not yet.
  std::vector<int> meshes(m.nmesh, -1), fields(m.nhfield, -1);
  for (int g = 0; g < m.ngeom; ++g) {
    Json geom = GeomJson(m, g);
    if (geom["type"] == "mesh") {
      const int data = m.geom_dataid[g];
      if (data < 0) continue;
      const bool field = m.geom_type[g] == mjGEOM_HFIELD;
      int& at = (field ? fields : meshes)[data];
      if (at < 0) {
        at = static_cast<int>(scene["meshes"].size());
        scene["meshes"].push_back(
            AppendMesh(field ? FieldTriangles(m, data) : MeshTriangles(m, data), bytes));
      }
      geom["mesh"] = at;
    }
    scene["geoms"].push_back(std::move(geom));
  }
  return Pack(scene, bytes);
}

void AppendPoses(const mjModel& m, mjData* d, const Configuration& row,
                 const std::vector<double>& q, std::vector<float>& poses) {
  std::copy(q.begin(), q.end(), d->qpos);
  std::copy(row.mocap_pos.begin(), row.mocap_pos.end(), d->mocap_pos);
  std::copy(row.mocap_quat.begin(), row.mocap_quat.end(), d->mocap_quat);
  mj_kinematics(&m, d);
  for (int b = 0; b < m.nbody; ++b) {
    for (int k = 0; k < 3; ++k) poses.push_back(static_cast<float>(d->xpos[3 * b + k]));
    for (int k = 0; k < 4; ++k) poses.push_back(static_cast<float>(d->xquat[4 * b + k]));
  }
}

}  // namespace mjcf_pdg::app
