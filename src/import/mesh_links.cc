#include "import/mesh_links.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mjcf_pdg {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// The corner, numbered 3 * triangle + corner, at the low or the high vertex of an edge's use.
int CornerAt(const EdgeUse& use, bool at_low) {
  return 3 * use.triangle + (use.forward == at_low ? use.corner : (use.corner + 1) % 3);
}

void JoinCorners(const Link& link, OrientedSets* corners) {
  for (const bool at_low : {true, false}) {
    corners->Join(CornerAt(link.a, at_low), CornerAt(link.b, at_low));
  }
}

// What LinkByNeighbours decides.
struct Links {
  std::vector<Link> links;
  std::vector<std::vector<EdgeUse>> undecided;  // by edge, its uses that are in no link
};

Links LinkByNeighbours(const Eigen::Matrix3Xi& triangles) {
  const std::vector<EdgeUse> uses = SortedEdgeUses(triangles);
  Links found;
  OrientedSets corners(static_cast<int>(triangles.size()));
  ForEachEdge(uses, [&](const EdgeUse* edge, int count) {
    if (count != 2) return;
    found.links.push_back({edge[0], edge[1]});
    JoinCorners(found.links.back(), &corners);
  });
  ForEachEdge(uses, [&](const EdgeUse* edge, int count) {
    if (count <= 2) return;
    // Uses are grouped by their ends, where connected corners count as one. A group of two is
    // linked.
    std::vector<std::pair<std::pair<int, int>, int>> ends;
    for (int i = 0; i < count; ++i) {
      ends.push_back(
          {{corners.Root(CornerAt(edge[i], true)), corners.Root(CornerAt(edge[i], false))}, i});
    }
    std::sort(ends.begin(), ends.end());
    std::vector<EdgeUse> others;
    for (std::size_t begin = 0, end = 0; begin < ends.size(); begin = end) {
      while (end < ends.size() && ends[end].first == ends[begin].first) ++end;
      if (end - begin == 2) {
        found.links.push_back({edge[ends[begin].second], edge[ends[begin + 1].second]});
      } else {
        for (std::size_t i = begin; i < end; ++i) others.push_back(edge[ends[i].second]);
      }
    }
    if (!others.empty()) found.undecided.push_back(std::move(others));
  });
  return found;
}

// A triangle at an edge, as a half-plane that turns about the edge comes across it.
struct Meeting {
  double angle;  // at which the half-plane meets the triangle [rad]
  double blur;   // error of the angle by the rounding of coordinates [rad]
  bool enters;   // the half-plane enters the solid here; else it leaves it
  EdgeUse use;
};

// The triangles of an edge, sorted by angle. `rounding` is that of coordinates [m]; `inside_out`
// says that the mesh has its insides outside.
std::vector<Meeting> AroundEdge(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses,
                                double rounding, bool inside_out) {
  const Vector3d low = mesh.vertices.col(uses[0].low);
  const Vector3d axis = (Vector3d(mesh.vertices.col(uses[0].high)) - low).normalized();
  Vector3d first = Vector3d::Zero();
  std::vector<Meeting> meetings;
  for (const EdgeUse& use : uses) {
    const Vector3d opposite = mesh.vertices.col(mesh.triangles((use.corner + 2) % 3, use.triangle));
    const Vector3d across = (opposite - low) - axis.dot(opposite - low) * axis;
    if (first.isZero(0.0)) first = across;
    double angle = -std::atan2(axis.dot(first.cross(across)), first.dot(across));
    const double blur = rounding / across.norm();
    if (angle < -blur - rounding / first.norm()) angle += 2.0 * EIGEN_PI;
    meetings.push_back({angle, blur, use.forward != inside_out, use});
  }
  std::sort(meetings.begin(), meetings.end(),
            [](const Meeting& x, const Meeting& y) { return x.angle < y.angle; });
  return meetings;
}

// Puts leaving before entering where angles are equal within their blur: solids that touch in a
// face follow each other.
void LeaveBeforeEntering(std::vector<Meeting>* meetings) {
  for (auto begin = meetings->begin(); begin != meetings->end();) {
    auto end = begin + 1;
    while (end != meetings->end() && end->angle - (end - 1)->angle <= end->blur + (end - 1)->blur) {
      ++end;
    }
    std::stable_partition(begin, end, [](const Meeting& meeting) { return !meeting.enters; });
    begin = end;
  }
}

// Links the two triangles of each solid around an edge. Links nothing unless entering and leaving
// alternate, because otherwise solids overlap or are oriented against each other.
void LinkBySolids(std::vector<Meeting> meetings, std::vector<Link>* links) {
  LeaveBeforeEntering(&meetings);
  const auto next = [&](std::size_t i) { return meetings[(i + 1) % meetings.size()]; };
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    if (meetings[i].enters == next(i).enters) return;
  }
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    if (meetings[i].enters) links->push_back({meetings[i].use, next(i).use});
  }
}

}  // namespace

std::vector<Link> FindCertainLinks(const Eigen::Matrix3Xi& triangles) {
  return LinkByNeighbours(triangles).links;
}

std::vector<Link> FindLinks(const TriangleMesh& mesh) {
  Links found = LinkByNeighbours(mesh.triangles);
  if (found.undecided.empty()) return std::move(found.links);
  constexpr double kRounding = 0x1.0p-22;  // a few units in the last place of single precision
  const double rounding = kRounding * mesh.vertices.cwiseAbs().maxCoeff();
  const bool inside_out = FindSolidProperties(mesh).volume < 0.0;
  for (const std::vector<EdgeUse>& uses : found.undecided) {
    LinkBySolids(AroundEdge(mesh, uses, rounding, inside_out), &found.links);
  }
  return std::move(found.links);
}

int CutApart(const std::vector<Link>& links, TriangleMesh* mesh) {
  int cut = 0;
  ForEachEdge(SortedEdgeUses(mesh->triangles),
              [&](const EdgeUse*, int count) { cut += count > 2; });
  if (cut == 0) return 0;
  OrientedSets corners(static_cast<int>(mesh->triangles.size()));
  for (const Link& link : links) JoinCorners(link, &corners);
  std::vector<int> vertex_of(static_cast<std::size_t>(mesh->triangles.size()), -1);
  std::vector<Index> source;
  Eigen::Matrix3Xi triangles = mesh->triangles;
  for (int i = 0; i < triangles.size(); ++i) {
    int& vertex = vertex_of[corners.Root(i)];
    if (vertex < 0) {
      vertex = static_cast<int>(source.size());
      source.push_back(mesh->triangles(i % 3, i / 3));
    }
    triangles(i % 3, i / 3) = vertex;
  }
  *mesh = {mesh->vertices(Eigen::all, source), std::move(triangles)};
  return cut;
}

}  // namespace mjcf_pdg
