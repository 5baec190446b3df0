#include "collide/convex/expanding_polytope.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;

// A point beyond a face's plane by less than this counts as on it [distance from the origin of the
// farthest of the first four corners].
constexpr double kBeside = 1e-10;
constexpr double kFlat = 1e-9;  // a triangle counts as degenerate if an angle's sine is smaller

}  // namespace

void ExpandingPolytope::Reserve(int corners) {
  corners_.reserve(corners);
  faces_.reserve(2 * corners);  // by Euler's formula, 2 V - 4
  horizon_.reserve(3 * corners);
}

bool ExpandingPolytope::Start(const Simplex& simplex) {
  corners_.clear();
  faces_.clear();
  double farthest = 0.0;
  for (int k = 0; k < 4; ++k) {
    corners_.push_back(simplex[k]);
    farthest = std::max(farthest, simplex[k].x.norm());
  }
  beside_ = kBeside * farthest;
  const Vector3d &a = corners_[0].x, &b = corners_[1].x, &c = corners_[2].x, &d = corners_[3].x;
  if ((b - a).cross(c - a).dot(d - a) > 0.0) std::swap(corners_[0], corners_[1]);
  return AddFace(0, 1, 2) && AddFace(0, 3, 1) && AddFace(1, 3, 2) && AddFace(2, 3, 0);
}

bool ExpandingPolytope::AddFace(int a, int b, int c) {
  const Vector3d ab = corners_[b].x - corners_[a].x, ac = corners_[c].x - corners_[a].x;
  const Vector3d normal = ab.cross(ac);
  const double squared = normal.squaredNorm();
  if (!(squared > kFlat * kFlat * ab.squaredNorm() * ac.squaredNorm())) return false;
  const Vector3d n = normal / std::sqrt(squared);
  faces_.push_back({{a, b, c}, n, n.dot(corners_[a].x)});
  return faces_.back().distance > -beside_;  // else the origin is outside
}

bool ExpandingPolytope::HorizonIsOneLoop() {
  for (std::size_t k = 0; k + 1 < horizon_.size(); ++k) {
    const auto next = std::find_if(horizon_.begin() + k + 1, horizon_.end(),
                                   [&](const Edge& e) { return e.from == horizon_[k].to; });
    if (next == horizon_.end()) return false;
    std::swap(horizon_[k + 1], *next);
  }
  return horizon_.size() >= 3 && horizon_.back().to == horizon_.front().from;
}

bool ExpandingPolytope::Add(const Corner& corner) {
  horizon_.clear();
  for (std::size_t k = 0; k < faces_.size();) {
    const Face face = faces_[k];
    if (face.n.dot(corner.x) - face.distance <= beside_) {
      ++k;
      continue;
    }
    // The corner sees this face: its edges are on the horizon, unless another such face shares
    // them.
    for (int side = 0; side < 3; ++side) {
      const Edge edge{face.corners[side], face.corners[(side + 1) % 3]};
      const auto twin = std::find_if(horizon_.begin(), horizon_.end(), [&](const Edge& e) {
        return e.from == edge.to && e.to == edge.from;
      });
      if (twin == horizon_.end()) {
        horizon_.push_back(edge);
      } else {
        *twin = horizon_.back();
        horizon_.pop_back();
      }
    }
    faces_[k] = faces_.back();
    faces_.pop_back();
  }
  if (horizon_.empty()) return true;
  if (!HorizonIsOneLoop()) return false;
  corners_.push_back(corner);
  const int last = static_cast<int>(corners_.size()) - 1;
  return std::all_of(horizon_.begin(), horizon_.end(),
                     [&](const Edge& e) { return AddFace(e.from, e.to, last); });
}

const ExpandingPolytope::Face& ExpandingPolytope::Nearest() const {
  return *std::min_element(faces_.begin(), faces_.end(),
                           [](const Face& a, const Face& b) { return a.distance < b.distance; });
}

ExpandingPolytope::Corner ExpandingPolytope::Foot(const Face& face) const {
  const Vector3d foot = face.distance * face.n;
  Corner sum{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), 0.0};
  for (int k = 0; k < 3; ++k) {
    const Corner& corner = corners_[face.corners[k]];
    const Vector3d to_next = corners_[face.corners[(k + 1) % 3]].x - foot;
    const Vector3d to_last = corners_[face.corners[(k + 2) % 3]].x - foot;
    const double weight = to_next.cross(to_last).dot(face.n);  // twice the opposite area
    sum.x += weight * corner.x;
    sum.p1 += weight * corner.p1;
    sum.p2 += weight * corner.p2;
    sum.weight += weight;
  }
  return {sum.x / sum.weight, sum.p1 / sum.weight, sum.p2 / sum.weight, 1.0};
}

}  // namespace mjcf_pdg
