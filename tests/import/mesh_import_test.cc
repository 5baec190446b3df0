// Mesh files of every format: the same triangles come out, or one clear line.
#include "import/mesh_import.h"

#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "import/mesh_repair.h"
#include "mesh/mesh_components.h"
#include "tests/support/hand_made_meshes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;

class MeshImportTest : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  std::string Path(const std::string& name) const { return folder_ / name; }
  static std::string Text(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  TemporaryFolder folder_;
};

TriangleMesh Import(const std::string& path, double scale = 1.0) {
  MeshRepairs repairs;
  return RepairMesh(WeldVertices(ReadMeshFile(path, scale)), &repairs);
}

// One mesh below a node that mirrors it (x -> 3 - x), or turns it about z (y -> -y as well).
void Export(const TriangleMesh& mesh, const std::string& format, const std::string& path,
            bool mirrored = true) {
  aiScene scene;
  scene.mNumMaterials = 1;
  scene.mMaterials = new aiMaterial*[1]{new aiMaterial};
  scene.mNumMeshes = 1;
  scene.mMeshes = new aiMesh*[1]{new aiMesh};
  aiMesh& target = *scene.mMeshes[0];
  target.mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  target.mNumVertices = static_cast<unsigned>(mesh.vertices.cols());
  target.mVertices = new aiVector3D[target.mNumVertices];
  target.mNormals = new aiVector3D[target.mNumVertices];
  for (unsigned i = 0; i < target.mNumVertices; ++i) {
    const Eigen::Vector3f p = mesh.vertices.col(i).cast<float>();
    target.mVertices[i] = aiVector3D(p.x(), p.y(), p.z());
    target.mNormals[i] = aiVector3D(0, 0, 1);
  }
  target.mNumFaces = static_cast<unsigned>(mesh.triangles.cols());
  target.mFaces = new aiFace[target.mNumFaces];
  for (unsigned i = 0; i < target.mNumFaces; ++i) {
    target.mFaces[i].mNumIndices = 3;
    target.mFaces[i].mIndices = new unsigned[3];
    for (int k = 0; k < 3; ++k) target.mFaces[i].mIndices[k] = mesh.triangles(k, i);
  }
  scene.mRootNode = new aiNode("root");
  aiNode* child = new aiNode("child");
  child->mTransformation.a1 = -1;
  child->mTransformation.a4 = 3;
  child->mTransformation.b2 = mirrored ? 1 : -1;
  child->mNumMeshes = 1;
  child->mMeshes = new unsigned[1]{0};
  scene.mRootNode->addChildren(1, &child);
  Assimp::Exporter exporter;
  ASSERT_EQ(exporter.Export(&scene, format, path), aiReturn_SUCCESS) << exporter.GetErrorString();
}

struct Format {
  const char* id;
  const char* ending;
};

class MeshFormatTest : public MeshImportTest, public ::testing::WithParamInterface<Format> {};

TEST_P(MeshFormatTest, ComesOutAsItWasIncludingNodeTransforms) {
  TriangleMesh mesh = TorusMesh(0.5, 0.125, 16);
  mesh.vertices.colwise() += Vector3d(1.0, 2.0, 4.0);
  const std::string path = Path(std::string("torus.") + GetParam().ending);
  // assimp turns a mirroring 3ds node into another one.
  const bool mirrored = GetParam().id != std::string("3ds");
  Export(mesh, GetParam().id, path, mirrored);
  const Vector3d center(2.0, mirrored ? 2.0 : -2.0, 4.0);
  const TriangleMesh read = Import(path);
  EXPECT_EQ(read.triangles.cols(), mesh.triangles.cols());
  EXPECT_EQ(read.vertices.cols(), mesh.vertices.cols());
  EXPECT_EQ(FindTopology(read).open_edges, 0);
  const SolidProperties expected = FindSolidProperties(mesh), solid = FindSolidProperties(read);
  EXPECT_NEAR(solid.volume, expected.volume, 1e-5 * expected.volume);
  EXPECT_TRUE(solid.center.isApprox(center, 1e-5)) << solid.center.transpose();
  EXPECT_TRUE(solid.inertia.isApprox(expected.inertia, 1e-4)) << solid.inertia;
}

INSTANTIATE_TEST_SUITE_P(Formats, MeshFormatTest,
                         ::testing::Values(Format{"obj", "obj"}, Format{"stl", "stl"},
                                           Format{"stlb", "STL"}, Format{"ply", "ply"},
                                           Format{"plyb", "ply"}, Format{"collada", "dae"},
                                           Format{"3ds", "3ds"}, Format{"glb2", "glb"},
                                           Format{"gltf2", "gltf"}, Format{"x", "x"}),
                         [](const auto& test) { return std::string(test.param.id); });

