#include "tests/support/mesh_oracle.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Rigid_triangle_mesh_collision_detection.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "model/scene_tables.h"
#include "tests/support/mesh_shapes.h"

namespace mjcf_pdg::test {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Eigen::Vector3d;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Affine = CGAL::Aff_transformation_3<Kernel>;
using Surface = CGAL::Surface_mesh<Point>;
using Collision = CGAL::Rigid_triangle_mesh_collision_detection<Surface>;
using Tree = Collision::AABB_tree;
using Side = CGAL::Side_of_triangle_mesh<Surface, Kernel, CGAL::Default, Tree>;

// Rings and sectors of round primitives. With an odd number of rings no vertex is at z = 0.
constexpr int kRings = 129, kSectors = 256;
constexpr double kPlane = 50.0;  // half size of the block that stands for a plane [m]

MeshShape OfModel(const mjModel& m, int mesh) {
  MeshShape shape;
  for (int k = 0; k < m.mesh_vertnum[mesh]; ++k) {
    const float* p = m.mesh_vert + 3 * (m.mesh_vertadr[mesh] + k);
    shape.vertices.emplace_back(p[0], p[1], p[2]);
  }
  for (int k = 0; k < m.mesh_facenum[mesh]; ++k) {
    const int* f = m.mesh_face + 3 * (m.mesh_faceadr[mesh] + k);
    shape.faces.emplace_back(f[0], f[1], f[2]);
  }
  return shape;
}

// A globe whose vertex in the direction d is at place(d).
template <typename Place>
MeshShape Inscribed(int rings, const Place& place) {
  MeshShape shape = Globe(rings, kSectors, [](const Vector3d&) { return 1.0; });
  for (Vector3d& p : shape.vertices) p = place(p);
  return shape;
}

MeshShape OfPrimitive(int type, const Vector3d& size) {
  const Vector3d half = size[1] * Vector3d::UnitZ();
  switch (type) {
    case mjGEOM_PLANE:
      return BoxMesh({kPlane, kPlane, kPlane}).Move(Eigen::Matrix3d::Identity(), {0, 0, -kPlane});
    case mjGEOM_BOX:
      return BoxMesh(size);
    case mjGEOM_SPHERE:
      return Inscribed(kRings, [&](const Vector3d& d) { return Vector3d(size[0] * d); });
    case mjGEOM_ELLIPSOID:
      return Inscribed(kRings, [&](const Vector3d& d) { return Vector3d(size.cwiseProduct(d)); });
    case mjGEOM_CAPSULE:
      return Inscribed(kRings, [&](const Vector3d& d) {
        return Vector3d(size[0] * d + std::copysign(1.0, d.z()) * half);
      });
    case mjGEOM_CYLINDER:  // the globe's two poles and two rings
      return Inscribed(3, [&](const Vector3d& d) {
        const Vector3d across(d.x(), d.y(), 0.0);
        return Vector3d((across.norm() > 0.1 ? size[0] : 0.0) * across.normalized() +
                        std::copysign(1.0, d.z()) * half);
      });
    default:
      throw Error("mesh_oracle: unknown type of geom");
  }
}

Surface ToSurface(const MeshShape& shape) {
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> faces;
  for (const Vector3d& p : shape.vertices) points.emplace_back(p.x(), p.y(), p.z());
  for (const Eigen::Vector3i& f : shape.faces) {
    faces.push_back({static_cast<std::size_t>(f[0]), static_cast<std::size_t>(f[1]),
                     static_cast<std::size_t>(f[2])});
  }
  pmp::repair_polygon_soup(points, faces);
  pmp::orient_polygon_soup(points, faces);  // also cuts the surface at edges that are not manifold
  Surface surface;
  pmp::polygon_soup_to_polygon_mesh(points, faces, surface);
  return surface;
}

struct Body {
  explicit Body(const MeshShape& shape)
      : surface(ToSurface(shape)),
        tree(faces(surface).begin(), faces(surface).end(), surface,
             get_const_property_map(CGAL::vertex_point, surface)),
        closed(CGAL::is_closed(surface)) {}
  Body(const Body&) = delete;

  // Distance from the surface of a point inside (in the body's frame) [m]; 0 if it is outside.
  double DepthOf(const Point& p) const {
    if (!closed || !CGAL::do_overlap(p.bbox(), tree.bbox())) return 0.0;
    if (Side(tree)(p) != CGAL::ON_BOUNDED_SIDE) return 0.0;
    return std::sqrt(tree.squared_distance(p));
  }

