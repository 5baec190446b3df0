// The generated rigid models: sound meshes, scenes that load, keyframes that are what they say.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "import/mesh_import.h"
#include "import/mesh_repair.h"
#include "mesh/mesh_components.h"
#include "mesh/triangle_mesh.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

std::set<fs::path> FilesOf(const std::string& ending) {
  std::set<fs::path> files;
  for (const std::string folder : {MJCF_PDG_MODEL_DIR "/rigid", MJCF_PDG_BIG_MODEL_DIR}) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.path().extension() == ending) files.insert(entry.path());
    }
  }
  return files;
}

TEST(RigidModelsTest, EveryMeshIsASoundSolidWithThePapersTriangleCount) {
  const std::map<std::string, int> counts = {
      {"cad", 2400},          {"spoon", 1340}, {"dragon", 174000}, {"bunny", 40000},
      {"torus_knot", 3000},   {"l_shape", 20}, {"cup", 1000},      {"pawn", 300},
      {"bumpy_sphere", 2900}, {"hammer", 1700}};
  std::size_t counted = 0;
  for (const fs::path& path : FilesOf(".obj")) {
    SCOPED_TRACE(path);
    const TriangleMesh read = WeldVertices(ReadMeshFile(path));
    MeshRepairs repairs;
    const TriangleMesh mesh = RepairMesh(read, &repairs);
    EXPECT_EQ(mesh.triangles, read.triangles);  // nothing to repair
    EXPECT_EQ(repairs.non_manifold_edges, 0);
    const MeshTopology topology = FindTopology(mesh);
    EXPECT_EQ(topology.components, 1);
    EXPECT_EQ(topology.open_edges, 0);
    EXPECT_EQ(topology.zero_area, 0);
    EXPECT_GT(FindSolidProperties(mesh).volume, 1e-6);
    const double radius =
        (mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff()).norm() / 2;
    EXPECT_GT(radius, 0.02);
    EXPECT_LT(radius, 0.4);
    const auto count = counts.find(path.stem());
    if (count == counts.end()) continue;
    ++counted;
    EXPECT_EQ(mesh.triangles.cols(), count->second);
  }
  EXPECT_EQ(counted, counts.size());
}

TEST(RigidModelsTest, TheSpoonHasTheInertiaOfFigureEleven) {
  const SolidProperties spoon =
      FindSolidProperties(ReadMeshFile(MJCF_PDG_MODEL_DIR "/rigid/assets/spoon.obj"));
  EXPECT_NEAR(spoon.inertia(2, 2) / spoon.inertia(1, 1), 10.0, 0.5);
}

class RigidScenesTest : public MujocoTest {};

// The triangles of a mesh geom in world axes.
TriangleMesh Posed(const mjModel* m, const mjData* d, int geom) {
  const int mesh = m->geom_dataid[geom];
  const auto vertices = Eigen::Map<const Eigen::Matrix3Xf>(m->mesh_vert + 3 * m->mesh_vertadr[mesh],
                                                           3, m->mesh_vertnum[mesh]);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turn(d->geom_xmat +
                                                                            9 * geom);
  const Eigen::Map<const Vector3d> place(d->geom_xpos + 3 * geom);
  return {(turn * vertices.cast<double>()).colwise() + place,
          Eigen::Map<const Eigen::Matrix3Xi>(m->mesh_face + 3 * m->mesh_faceadr[mesh], 3,
                                             m->mesh_facenum[mesh])};
}

// Whether the segment from p to q crosses the triangle a, b, c.
bool Crosses(const Vector3d& p, const Vector3d& q, const Eigen::Matrix3d& triangle) {
  const Vector3d a = triangle.col(0), u = triangle.col(1) - a, v = triangle.col(2) - a;
  const Vector3d ahead = q - p, n = u.cross(v);
  const double slope = n.dot(ahead);
  if (slope == 0.0) return false;
  const double t = n.dot(a - p) / slope;
  if (t < 0.0 || t > 1.0) return false;
  const Vector3d w = p + t * ahead - a;
  const double s1 = w.cross(v).dot(n), s2 = u.cross(w).dot(n);
  return s1 >= 0.0 && s2 >= 0.0 && s1 + s2 <= n.squaredNorm();
}

// Whether an edge of one surface crosses the other surface: brute force, with boxes.
bool EdgesCross(const TriangleMesh& edges, const TriangleMesh& faces) {
  std::vector<Eigen::AlignedBox3d> boxes;
  Eigen::AlignedBox3d all;
  for (const auto& corners : faces.triangles.colwise()) {
    Eigen::AlignedBox3d& box = boxes.emplace_back();
    for (const int corner : corners) box.extend(faces.vertices.col(corner));
    all.extend(box);
  }
  for (const auto& corners : edges.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = edges.vertices.col(corners[k]),
                     q = edges.vertices.col(corners[(k + 1) % 3]);
      Eigen::AlignedBox3d box(p.cwiseMin(q), p.cwiseMax(q));
      if (corners[k] > corners[(k + 1) % 3] || !all.intersects(box)) continue;
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!boxes[i].intersects(box)) continue;
        const auto triangle = faces.triangles.col(static_cast<Eigen::Index>(i));
        if (Crosses(p, q, faces.vertices(Eigen::all, triangle))) return true;
      }
    }
  }
  return false;
}

bool Contains(const TriangleMesh& mesh, const Vector3d& p) {
  int crossings = 0;
  for (const auto& corners : mesh.triangles.colwise()) {
    crossings += Crosses(p, p + Vector3d(1.3, 2.1, 3.7), mesh.vertices(Eigen::all, corners));
  }
  return crossings % 2 == 1;
}

bool Overlap(const TriangleMesh& a, const TriangleMesh& b) {
  return EdgesCross(a, b) || EdgesCross(b, a) || Contains(a, b.vertices.col(0)) ||
         Contains(b, a.vertices.col(0));
}

TEST_F(RigidScenesTest, HomeIsFreeAndEveryOtherKeyframePenetrates) {
  int scenes = 0;
  for (const fs::path& path : FilesOf(".xml")) {
    SCOPED_TRACE(path);
    char error[500] = "";
    const ModelPtr m(mj_loadXML(path.c_str(), nullptr, error, sizeof error));
    ASSERT_NE(m, nullptr) << error;
    ++scenes;
    ASSERT_EQ(m->ngeom, 2);
    EXPECT_EQ(m->nq, 7);
    EXPECT_EQ(m->body_dofnum[1], 6);
    EXPECT_GE(m->nkey, 2);
    ASSERT_EQ(m->ntext, 1);
    const std::string marked = m->text_data;
    EXPECT_EQ(marked, std::string(mj_id2name(m.get(), mjOBJ_GEOM, 0)) + " " +
                          mj_id2name(m.get(), mjOBJ_GEOM, 1));
    const DataPtr d(mj_makeData(m.get()));
    for (int key = 0; key < m->nkey; ++key) {
      const std::string name = mj_id2name(m.get(), mjOBJ_KEY, key);
      SCOPED_TRACE(name);
      mj_resetDataKeyframe(m.get(), d.get(), key);
      mj_kinematics(m.get(), d.get());
      const TriangleMesh a = Posed(m.get(), d.get(), 0), b = Posed(m.get(), d.get(), 1);
      EXPECT_EQ(Overlap(a, b), name != "home");
    }
  }
  EXPECT_EQ(scenes, 10);
}

}  // namespace
}  // namespace mjcf_pdg::test
