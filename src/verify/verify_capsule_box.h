// The independent check's own signed distance of a capsule and a box.
//
// MuJoCo 4.0's misses capsules that pierce the box. Shares no code with capsule_box.h, which the
// solver uses, and goes another way: a golden-section search along the capsule's axis outside, the
// overlap of projections inside.
#ifndef MJCF_PDG_SRC_VERIFY_VERIFY_CAPSULE_BOX_H_
#define MJCF_PDG_SRC_VERIFY_VERIFY_CAPSULE_BOX_H_

#include <mujoco/mujoco.h>

namespace mjcf_pdg {

// Of the geoms `capsule` and `box` as posed in `d`; `fromto` gets witness points as from
// mj_geomDistance.
double CapsuleBoxDistance(const mjModel& m, const mjData& d, int capsule, int box,
                          double fromto[6]);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_VERIFY_VERIFY_CAPSULE_BOX_H_
