// The verifier's broad phase: which pairs may be nearer than a given distance. A sweep over
// bounding spheres, along the axis on which they are spread widest, spares scenes of many bodies
// the look at every pair.
#ifndef MJCF_PDG_SRC_VERIFY_SWEEP_H_
#define MJCF_PDG_SRC_VERIFY_SWEEP_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "verify/verifier_model.h"

namespace mjcf_pdg::verify {

class Sweep {
 public:
  // `model` must outlive this object.
  explicit Sweep(const VerifierModel& model);

  // The pairs, as indices of VerifierModel::pairs, whose bounding spheres are nearer than `reach`
  // [m], and all pairs with a plane; none that only contacts decide. Valid until the next call;
  // allocates nothing.
  const std::vector<int>& Near(const mjData& data, double reach);

 private:
  // The bounding sphere of a geom, with half of the reach around it [m].
  struct Swept {
    int geom = 0;
    double radius = 0.0, low = 0.0, high = 0.0;  // `low` and `high`: its ends along the axis
    Vector3d center_W = Vector3d::Zero();
  };
  struct Partner {
    int geom = 0, pair = 0;
  };
  void Place(const mjData& data, double reach);
  void Sort();
  // The pair of two geoms; -1: none.
  int PairOf(int geom1, int geom2) const;

  const VerifierModel& model_;
  std::vector<Swept> swept_;       // by `low` of the last call, so that sorting has little to do
  std::vector<int> begin_;         // by geom: where its partners begin; one more entry
  std::vector<Partner> partners_;  // geom by geom, those of higher id, ascending
  std::vector<int> with_plane_;
  std::vector<int> near_;
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_SWEEP_H_
