#include "verify/convex/vertex_tree.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace mjcf_pdg::verify {
namespace {

using Eigen::Vector3d;

constexpr int kLeaf = 8;  // most vertices of a leaf; 4 to 16 cost the same

bool Before(const Vector3d& a, const Vector3d& b) {
  return std::tuple(a[0], a[1], a[2]) < std::tuple(b[0], b[1], b[2]);
}

}  // namespace

VertexTree::VertexTree(std::vector<Vector3d> vertices) : vertices_(std::move(vertices)) {
  std::sort(vertices_.begin(), vertices_.end(), Before);
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  Build(0, static_cast<int>(vertices_.size()));
}

void VertexTree::Build(int begin, int end) {
  const std::size_t index = nodes_.size();
  Eigen::AlignedBox3d box;
  for (int v = begin; v < end; ++v) box.extend(vertices_[v]);
  nodes_.push_back({box.center(), 0.5 * box.sizes(), begin, end, 0});
  if (end - begin <= kLeaf) return;
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(vertices_.begin() + begin, vertices_.begin() + middle, vertices_.begin() + end,
                   [axis](const Vector3d& a, const Vector3d& b) { return a[axis] < b[axis]; });
  Build(begin, middle);
  nodes_[index].second = static_cast<int>(nodes_.size());
  Build(middle, end);
}

const Vector3d& VertexTree::Support(const Vector3d& n) const {
  double most = -std::numeric_limits<double>::infinity();
  int farthest = 0;
  Search(0, n, most, farthest);
  return vertices_[farthest];
}

void VertexTree::Search(int index, const Vector3d& n, double& most, int& farthest) const {
  const Node& node = nodes_[index];
  if (node.second == 0) {
    for (int v = node.begin; v < node.end; ++v) {
      const double reach = n.dot(vertices_[v]);
      if (reach <= most) continue;
      most = reach;
      farthest = v;
    }
    return;
  }
  const auto bound = [&](int child) {
    return n.dot(nodes_[child].center) + n.cwiseAbs().dot(nodes_[child].half);
  };
  int near = index + 1, far = node.second;
  double near_bound = bound(near), far_bound = bound(far);
  if (near_bound < far_bound) {
    std::swap(near, far);
    std::swap(near_bound, far_bound);
  }
  if (near_bound > most) Search(near, n, most, farthest);
  if (far_bound > most) Search(far, n, most, farthest);
}

}  // namespace mjcf_pdg::verify
