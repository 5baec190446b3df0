#include "verify/convex/convex_shape.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mjcf_pdg::verify {
namespace {

// The point of a disc of radius r (normal z) that is farthest along n; its centre if n is along z.
Vector3d OnCircle(const Vector3d& n, double r) {
  const double length = std::hypot(n.x(), n.y());
  return length > 0.0 ? Vector3d(r * n.x() / length, r * n.y() / length, 0.0) : Vector3d::Zero();
}

}  // namespace

Vector3d ConvexShape::Support(const Vector3d& n) const {
  switch (type) {
    case mjGEOM_SPHERE:
      return Vector3d::Zero();
    case mjGEOM_CAPSULE:
      return {0.0, 0.0, std::copysign(size[1], n.z())};
    case mjGEOM_ELLIPSOID: {
      const Vector3d scaled = size.cwiseProduct(n);
      return size.cwiseProduct(scaled / scaled.norm());
    }
    case mjGEOM_CYLINDER:
      return OnCircle(n, size[0]) + Vector3d(0.0, 0.0, std::copysign(size[1], n.z()));
    case mjGEOM_BOX:
      return {std::copysign(size[0], n.x()), std::copysign(size[1], n.y()),
              std::copysign(size[2], n.z())};
    case mjGEOM_MESH:
      return vertices->Support(n);
    case mjGEOM_HFIELD: {
      const auto less = [&n](const Vector3d& a, const Vector3d& b) { return a.dot(n) < b.dot(n); };
      return *std::max_element(prism->begin(), prism->end(), less);
    }
    default:
      throw std::logic_error("a geom of this type has no support points");
  }
}

}  // namespace mjcf_pdg::verify