TEST_F(MeshImportTest, ALargeThreeDsFileIsSplitAndComesOutWhole) {
  const TriangleMesh mesh = TorusMesh(0.5, 0.125, 200);  // 80000 triangles, 16-bit indices
  Export(mesh, "3ds", Path("torus.3ds"));
  const TriangleMesh read = Import(Path("torus.3ds"));
  EXPECT_EQ(read.triangles.cols(), mesh.triangles.cols());
  EXPECT_EQ(FindTopology(read).open_edges, 0);
}

TEST_F(MeshImportTest, PolygonsAreCutAndLinesAndPointsLeftOut) {
  const std::string path = Write("quad.obj",
                                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\n"
                                 "f 1 2 3 4\nl 1 5\np 5\n");
  const TriangleMesh read = Import(path);
  EXPECT_EQ(read.triangles.cols(), 2);
  EXPECT_EQ(read.vertices.cols(), 4);
  EXPECT_DOUBLE_EQ(SurfaceArea(read), 1.0);
}

TEST_F(MeshImportTest, AxesOfAColladaFileStayWhateverItCallsUp) {
  Export(TetrahedronMesh(), "collada", Path("t.dae"));
  std::string text = Text(Path("t.dae"));
  const std::size_t up = text.find("Y_UP");
  ASSERT_NE(up, std::string::npos);
  const TriangleMesh y_up = Import(Path("t.dae"));
  const TriangleMesh z_up = Import(Write("z.dae", text.replace(up, 4, "Z_UP")));
  EXPECT_EQ(y_up.vertices, z_up.vertices);
}

TEST_F(MeshImportTest, AMirroringNodeDoesNotTurnTheSurfaceInsideOut) {
  Export(CubeMesh(), "glb2",
         Path("cube.glb"));  // keeps nodes; others write what they do to vertices
  EXPECT_NEAR(FindSolidProperties(ReadMeshFile(Path("cube.glb"))).volume, 1.0, 1e-6);
}

TEST_F(MeshImportTest, ScaleMultipliesCoordinates) {
  const std::string path = Write("cube.obj", ObjText(CubeMesh({1000.0, 0.0, 0.0})));
  const SolidProperties solid = FindSolidProperties(Import(path, 0.001));
  EXPECT_NEAR(solid.volume, 1e-9, 1e-13);
  EXPECT_TRUE(solid.center.isApprox(Vector3d(1.0005, 0.0005, 0.0005), 1e-6));
}

TEST_F(MeshImportTest, CoordinatesAreThoseOfSinglePrecision) {
  const TriangleMesh read = Import(Write("t.obj", ObjText(CuboidMesh({0.1, 0.2, 0.3}))), 0.7);
  for (const double x : read.vertices.reshaped()) EXPECT_EQ(x, static_cast<float>(x));
}

