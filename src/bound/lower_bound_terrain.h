// Convex solids inside a height field, in the place of the field: a geom that is free of the field
// is free of each of them, so what parting it from one of them costs at least, parting it from the
// field does.
//
// A solid stands on a rectangle of whole cells, between the field's base and a plane that is
// nowhere above the surface there. (Surface and plane are linear over each triangle: the corners of
// the cells decide.) Wide solids
// make ways out past their sides long; narrow ones reach up to the surface.
//
// Part of lower_bound.h.
#ifndef MJCF_PDG_SRC_BOUND_LOWER_BOUND_TERRAIN_H_
#define MJCF_PDG_SRC_BOUND_LOWER_BOUND_TERRAIN_H_

#include <array>
#include <vector>

#include "collide/contacts.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

struct InscribedSolid {
  std::array<Vector3d, 8> corners_W;
  Vector3d up_W = Vector3d::UnitZ();  // normal of its top
};

// Replaces `solids` by some around the place where a geom is `deep` [m] in the field. `near` is of
// that pair, whose geom 1 is the field. Leaves none if that place is beside the field.
void FindInscribed(const PosedModel& posed, int field, const NearPair& near, double deep,
                   std::vector<InscribedSolid>& solids);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LOWER_BOUND_TERRAIN_H_
