// The narrow phase for SDF geoms: contact features of an SDF geom and another geom, by their
// signed distance functions f1 and f2 alone.
//
// Where max(f1, f2) has a minimum at x, the two are nearest (or overlap most) around x: f1 = f2
// there and their gradients are opposite, so that f1 + f2 is the signed distance, and the gradient
// of f1 the normal. The minima are sought from the points of a grid over the place where the geoms'
// bounding boxes meet, by steps along the valley in which the two are equal. Nothing is proven: a
// feature that is finer than the grid may be missed.
#ifndef MJCF_PDG_SRC_COLLIDE_SDF_SDF_CONTACTS_H_
#define MJCF_PDG_SRC_COLLIDE_SDF_SDF_CONTACTS_H_

#include <array>
#include <vector>

#include "base/signed_gap.h"
#include "collide/sdf/posed_field.h"

namespace mjcf_pdg {

// One per thread: it keeps its scratch.
class SdfContacts {
 public:
  // `tables` must outlive this object.
  explicit SdfContacts(const SceneTables& tables) : tables_(tables) {}

  // Appends the features of SceneTables::pairs[pair], one geom of which is an SDF, that are nearer
  // than `margin` [m], in the world frame W, the deepest or nearest first.
  void Features(const PosedModel& posed, int pair, double margin, std::vector<SignedGap>& out);

 private:
  // A grid of corners over a box.
  struct Grid {
    Vector3d low, cell;
    std::array<int, 3> corners;

    Vector3d Corner(int i, int j, int k) const {
      return low + cell.cwiseProduct(Vector3d(i, j, k));
    }
    std::size_t Index(int i, int j, int k) const {
      return static_cast<std::size_t>((i * corners[1] + j) * corners[2] + k);
    }
  };
  // A corner that is lower than those around it.
  struct Start {
    double value;
    Vector3d x_W;
  };

  void FindStarts(const Grid& grid, double below);
  bool IsLowest(const Grid& grid, int i, int j, int k) const;

  const SceneTables& tables_;
  std::vector<double> values_;  // max(f1, f2) at the grid's corners
  std::vector<Start> starts_;
  std::vector<SignedGap> found_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_SDF_SDF_CONTACTS_H_