TEST_F(MeshImportTest, BadFilesAreRefusedInOneLineThatNamesThem) {
  const auto refused = [](const std::string& path, const std::string& words) {
    const std::string error = ErrorOf([&] { ReadMeshFile(path); });
    EXPECT_NE(error.find(path), std::string::npos) << error;
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  refused(Path("missing.obj"), "no such file");
  refused(std::filesystem::path(Path("x")).parent_path(), "is not a file");
  refused(Write("empty.stl", ""), "is empty");
  refused(Write("mesh.txt", "solid of nothing"), "cannot be read as a mesh");
  refused(Write("noise.ply", "ply\nnot at all"), "its header is wrong");
  refused(Write("noise.stl", "not at all"), "cannot be read as a mesh");
  refused(Write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "");
  refused(Write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n"), "");
  refused(Write("far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n"), "beyond 1e10");
  refused(Write("nowhere.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), "not finite");
  refused(Write("cut.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
          "ends too early");
  refused(Write("bones.bvh",
                "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 0\nJOINT A\n{\nOFFSET 0 5 0\n"
                "CHANNELS 0\nEnd Site\n{\nOFFSET 3 5 0\n}\n}\n}\nMOTION\nFrames: 1\n"
                "Frame Time: 0.033\n0\n"),
          "has no triangles");
  refused(Write("corner.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), "");
}

TEST_F(MeshImportTest, AByteOrderMarkHidesNothing) {
  for (const Format format : {Format{"obj", "obj"}, Format{"stl", "stl"}, Format{"ply", "ply"},
                              Format{"collada", "dae"}}) {
    SCOPED_TRACE(format.id);
    const std::string plain = Path(std::string("plain.") + format.ending);
    Export(CubeMesh({1, 2, 3}), format.id, plain, false);
    // assimp's files begin with a comment, which may as well be lost.
    const std::string text = Text(plain);
    const std::size_t begin = format.id == std::string("obj") ? text.find("v ") : 0;
    const std::string marked =
        Write(std::string("marked.") + format.ending, "\xEF\xBB\xBF" + text.substr(begin));
    const TriangleMesh expected = ReadMeshFile(plain), read = ReadMeshFile(marked);
    EXPECT_EQ(read.vertices, expected.vertices);
    EXPECT_EQ(read.triangles, expected.triangles);
  }
}

TEST_F(MeshImportTest, AnStlFileInCapitalsOrWithPaddingIsRead) {
  Export(CubeMesh(), "stl", Path("ascii.stl"), false);
  Export(CubeMesh(), "stlb", Path("binary.stl"), false);
  std::string capitals = Text(Path("ascii.stl"));
  std::transform(capitals.begin(), capitals.end(), capitals.begin(), ::toupper);
  const Eigen::Matrix3Xd expected = ReadMeshFile(Path("ascii.stl")).vertices;
  EXPECT_EQ(ReadMeshFile(Write("capitals.stl", capitals)).vertices, expected);
  const std::string padded = Text(Path("binary.stl")) + std::string(20, '\0');
  EXPECT_EQ(ReadMeshFile(Write("padded.stl", padded)).vertices, expected);
}

TEST_F(MeshImportTest, AColladaFileWhoseUnitIsNoLengthIsRefused) {
  Export(CubeMesh(), "collada", Path("cube.dae"), false);
  std::string text = Text(Path("cube.dae"));
  const std::string unit = "meter=\"1\"";
  const std::size_t place = text.find(unit);
  ASSERT_NE(place, std::string::npos);
  const auto with_unit = [&](const std::string& value) {
    return Write("unit.dae", std::string(text).replace(place, unit.size(), "meter=" + value));
  };
  for (const char* const value : {"\"abc\"", "\"0\"", "\"-1\"", "\"nan\"", "\"\"", "'1 m'"}) {
    const std::string error = ErrorOf([&] { ReadMeshFile(with_unit(value)); });
    EXPECT_NE(error.find("is not a positive number"), std::string::npos) << error;
  }
  EXPECT_NEAR(SurfaceArea(ReadMeshFile(with_unit("'0.01'"))), 6e-4, 1e-9);
}

TEST_F(MeshImportTest, AGlbFileWithACornerThatDoesNotExistIsRefused) {
  Export(CubeMesh(), "glb2", Path("cube.glb"));
  std::string bytes = Text(Path("cube.glb"));
  // The corners of the first triangle, as 16-bit or 32-bit numbers: the first becomes a far one.
  const Eigen::Vector3i corners = CubeMesh().triangles.col(0);
  const auto replace_first = [&](auto number) {
    decltype(number) wanted[3];
    for (int k = 0; k < 3; ++k) wanted[k] = static_cast<decltype(number)>(corners[k]);
    const std::string words(reinterpret_cast<const char*>(wanted), sizeof wanted);
    const std::size_t place = bytes.find(words);
    if (place == std::string::npos) return false;
    wanted[0] = 999;
    bytes.replace(place, words.size(), reinterpret_cast<const char*>(wanted), sizeof wanted);
    return true;
  };
  ASSERT_TRUE(replace_first(std::uint16_t{}) || replace_first(std::uint32_t{}));
  const std::string error = ErrorOf([&] { ReadMeshFile(Write("far.glb", bytes)); });
  EXPECT_NE(error.find("far.glb: a face has a corner that does not exist"), std::string::npos)
      << error;
}

TEST_F(MeshImportTest, PolygonsWithCornersInTheMiddleOfASideLeaveNoCracks) {
  // A comb; its teeth's roots are in one line.
  const std::vector<Vector3d> profile = {{0, -1, 0}, {6, -1, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0},
                                         {5, 0, 0},  {4, 0, 0},  {4, 2, 0}, {3, 2, 0}, {3, 0, 0},
                                         {2, 0, 0},  {2, 1, 0},  {1, 1, 0}, {1, 0, 0}, {0, 0, 0}};
  const int n = static_cast<int>(profile.size());
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Matrix3d turn = random.UnitQuat().toRotationMatrix();
    std::ostringstream text;
    text.precision(9);
    for (const double z : {0.0, 1.0}) {
      for (const Vector3d& p : profile) {
        text << "v " << (turn * (p + z * Vector3d::UnitZ())).transpose() << "\n";
      }
    }
    for (int i = 0; i < n; ++i) text << (i == 0 ? "f " : " ") << n - i;
    for (int i = 0; i < n; ++i) text << (i == 0 ? "\nf " : " ") << n + i + 1;
    for (int i = 1; i <= n; ++i) {
      const int next = i % n + 1;
      text << "\nf " << i << " " << next << " " << n + next << " " << n + i;
    }
    const TriangleMesh comb = Import(Write("comb.obj", text.str() + "\n"));
    EXPECT_EQ(comb.triangles.cols(), 4 * n - 4);
    EXPECT_EQ(FindTopology(comb).open_edges, 0);
    EXPECT_NEAR(FindSolidProperties(comb).volume, 10.0, 1e-5);
  }
}

TEST_F(MeshImportTest, TruncatedFilesAreRefusedOrReadNeverACrash) {
  int refused = 0, read = 0;
  for (const Format format : {Format{"stlb", "stl"}, Format{"stl", "stl"}, Format{"plyb", "ply"},
                              Format{"ply", "ply"}, Format{"3ds", "3ds"}, Format{"glb2", "glb"},
                              Format{"obj", "obj"}, Format{"collada", "dae"}}) {
    const std::string whole = Path(std::string("whole.") + format.ending);
    Export(CubeMesh(), format.id, whole);
    const std::string bytes = Text(whole);
    for (int part = 1; part < 40; ++part) {
      const std::string path =
          Write(std::string("part.") + format.ending, bytes.substr(0, bytes.size() * part / 40));
      try {
        const TriangleMesh mesh = ReadMeshFile(path);
        EXPECT_TRUE(mesh.vertices.allFinite());
        ++read;
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 150);
  EXPECT_GT(read, 0);
}

// Whether assimp, in a process of its own, gets a triangle out of a file. What it makes of damaged
// ones differs from version to version: some die of them.
bool AssimpReads(const std::string& path) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit no_core = {0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    Assimp::Importer importer;
    const aiScene* const scene = importer.ReadFile(path, 0);
    const bool has_face = scene && scene->mNumMeshes > 0 && scene->mMeshes[0]->mNumFaces > 0;
    ::_exit(has_face && scene->mMeshes[0]->mFaces[0].mNumIndices == 3 ? 0 : 1);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// A NUL follows a coordinate. assimp 5.2 takes it for the end of the line and finds no corners, 5.4
// for a blank.
TEST_F(MeshImportTest, AFileWithANulIsReadIfAssimpDoesAndRefusedOtherwise) {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
      "0 0? 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n";
  ply[ply.find('?')] = '\0';
  const std::string path = Write("nul.ply", ply);
  if (AssimpReads(path)) {
    const TriangleMesh mesh = ReadMeshFile(path);
    EXPECT_EQ(mesh.triangles.cols(), 1);
    EXPECT_NEAR(SurfaceArea(mesh), 0.5, 1e-6);
  } else {
    EXPECT_EQ(ErrorOf([&] { ReadMeshFile(path); }).rfind(path, 0), 0u);
  }
}

// Kills what is forked while it is set; a handler of fork cannot be taken back.
bool g_children_die = false;

// Whatever assimp has been cured of: the next crash is dealt with, too.
TEST_F(MeshImportTest, AReaderThatIsKilledIsAnErrorThatNamesTheFile) {
  ASSERT_EQ(::pthread_atfork(nullptr, nullptr,
                             [] {
                               if (g_children_die) ::raise(SIGKILL);
                             }),
            0);
  const std::string path = Write("cube.obj", ObjText(CubeMesh()));
  g_children_die = true;
  const std::string error = ErrorOf([&] { ReadMeshFile(path); });
  g_children_die = false;
  EXPECT_EQ(error, path + ": the file is damaged: assimp does not survive it");
  EXPECT_EQ(ReadMeshFile(path).triangles.cols(), 12);
}

TEST_F(MeshImportTest, AnOffFileThatPromisesTooMuchIsRefusedBeforeMemoryIsTaken) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(ReadMeshFile(Write("whole.off", "OFF\n# three\n3 1 3\n" + body)).triangles.cols(), 1);
  for (const char* counts : {"99999999999 1 3", "3 2147483648 3", "1e308 1 3"}) {
    const std::string path = Write("more.off", std::string("OFF\n") + counts + "\n" + body);
    const std::string error = ErrorOf([&] { ReadMeshFile(path); });
    EXPECT_NE(error.find("more.off: its header promises"), std::string::npos) << error;
  }
}

TEST_F(MeshImportTest, ABinaryStlThatPromisesTooMuchIsRefused) {
  std::string header(80, ' ');
  const std::uint32_t count = 4'000'000'000u;
  header.append(reinterpret_cast<const char*>(&count), sizeof count);
  header.append(50 * 3, '\0');
  const std::string path = Write("promise.stl", header);
  EXPECT_NE(ErrorOf([&] { ReadMeshFile(path); }).find(path), std::string::npos);
}

}  // namespace
}  // namespace mjcf_pdg::test
