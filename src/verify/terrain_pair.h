// A height field and a convex geom: the verifier's own reading of the field, prism by prism.
//
// The field is the union of prisms, one below each triangle of its surface. The geom keeps its
// distance from the field if it keeps it from each prism near it, which certificates of convex
// pairs prove (certificate.h). Depths of single prisms prove nothing about an overlap, because the
// way out of a prism may lead into the next one: an overlap is permitted only if a translation of
// the permitted length is found that takes the geom out of all of them. The ways tried lead
// up, along normals of the surface, and out of the field's sides and base.
#ifndef MJCF_PDG_SRC_VERIFY_TERRAIN_PAIR_H_
#define MJCF_PDG_SRC_VERIFY_TERRAIN_PAIR_H_

#include <array>

#include "verify/posed_pair.h"

namespace mjcf_pdg::verify {

// Refers to the model, data and pair, which must outlive it. Everything inside is in the axes of
// the field, relative to the geom's origin; lengths in m.
class TerrainPair {
 public:
  // Geom 1 of the pair is the height field.
  explicit TerrainPair(const PosedPair& posed);

  // Whether the signed distance is at least `needed` [m]: kPlane if it is, with a plane for each
  // prism near the geom or, if it overlaps, near the geom moved by no more than -needed.
  Proof Judge(double needed) const;
  // The signed distance, if it is below `cutoff` [m], else infinity. The depth of an overlap is the
  // length of the shortest way out that is found.
  Reading Measure(double cutoff) const;

 private:
  using Corners = std::array<Vector3d, 6>;  // of a prism: its top, counter-clockwise, and its base
  // A translation out of the field by length · u, and the normal of the plane where it ends.
  struct Way {
    Vector3d u = Vector3d::UnitZ(), n = Vector3d::UnitZ();
    double length = 0.0;
  };
  // Unit vectors along which a way out is sought; of normals of the surface that are alike, one.
  struct Directions {
    std::array<Vector3d, 12> u;
    std::size_t size = 0;
  };

  // Calls visit(corners) for one prism after the other within `reach` of the geom moved by `shift`.
  // Ends and returns false when visit returns false; otherwise returns true.
  template <typename Visit>
  bool ForEachPrism(const Vector3d& shift, double reach, Visit visit) const;
  Corners PrismAt(int row, int col, int triangle) const;
  Vector3d Farthest(const Vector3d& n) const;  // of the geom, along the unit vector n
  Certificate About(const Corners& corners, const Vector3d& shift, double needed, double cutoff,
                    bool measure) const;
  bool Parted(const Corners& corners, const Vector3d& shift) const;
  bool Free(const Vector3d& shift) const;
  Way LeaveBox() const;
  Directions WaysOut() const;
  Way Leave(const Corners& corners, const Vector3d& u) const;
  bool Shorten(const Vector3d& u, Way& best) const;
  Reading Overlap() const;
  Reading ToWorld(const Certificate& found) const;

  const ConvexShape& shape_;
  const double* size_;  // of the field: half sizes along x and y, largest z, depth of the base
  const float* heights_;
  int rows_, cols_;  // of corners
  Matrix3d R_field_, R_;
  Vector3d field_W_, origin_;  // of the geom, in the frame of the field
  double rounding_;
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_TERRAIN_PAIR_H_
