// A convex geom and a height field at one pose, with what all questions about the two share: the
// prisms of the field near the geom, and the distance of the geom from one of them.
#ifndef MJCF_PDG_SRC_COLLIDE_TERRAIN_ON_TERRAIN_H_
#define MJCF_PDG_SRC_COLLIDE_TERRAIN_ON_TERRAIN_H_

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "collide/convex/gjk.h"
#include "collide/convex/support_points.h"
#include "collide/terrain/prism.h"
#include "collide/terrain/top_nearest.h"
#include "model/height_field.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// Everything is in the axes of the field, relative to the geom's origin; lengths in m. A geom is
// its core (support_points.h) and a ball of `radius` around it.
class OnTerrain {
 public:
  // Geom 1 of the pair is the height field.
  OnTerrain(const SceneTables& tables, const PosedModel& posed, const KeptPair& pair);

  double radius() const { return radius_; }
  double size() const { return size_; }  // the scene's

  // The cells below the core moved by `shift` and those within `reach` of that.
  CellRange CellsNear(const Vector3d& shift, double reach) const;
  // Replaces `near` by the prisms of these cells that are not known to be farther than `reach` from
  // the core moved by `shift`.
  void CollectPrisms(const CellRange& cells, const Vector3d& shift, double reach,
                     std::vector<NearPrism>& near) const;

  // A point of the core that is farthest along n.
  Vector3d Support(const Vector3d& n) const;
  // The field's own bounds, and the core's.
  Eigen::AlignedBox3d FieldBox() const { return field_.Box().translated(-origin_); }
  double dx() const { return field_.dx(); }
  double dy() const { return field_.dy(); }
  const Eigen::AlignedBox3d& core_box() const { return core_box_; }

  // The prism's distance from the core moved by `shift`; not measured beyond `cutoff`. Body 1 is
  // the prism. kEnclosed and kTouching: the two overlap, or cannot be told from overlapping.
  GjkEnding Ask(const Prism& prism, const Vector3d& shift, double cutoff,
                const GjkAccuracy& accuracy, GjkNearest& found) const;
  // The planes that bound ways along the unit vector u out of any prism: the one normal to u and
  // those of the core's box.
  struct WayPlanes {
    Vector3d u;
    struct Plane {
      Vector3d n;
      double along, nearest;  // n · u; the least n · p of points p of the core [m]
    };
    std::array<Plane, 4> planes;
    int count = 0;
  };
  WayPlanes PlanesOf(const Vector3d& u) const;
  // How far the geom must move to leave the prism, at most: by these planes and that of its top.
  double ExitBound(const Prism& prism, const WayPlanes& way) const;
  // Where on a way along u the core overlaps a prism: between `begin` and `end` [m], if that is
  // more, else nowhere. The unit vector n is the normal of the plane that parts the two at the end.
  struct Stretch {
    double begin = 0.0, end = 0.0;
    Vector3d n = Vector3d::UnitZ();
  };
  // Fills `overlap` if the core is a box, otherwise returns false: by all planes that can part the
  // two, but for those along an edge of the prism's base, without which it may be too long. If
  // only the place `at` [m] matters, ends with the first plane that shows that it is not inside.
  bool OverlapOfBox(const Prism& prism, const Vector3d& u, Stretch& overlap,
                    std::optional<double> at = std::nullopt) const;
  // Whether the prism overlaps the geom moved by `shift`, or cannot be told from overlapping.
  bool Overlap(const Prism& prism, const Vector3d& shift) const;
  bool CoreOverlaps(const Prism& prism, const Vector3d& shift) const;  // the same of the core

  Prism InField(Prism prism) const;  // in the frame of the field
  Vector3d ToWorld(const Vector3d& p) const { return field_x_W_ + R_field_W_ * (p + origin_); }
  Vector3d DirectionToWorld(const Vector3d& n) const { return R_field_W_ * n; }

  std::int64_t asked() const { return asked_; }  // calls of Ask

 private:
  double CoreNearest(const Vector3d& n) const;  // of the core's box: the least n · p
  bool Nearer(const Prism& prism, const Vector3d& shift, double apart) const;
  bool Proves(const NearestPoints& guess, const Prism& prism, const Vector3d& shift, double cutoff,
              const GjkAccuracy& accuracy, GjkNearest& found, GjkEnding& ending) const;

  const SupportPoints& support_;
  const HeightField field_;
  const int geom_;
  const double radius_, size_;
  Matrix3d R_field_W_, R_;
  Vector3d field_x_W_, origin_;  // `origin_`: of the geom, in the frame of the field
  // The core's box in its own axes, which are columns: its centre and half its edges, as vectors,
  // too; and its box in the field's axes.
  Matrix3d axes_;
  Vector3d center_, half_;
  Matrix3d half_edges_;
  enum class Core { kSegment, kBox, kOther } core_;  // a segment goes along the third axis
  Eigen::AlignedBox3d core_box_;
  mutable std::int64_t asked_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_TERRAIN_ON_TERRAIN_H_
