#include "verify/verifier_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "verify/constraints.h"
#include "verify/exact/triangles.h"

namespace mjcf_pdg {
namespace {

using verify::CheckedPair;
using verify::ConvexShape;
using verify::MeshSolid;
using verify::Vector3d;
using verify::VertexTree;

// FCL's thresholds are absolute, so its trees are scaled until the largest body is about this long:
// a body of half a metre is in millimetres.
constexpr double kLargestInTrees = 512.0;

Vector3d Vertex(const mjModel& m, int mesh, int v) {
  const float* p = m.mesh_vert + 3 * (m.mesh_vertadr[mesh] + v);
  return {p[0], p[1], p[2]};
}

// The vertices of the mesh as a convex geom: those of the hull that MuJoCo's compiler found and
// collides, which may have fewer vertices than the true hull if the user limits them. A mesh
// without a hull keeps all its vertices.
std::shared_ptr<const VertexTree> HullOf(const mjModel& m, int mesh) {
  std::vector<Vector3d> vertices;
  if (m.mesh_graphadr[mesh] < 0) {
    for (int v = 0; v < m.mesh_vertnum[mesh]; ++v) vertices.push_back(Vertex(m, mesh, v));
  } else {
    const int* graph = m.mesh_graph + m.mesh_graphadr[mesh];
    const int *ids = graph + 2 + graph[0], *end = ids + graph[0];  // after the vertices' edges
    for (; ids != end; ++ids) vertices.push_back(Vertex(m, mesh, *ids));
  }
  return std::make_shared<const VertexTree>(std::move(vertices));
}

double Extent(const VertexTree& tree) {
  double extent = 0.0;
  for (const Vector3d& p : tree.vertices()) extent = std::max(extent, p.norm());
  return extent;
}

ConvexShape ShapeOf(const mjModel& m, int geom) {
  const double* size = m.geom_size + 3 * geom;
  ConvexShape shape;
  shape.type = m.geom_type[geom];
  switch (shape.type) {
    case mjGEOM_SPHERE:
      shape.radius = shape.extent = size[0];
      break;
    case mjGEOM_CAPSULE:
      shape.size = Vector3d(0.0, size[1], 0.0);
      shape.radius = size[0];
      shape.extent = size[0] + size[1];
      break;
    case mjGEOM_CYLINDER:
      shape.size = Vector3d(size[0], size[1], 0.0);
      shape.extent = std::hypot(size[0], size[1]);
      break;
    case mjGEOM_ELLIPSOID:
      shape.size = Vector3d(size[0], size[1], size[2]);
      shape.extent = shape.size.maxCoeff();
      break;
    case mjGEOM_HFIELD: {
      const double* field = m.hfield_size + 4 * m.geom_dataid[geom];
      shape.extent = std::hypot(field[0], field[1], std::max(field[2], field[3]));
      break;
    }
    case mjGEOM_PLANE:
    case mjGEOM_BOX:
    case mjGEOM_MESH:
    case mjGEOM_SDF:
      shape.size = Vector3d(size[0], size[1], size[2]);
      shape.extent = shape.size.norm();
      break;
    default:
      throw std::logic_error("a geom of this type has no shape");
  }
  return shape;
}

mjModel Unblinded(const mjModel& m, const std::vector<CheckedPair>& pairs, bool model_flags) {
  mjModel copy = m;
  copy.nflex = 0;  // flexes collide with nothing
  copy.opt.disableflags &= ~mjDSBL_NATIVECCD;
  if (!model_flags) copy.opt.disableflags &= ~(mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_CONSTRAINT);
  // One contact per pair is enough to detect an overlap. With several, MuJoCo 4.0.1 ends the
  // process at some poses: "collision function returned 4 contacts, expected at most 2".
  copy.opt.disableflags |= mjDSBL_MULTICCD;
  copy.opt.enableflags &= ~(mjENBL_OVERRIDE | mjENBL_SLEEP | mjENBL_SPECULATIVE | mjENBL_IPC);
  // At least MuJoCo's default, although a model may ask for fewer.
  copy.opt.ccd_iterations = std::max(copy.opt.ccd_iterations, 50);
  std::size_t contacts = 0;
  for (const CheckedPair& pair : pairs) contacts += mj_maxContact(&m, pair.geom1, pair.geom2, 1);
  // The arena must hold all contacts and the lists of body pairs and geom pairs of MuJoCo's broad
  // phase.
  const std::size_t bodies = m.nbody, sixteen_megabytes = std::size_t{1} << 24;
  const std::size_t need =
      sixteen_megabytes + contacts * sizeof(mjContact) + pairs.size() * 64 + bodies * bodies * 16;
  copy.narena = std::max<mjtSize>(copy.narena, static_cast<mjtSize>(need));
  return copy;
}

// Marks the geoms that collide as their triangles: those that the options and the model ask for,
// unless the mesh is its own convex hull, so that both are the same.
class ExactGeoms {
 public:
  ExactGeoms(const mjModel& m, const SceneOptions& options) : m_(m), exact_(m.ngeom, 0) {
    if (!options.exact_mesh) return;
    constexpr char kMark[] = "mjcf_pdg.exact_mesh";
    const int text = mj_name2id(&m, mjOBJ_TEXT, kMark);
    if (text < 0) {
      for (int g = 0; g < m.ngeom; ++g) Mark(g);
      return;
    }
    std::istringstream names(m.text_data + m.text_adr[text]);
    for (std::string name; names >> name;) {
      const int geom = mj_name2id(&m, mjOBJ_GEOM, name.c_str());
      if (geom < 0) throw Error("no geom named '" + name + "'");
      Mark(geom);
    }
  }

