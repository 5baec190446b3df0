// The prisms of a height field (model/height_field.h), as the questions about a geom near them see
// them.
#ifndef MJCF_PDG_SRC_COLLIDE_TERRAIN_PRISM_H_
#define MJCF_PDG_SRC_COLLIDE_TERRAIN_PRISM_H_

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <utility>

#include "model/kinematics.h"

namespace mjcf_pdg {

// The prism below one triangle of the surface.
struct Prism {
  std::array<Vector3d, 3> top;
  double base = 0.0;  // z

  Vector3d Support(const Vector3d& n) const;  // a point farthest along n
  // n · Support(n). Inline, because every prism near a geom is asked a few times.
  double Farthest(const Vector3d& n) const {
    const double down = n.z() * base;
    double farthest = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double along =
          n.x() * top[k].x() + n.y() * top[k].y() + std::max(n.z() * top[k].z(), down);
      farthest = k == 0 ? along : std::max(farthest, along);
    }
    return farthest;
  }
  // The least and the greatest n · p of its points p.
  std::pair<double, double> Extent(const Vector3d& n) const {
    const double down = n.z() * base;
    std::pair<double, double> extent;
    for (int k = 0; k < 3; ++k) {
      const double level = n.x() * top[k].x() + n.y() * top[k].y(), up = n.z() * top[k].z();
      const double least = level + std::min(up, down), most = level + std::max(up, down);
      extent.first = k == 0 ? least : std::min(extent.first, least);
      extent.second = k == 0 ? most : std::max(extent.second, most);
    }
    return extent;
  }
  Vector3d Cross() const;  // normal of the top, upwards, of any length
  Vector3d Normal() const { return Cross().normalized(); }
};

// A prism and a lower bound of its distance from the core, negative if they seem to overlap [m].
struct NearPrism {
  double at_least = 0.0;
  Prism prism;
  int row = 0, col = 0;  // of its cell
  // Of the search for a way out: an upper bound of the way out of this one [m]; whether all planes
  // that are known have been asked for it; whether the way leads past it.
  double exit = 0.0;
  bool asked = false, passed = false;
  // Of the search for the nearest ones: which of the answers is this one's, -1: not measured.
  int answer = -1;
  int planes = 0;  // ... how many planes its bound knows
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_TERRAIN_PRISM_H_
