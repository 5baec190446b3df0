#include "import/mesh_repair.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "import/mesh_links.h"
#include "mesh/mesh_components.h"
#include "mesh/mesh_edges.h"

namespace mjcf_pdg {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xi;

void TurnOver(Matrix3Xi& triangles, Index t) { std::swap(triangles(1, t), triangles(2, t)); }

// Keeps the triangles with these indices only. Returns the number of the others.
int Keep(const std::vector<Index>& kept, Matrix3Xi* triangles) {
  const Index before = triangles->cols();
  *triangles = (*triangles)(Eigen::all, kept).eval();
  return static_cast<int>(before - triangles->cols());
}

int DropRepeatedCorners(Matrix3Xi* triangles) {
  std::vector<Index> kept;
  for (Index t = 0; t < triangles->cols(); ++t) {
    const Eigen::Vector3i v = triangles->col(t);
    if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]) kept.push_back(t);
  }
  return Keep(kept, triangles);
}

// ---- Triangles with the same corners ----

// Triangles sorted by a key: the three corners in ascending order, then the sense in which they
// follow each other.
std::vector<std::pair<std::array<int, 4>, int>> SortedByCorners(const Matrix3Xi& triangles) {
  std::vector<std::pair<std::array<int, 4>, int>> keys;
  for (int t = 0; t < triangles.cols(); ++t) {
    const int a = triangles(0, t), b = triangles(1, t), c = triangles(2, t);
    const auto [low, high] = std::minmax({a, b, c});
    keys.push_back({{low, a ^ b ^ c ^ low ^ high, high, (a > b) ^ (b > c) ^ (a > c)}, t});
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

int DropDuplicates(Matrix3Xi* triangles) {
  const auto keys = SortedByCorners(*triangles);
  std::vector<Index> kept;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i].first != keys[i - 1].first) kept.push_back(keys[i].second);
  }
  std::sort(kept.begin(), kept.end());
  return Keep(kept, triangles);
}

// For each triangle its twin, which has the same corners in the opposite sense; -1: none.
std::vector<int> FindTwins(const Matrix3Xi& triangles) {
  const auto keys = SortedByCorners(triangles);
  std::vector<int> twins(keys.size(), -1);
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (!std::equal(keys[i].first.begin(), keys[i].first.begin() + 3, keys[i - 1].first.begin())) {
      continue;
    }
    twins[keys[i].second] = keys[i - 1].second;
    twins[keys[i - 1].second] = keys[i].second;
  }
  return twins;
}

bool HasTwins(const std::vector<int>& twins) {
  return std::any_of(twins.begin(), twins.end(), [](int twin) { return twin >= 0; });
}

// Patches: sets of triangles with twins that are connected across edges.
OrientedSets FindPatches(const std::vector<EdgeUse>& uses, const std::vector<int>& twins) {
  OrientedSets patches(static_cast<int>(twins.size()));
  ForEachEdge(uses, [&](const EdgeUse* edge, int count) {
    int twin = -1;
    for (const EdgeUse& use : std::span(edge, count)) {
      if (twins[use.triangle] < 0) continue;
      if (twin >= 0) patches.Join(twin, use.triangle);
      twin = use.triangle;
    }
  });
  return patches;
}

// If the triangles without twins do not balance at the edges of a patch, the patch is needed to
// close the surface, but only once: of two twins the earlier triangle stays. Returns the number
// dropped.
int DropNeedlessTwins(Matrix3Xi* triangles) {
  const std::vector<int> twins = FindTwins(*triangles);
  if (!HasTwins(twins)) return 0;
  const std::vector<EdgeUse> uses = SortedEdgeUses(*triangles);
  OrientedSets patches = FindPatches(uses, twins);
  std::vector<char> is_needed(twins.size(), 0);  // per root
  ForEachEdge(uses, [&](const EdgeUse* edge, int count) {
    int balance = 0, twin = -1;
    for (const EdgeUse& use : std::span(edge, count)) {
      if (twins[use.triangle] >= 0) {
        twin = use.triangle;
      } else {
        balance += use.forward ? 1 : -1;
      }
    }
    if (balance != 0 && twin >= 0) is_needed[patches.Root(twin)] = 1;
  });
  std::vector<Index> kept;
  for (int t = 0; t < static_cast<int>(twins.size()); ++t) {
    if (twins[t] < 0 || t < twins[t] || !is_needed[patches.Root(t)]) kept.push_back(t);
  }
  return Keep(kept, triangles);
}

// ---- Orientation and connection ----

// Turns triangles over until linked ones agree, the fewest of each connected set. Returns how many.
int AgreeWithNeighbours(const std::vector<Link>& links, Matrix3Xi* triangles) {
  OrientedSets sets(static_cast<int>(triangles->cols()));
  for (const Link& link : links) {
    sets.Join(link.a.triangle, link.b.triangle, link.a.forward == link.b.forward);
  }
  std::vector<int> votes(static_cast<std::size_t>(triangles->cols()), 0);  // per root
  for (int t = 0; t < triangles->cols(); ++t) votes[sets.Root(t)] += sets.Turned(t) ? 1 : -1;
  int turned = 0;
  for (int t = 0; t < triangles->cols(); ++t) {
    if (sets.Turned(t) == (votes[sets.Root(t)] > 0)) continue;
    TurnOver(*triangles, t);
    ++turned;
  }
  return turned;
}

