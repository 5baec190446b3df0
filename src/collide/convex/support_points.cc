#include "collide/convex/support_points.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

#include "mesh/mesh_hull.h"

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;

// Meshes with fewer vertices are searched vertex by vertex, as in MuJoCo's own collision queries;
// others by climbing along the hull's edges.
constexpr int kHullFromVertices = 10;

// Directions are sorted into cells: the six faces of a cube, each cut into kCells × kCells squares.
constexpr int kCells = 8;

int CellOf(const Vector3d& direction) {
  int axis = 0;
  const double largest = direction.cwiseAbs().maxCoeff(&axis);
  if (!(largest > 0.0)) return 0;
  auto place = [&](double along) {
    return std::min(static_cast<int>((along / largest + 1.0) * 0.5 * kCells), kCells - 1);
  };
  const int face = 2 * axis + (direction[axis] < 0.0);
  return (face * kCells + place(direction[(axis + 1) % 3])) * kCells +
         place(direction[(axis + 2) % 3]);
}

Vector3d MiddleOf(int cell) {
  auto along = [](int place) { return (2.0 * place + 1.0) / kCells - 1.0; };
  const int face = cell / (kCells * kCells), axis = face / 2;
  Vector3d direction;
  direction[axis] = face % 2 == 0 ? 1.0 : -1.0;
  direction[(axis + 1) % 3] = along(cell / kCells % kCells);
  direction[(axis + 2) % 3] = along(cell % kCells);
  return direction;
}

double Along(const Vector3d& direction, const Eigen::Vector3f& p) {
  return direction.x() * p.x() + direction.y() * p.y() + direction.z() * p.z();
}

}  // namespace

double CoreRadius(const mjModel& model, int geom) {
  const int type = model.geom_type[geom];
  return type == mjGEOM_SPHERE || type == mjGEOM_CAPSULE ? model.geom_size[3 * geom] : 0.0;
}

SupportPoints::SupportPoints(const mjModel& model, const std::vector<KeptPair>& pairs)
    : model_(model), hulls_(model.nmesh) {
  std::vector<char> wanted(model.nmesh);
  for (const KeptPair& pair : pairs) {
    for (const int geom : {pair.geom1, pair.geom2}) {
      if (model.geom_type[geom] == mjGEOM_MESH) wanted[model.geom_dataid[geom]] = true;
    }
  }
  for (int mesh = 0; mesh < model.nmesh; ++mesh) {
    if (wanted[mesh]) AddHull(mesh);
  }
  first_neighbour_.push_back(static_cast<int>(neighbours_.size()));
  for (Hull& hull : hulls_) AddStarts(hull);
}

void SupportPoints::AddHull(int mesh) {
  const int count = model_.mesh_vertnum[mesh];
  const std::optional<MeshHull> graph = HullOf(model_, mesh);
  const bool has_edges = graph && count >= kHullFromVertices;
  const int size = has_edges ? static_cast<int>(graph->vertices.size()) : count;
  Hull& hull = hulls_[mesh];
  hull.begin = static_cast<int>(vertices_.size());
  hull.end = hull.begin + size;
  for (int k = 0; k < size; ++k) {
    const std::ptrdiff_t vertex = model_.mesh_vertadr[mesh] + (has_edges ? graph->vertices[k] : k);
    vertices_.emplace_back(model_.mesh_vert + 3 * vertex);
  }
  for (int k = 0; k < size; ++k) {
    first_neighbour_.push_back(static_cast<int>(neighbours_.size()));
    if (!has_edges) continue;
    for (const int* edge = graph->edges.data() + graph->first_edge[k]; *edge >= 0; ++edge) {
      neighbours_.push_back({vertices_[hull.begin + *edge], *edge});
    }
  }
}

