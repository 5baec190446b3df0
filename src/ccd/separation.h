// Two geoms kept apart by a moving plane: a proof of distance that needs no distance query.
//
// With n a unit normal from geom 1 to geom 2 and h the support function, -h_2(-n) - h_1(n) is a
// lower bound of the signed distance of two convex geoms, whatever n; at the witness normal it is
// the distance. Along a motion x(s) = x + s x' + ½ s² x'' + (at most j s³ / 6), x' = v + ω×x, the
// support function is asked in the tilted direction n + s n×ω, and n·x'' is bounded by a support of
// its own, so that the bound is exact to first order and nearly to second: geoms that slide along
// each other, or part, are passed in few steps. An exact mesh counts as its convex hull, which only
// lowers the bound; and so does a height field, as the hull of those of its prisms that the geom
// can come near on the step.
#ifndef MJCF_PDG_SRC_CCD_SEPARATION_H_
#define MJCF_PDG_SRC_CCD_SEPARATION_H_

#include <vector>

#include "ccd/motion_bound.h"
#include "collide/convex/support_points.h"
#include "collide/terrain/prism.h"

namespace mjcf_pdg {

// One per thread.
class Separation {
 public:
  explicit Separation(const SceneTables& tables) : tables_(tables), support_(*tables.support) {}

  // A lower bound of the pair's signed distance [m] by the plane of normal n_W; -inf where a geom
  // is not convex (a height field) or has no support points (an SDF). A plane's own normal must be
  // given for it.
  double Distance(const PosedModel& posed, int geom1, int geom2, const Vector3d& n_W) const;

  // The largest h <= horizon found so that the distance is proven to stay >= floor on [0, h] from
  // the pose on; 0 when nothing is proven. `motion` must hold on the horizon.
  double SafeStep(const PosedModel& posed, const KeptPair& pair, const Vector3d& n_W,
                  const RelativeMotion& motion, double floor, double horizon);

  // max of direction_W · x over the geom.
  double Support(const PosedModel& posed, int geom, const Vector3d& direction_W) const;

 private:
  double CoreSupport(const PosedModel& posed, int geom, const Vector3d& direction_W) const;
  bool CollectTerrain(const PosedModel& posed, const KeptPair& pair, double reach);
  Vector3d FarthestOfPrisms(const Vector3d& u_F) const;
  double TerrainSupport(const PosedModel& posed, int field, const Vector3d& n_W) const;

  const SceneTables& tables_;
  const SupportPoints& support_;
  std::vector<NearPrism> prisms_;  // near the geom, in the frame of the field
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_CCD_SEPARATION_H_