// A connected surface, and where the twins of its triangles are.
struct TwoSided {
  bool here = true;                 // each triangle has a twin in the same surface
  bool elsewhere = true;            // each triangle has a twin in another surface
  int linked_sides = 0, sides = 0;  // equal if the surface is closed
  double volume = 0.0;              // meaningful if it is closed [m³]
};

std::vector<TwoSided> FindTwoSided(const TriangleMesh& mesh, const std::vector<int>& twins,
                                   const std::vector<Link>& links, OrientedSets* surfaces) {
  std::vector<TwoSided> found(twins.size());  // per root
  for (const Link& link : links) found[surfaces->Root(link.a.triangle)].linked_sides += 2;
  const Eigen::Vector3d middle = mesh.vertices.rowwise().mean();
  for (int t = 0; t < static_cast<int>(twins.size()); ++t) {
    TwoSided& surface = found[surfaces->Root(t)];
    const bool here = twins[t] >= 0 && surfaces->Root(twins[t]) == surfaces->Root(t);
    surface.here &= here;
    surface.elsewhere &= twins[t] >= 0 && !here;
    surface.sides += 3;
    surface.volume += FindSolidProperties(mesh.vertices, mesh.triangles.col(t), middle).volume;
  }
  return found;
}

// Drops the second side of surfaces that are there twice, and returns the number of triangles
// dropped. Of a sheet the earlier triangles stay. Of a closed surface and its copy inside out the
// copy goes. A patch whose twins are in the same surface, which also has other triangles, is a fold
// of it, and both sides go.
int DropOtherSides(TriangleMesh* mesh) {
  const std::vector<int> twins = FindTwins(mesh->triangles);
  if (!HasTwins(twins)) return 0;
  const int n = static_cast<int>(twins.size());
  const std::vector<Link> links = FindLinks(*mesh);
  OrientedSets surfaces(n), patches = FindPatches(SortedEdgeUses(mesh->triangles), twins);
  for (const Link& link : links) surfaces.Join(link.a.triangle, link.b.triangle);
  const std::vector<TwoSided> two_sided = FindTwoSided(*mesh, twins, links, &surfaces);
  std::vector<char> is_fold(twins.size(), 0);  // per patch's root
  for (int t = 0; t < n; ++t) {
    const int root = surfaces.Root(t);
    if (twins[t] < 0 || surfaces.Root(twins[t]) != root || two_sided[root].here) continue;
    is_fold[patches.Root(t)] = 1;
  }
  const auto is_kept = [&](int t) {
    if (twins[t] < 0) return true;
    if (is_fold[patches.Root(t)]) return false;
    const TwoSided& surface = two_sided[surfaces.Root(t)];
    const bool is_closed = surface.linked_sides == surface.sides;
    if (surface.here || (surface.elsewhere && !is_closed)) return t < twins[t];
    return !surface.elsewhere || surface.volume >= 0.0;
  };
  std::vector<Index> kept;
  for (int t = 0; t < n; ++t) {
    if (is_kept(t)) kept.push_back(t);
  }
  return Keep(kept, &mesh->triangles);
}

// Turns over outer surfaces that face inwards, with all components inside them, because in a file
// that is inside out its cavities are so too. Returns the number of components turned over.
int FaceOutwards(TriangleMesh* mesh) {
  const std::vector<MeshComponent> components = FindComponents(*mesh);
  int inward = 0;
  for (const MeshComponent& component : components) {
    const auto is_outer = [&](int i) { return components[i].containers.empty(); };
    const auto outer =
        std::find_if(component.containers.begin(), component.containers.end(), is_outer);
    const double volume =
        outer == component.containers.end() ? component.volume : components[*outer].volume;
    if (!component.closed || volume >= 0.0) continue;
    for (const Index t : component.members) TurnOver(mesh->triangles, t);
    ++inward;
  }
  return inward;
}

}  // namespace

TriangleMesh RepairMesh(const TriangleMesh& welded, MeshRepairs* repairs) {
  *repairs = {};
  TriangleMesh mesh = welded;
  repairs->repeated_corners = DropRepeatedCorners(&mesh.triangles);
  repairs->duplicates = DropDuplicates(&mesh.triangles) + DropNeedlessTwins(&mesh.triangles);
  repairs->turned = AgreeWithNeighbours(FindCertainLinks(mesh.triangles), &mesh.triangles);
  repairs->duplicates += DropOtherSides(&mesh);
  repairs->non_manifold_edges = CutApart(FindLinks(mesh), &mesh);
  repairs->inward_components = FaceOutwards(&mesh);
  return mesh;
}

}  // namespace mjcf_pdg