// In the cell before, or at the beginning of the row before, the farthest vertex is the same or
// near. (To look at all vertices for each cell took more than half of the time to make a scene.)
void SupportPoints::AddStarts(Hull& hull) {
  const bool has_edges =
      hull.end > hull.begin && first_neighbour_[hull.begin + 1] > first_neighbour_[hull.begin];
  if (!has_edges) return;
  hull.starts = static_cast<int>(starts_.size());
  starts_.push_back(LookAtAll(hull, MiddleOf(0)));
  for (int cell = 1; cell < 6 * kCells * kCells; ++cell) {
    const int before = cell % kCells == 0 ? cell - kCells : cell - 1;
    starts_.push_back(Climb(hull, MiddleOf(cell), starts_[hull.starts + before]));
  }
}

bool SupportPoints::Knows(int geom) const {
  switch (model_.geom_type[geom]) {
    case mjGEOM_SPHERE:
    case mjGEOM_CAPSULE:
    case mjGEOM_ELLIPSOID:
    case mjGEOM_CYLINDER:
    case mjGEOM_BOX:
    case mjGEOM_MESH:
      return true;
    default:
      return false;
  }
}

// Goes to the farthest neighbour until none is farther: on a convex hull that is the farthest
// vertex.
int SupportPoints::Climb(const Hull& hull, const Vector3d& direction, int vertex) const {
  double farthest = Along(direction, vertices_[hull.begin + vertex]);
  for (int at = -1; at != vertex;) {
    at = vertex;
    const Neighbour* end = neighbours_.data() + first_neighbour_[hull.begin + at + 1];
    for (const Neighbour* k = neighbours_.data() + first_neighbour_[hull.begin + at]; k != end;
         ++k) {
      const double along = Along(direction, k->p);
      if (along > farthest) {
        farthest = along;
        vertex = k->vertex;
      }
    }
  }
  return vertex;
}

int SupportPoints::LookAtAll(const Hull& hull, const Vector3d& direction) const {
  double farthest = -std::numeric_limits<double>::infinity();
  int vertex = 0;
  for (int k = hull.begin; k < hull.end; ++k) {
    const double along = Along(direction, vertices_[k]);
    if (along <= farthest) continue;
    farthest = along;
    vertex = k - hull.begin;
  }
  return vertex;
}

std::span<const Eigen::Vector3f> SupportPoints::HullPoints(int geom) const {
  const Hull& hull = hulls_[model_.geom_dataid[geom]];
  return {vertices_.begin() + hull.begin, vertices_.begin() + hull.end};
}

Vector3d SupportPoints::Support(int geom, const Vector3d& direction_G) const {
  const double* size = model_.geom_size + 3 * geom;
  auto signed_by = [](double length, double direction) {
    return direction < 0.0 ? -length : length;
  };
  switch (model_.geom_type[geom]) {
    case mjGEOM_SPHERE:
      return Vector3d::Zero();
    case mjGEOM_CAPSULE:
      return {0.0, 0.0, signed_by(size[1], direction_G.z())};
    case mjGEOM_ELLIPSOID: {
      const Vector3d half(size[0], size[1], size[2]);
      return half.cwiseProduct(half.cwiseProduct(direction_G).normalized());
    }
    case mjGEOM_CYLINDER: {
      const double aside = direction_G.head<2>().norm();
      const double scale = aside > 0.0 ? size[0] / aside : 0.0;
      return {scale * direction_G.x(), scale * direction_G.y(),
              signed_by(size[1], direction_G.z())};
    }
    case mjGEOM_BOX:
      return {signed_by(size[0], direction_G.x()), signed_by(size[1], direction_G.y()),
              signed_by(size[2], direction_G.z())};
    case mjGEOM_MESH: {
      const Hull& hull = hulls_[model_.geom_dataid[geom]];
      const int vertex = hull.starts < 0
                             ? LookAtAll(hull, direction_G)
                             : Climb(hull, direction_G, starts_[hull.starts + CellOf(direction_G)]);
      return vertices_[hull.begin + vertex].cast<double>();
    }
    default:
      throw std::logic_error("a geom of this type has no support points");
  }
}

}  // namespace mjcf_pdg