  Surface surface;
  Tree tree;
  bool closed;
  std::size_t id = 0;  // in CGAL's collision detection
  Affine pose{CGAL::IDENTITY};
};

// The point in a variant, null if it holds none. CGAL 6 has std's variants, CGAL 5 boost's.
template <typename Variant>
const Point* AsPoint(const Variant& variant) {
  if constexpr (requires { std::get_if<Point>(&variant); }) {
    return std::get_if<Point>(&variant);
  } else {
    return boost::get<Point>(&variant);
  }
}

// The parameters from 0 to 1, ascending, at which the segment from p to q begins, meets the body's
// surface, and ends.
std::vector<double> Parts(const Point& p, const Point& q, const Body& body) {
  std::vector<double> at = {0.0, 1.0};
  std::vector<Tree::Intersection_and_primitive_id<Kernel::Segment_3>::Type> hits;
  body.tree.all_intersections(Kernel::Segment_3(p, q), std::back_inserter(hits));
  for (const auto& hit : hits) {
    const Point* x = AsPoint(hit.first);
    if (x) at.push_back(std::sqrt(CGAL::squared_distance(p, *x) / CGAL::squared_distance(p, q)));
  }
  std::sort(at.begin(), at.end());
  return at;
}

// The depth [m] of the deepest point of `from` inside `in`. Tried are vertices, and the middles of
// the parts into which the surface of `in` cuts edges.
double DepthInside(const Body& from, const Body& in) {
  const Affine there = in.pose.inverse() * from.pose;
  double deepest = 0.0;
  for (const auto vertex : vertices(from.surface)) {
    deepest = std::max(deepest, in.DepthOf(there(from.surface.point(vertex))));
  }
  for (const auto edge : edges(from.surface)) {
    const Point p = there(from.surface.point(source(edge, from.surface)));
    const Point q = there(from.surface.point(target(edge, from.surface)));
    if (!CGAL::do_overlap(p.bbox() + q.bbox(), in.tree.bbox())) continue;
    const std::vector<double> at = Parts(p, q, in);
    for (std::size_t k = 1; at.size() > 2 && k < at.size(); ++k) {
      deepest = std::max(deepest, in.DepthOf(p + 0.5 * (at[k - 1] + at[k]) * (q - p)));
    }
  }
  return deepest;
}

}  // namespace

struct MeshOracle::Impl {
  explicit Impl(const Scene& s) : scene(s), data(mj_makeData(s.model())), bodies(s.model()->ngeom) {
    const mjModel& m = *scene.model();
    for (const KeptPair& pair : scene.tables().pairs) {
      if (!Asks(pair)) continue;
      for (const int g : {pair.geom1, pair.geom2}) {
        if (!bodies[g]) Add(m, g);
      }
    }
  }
  ~Impl() { mj_deleteData(data); }

  // True for pairs with a geom that collides as its triangles.
  bool Asks(const KeptPair& pair) const {
    const std::vector<char>& exact = scene.tables().exact;
    return pair.kind != PairKind::kSdf && (exact[pair.geom1] || exact[pair.geom2]);
  }

  void Add(const mjModel& m, int g) {
    const bool mesh = m.geom_type[g] == mjGEOM_MESH;
    if (mesh && !scene.tables().exact[g]) throw Error("mesh_oracle: a mesh as its hull");
    bodies[g] = std::make_unique<Body>(
        mesh ? OfModel(m, m.geom_dataid[g])
             : OfPrimitive(m.geom_type[g], Eigen::Map<const Vector3d>(m.geom_size + 3 * g)));
    bodies[g]->id = collision.add_mesh(bodies[g]->tree, bodies[g]->surface);
  }

  void Pose(const std::vector<double>& q) {
    mju_copy(data->qpos, q.data(), scene.model()->nq);
    mj_kinematics(scene.model(), data);
    for (std::size_t g = 0; g < bodies.size(); ++g) {
      if (!bodies[g]) continue;
      const double *R = data->geom_xmat + 9 * g, *t = data->geom_xpos + 3 * g;
      bodies[g]->pose =
          Affine(R[0], R[1], R[2], t[0], R[3], R[4], R[5], t[1], R[6], R[7], R[8], t[2]);
      collision.set_transformation(bodies[g]->id, bodies[g]->pose);
    }
  }

  const Scene& scene;
  mjData* data;
  std::vector<std::unique_ptr<Body>> bodies;  // by geom; null if no exact pair has it
  Collision collision;
};

MeshOracle::MeshOracle(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
MeshOracle::~MeshOracle() = default;

std::vector<OracleOverlap> MeshOracle::Overlaps(const std::vector<double>& q) {
  impl_->Pose(q);
  std::vector<OracleOverlap> overlaps;
  for (const KeptPair& pair : impl_->scene.tables().pairs) {
    if (!impl_->Asks(pair)) continue;
    const Body &a = *impl_->bodies[pair.geom1], &b = *impl_->bodies[pair.geom2];
    const auto hits = impl_->collision.get_all_intersections_and_inclusions(a.id, std::array{b.id});
    if (hits.empty()) continue;
    overlaps.push_back({pair.geom1, pair.geom2, hits.front().second,
                        std::max(DepthInside(a, b), DepthInside(b, a))});
  }
  return overlaps;
}

bool MeshOracle::Free(const std::vector<double>& q, double tolerance) {
  for (const OracleOverlap& overlap : Overlaps(q)) {
    if (overlap.depth > tolerance) return false;
  }
  return true;
}

}  // namespace mjcf_pdg::test