  std::vector<char> Take() { return std::move(exact_); }

 private:
  void Mark(int geom) {
    if (m_.geom_type[geom] != mjGEOM_MESH) return;
    const int mesh = m_.geom_dataid[geom];
    const auto [known, is_new] = convex_.try_emplace(mesh, false);
    if (is_new) {
      known->second =
          verify::IsBoundaryOfHull(verify::MeshTriangles(m_, mesh, true), *HullOf(m_, mesh));
    }
    exact_[geom] = !known->second;
  }

  const mjModel& m_;
  std::vector<char> exact_;
  std::map<int, bool> convex_;  // by mesh
};

// Makes the bodies of triangles, those of one mesh only once.
class SolidBuilder {
 public:
  SolidBuilder(const mjModel& m, double scale) : m_(m), scale_(scale) {}

  std::shared_ptr<const MeshSolid> Make(int geom, bool exact) {
    if (m_.geom_type[geom] == mjGEOM_BOX) {
      const Vector3d half = Eigen::Map<const Vector3d>(m_.geom_size + 3 * geom);
      return std::make_shared<const MeshSolid>(verify::BoxTriangles(half), true, scale_);
    }
    if (m_.geom_type[geom] != mjGEOM_MESH) return nullptr;
    const int mesh = m_.geom_dataid[geom];
    std::shared_ptr<const MeshSolid>& known = built_[{mesh, exact}];
    if (!known) {
      known =
          std::make_shared<const MeshSolid>(verify::MeshTriangles(m_, mesh, exact), !exact, scale_);
    }
    return known;
  }

 private:
  const mjModel& m_;
  const double scale_;
  std::map<std::pair<int, bool>, std::shared_ptr<const MeshSolid>> built_;  // by mesh, exact
};

}  // namespace

VerifierModel::VerifierModel(std::shared_ptr<const mjModel> model_owner, const mjModel& m,
                             const SceneOptions& options,
                             const std::vector<std::array<int, 2>>& ignored)
    : owner(std::move(model_owner)),
      exact(ExactGeoms(m, options).Take()),
      pairs(verify::FindPairs(m, options, exact)),
      left_out(verify::PairsLeftOut(m, options, ignored)),
      equalities(verify::EqualitiesToHold(m, options)),
      tendons(verify::TendonsToHold(m, options)),
      keeps_margins(options.keep_margins) {
  std::erase_if(pairs, [this](const CheckedPair& pair) {
    return left_out.contains(std::minmax(pair.geom1, pair.geom2));
  });
  unblinded = Unblinded(m, pairs, options.model_flags);
  for (const CheckedPair& pair : pairs) {
    has_sdf_pairs |= pair.sdf;
    largest_margin = std::max(largest_margin, pair.margin);
  }
  MakeShapes(m);
  MakeSolids(m);
}

VerifierModel VerifierModel::Resized(std::shared_ptr<const mjModel> model) const {
  VerifierModel other = *this;
  const mjModel& m = *model;
  other.unblinded = m;
  other.unblinded.opt = unblinded.opt;
  other.unblinded.nflex = unblinded.nflex;
  other.unblinded.narena = unblinded.narena;
  other.owner = std::move(model);
  other.MakeShapes(m);
  other.MakeSolids(m);
  return other;
}

void VerifierModel::MakeShapes(const mjModel& m) {
  std::map<int, std::shared_ptr<const VertexTree>> trees;  // by mesh
  shapes.assign(m.ngeom, {});
  std::vector<char> has_shape(m.ngeom);
  for (const CheckedPair& pair : pairs) {
    for (const int g : {pair.geom1, pair.geom2}) {
      if (has_shape[g]) continue;
      has_shape[g] = true;
      shapes[g] = ShapeOf(m, g);
      if (m.geom_type[g] != mjGEOM_MESH) continue;
      std::shared_ptr<const VertexTree>& tree = trees[m.geom_dataid[g]];
      if (!tree) tree = HullOf(m, m.geom_dataid[g]);
      shapes[g].vertices = tree;
      shapes[g].extent = Extent(*tree);
    }
  }
}

// After the shapes.
void VerifierModel::MakeSolids(const mjModel& m) {
  solids.assign(m.ngeom, nullptr);
  double largest = 0.0;  // extent of the largest box or mesh of an exact pair [m]
  for (const CheckedPair& pair : pairs) {
    if (!pair.exact) continue;
    for (const int g : {pair.geom1, pair.geom2}) {
      const int type = m.geom_type[g];
      if (type == mjGEOM_BOX || type == mjGEOM_MESH) largest = std::max(largest, shapes[g].extent);
    }
  }
  if (!(largest > 0.0)) return;
  // The scale is a power of two, so that scaling does not round coordinates.
  SolidBuilder builder(m, std::exp2(std::round(std::log2(kLargestInTrees / (2.0 * largest)))));
  for (const CheckedPair& pair : pairs) {
    if (!pair.exact) continue;
    for (const int g : {pair.geom1, pair.geom2}) {
      if (!solids[g]) solids[g] = builder.Make(g, exact[g]);
    }
  }
}

}  // namespace mjcf_pdg
