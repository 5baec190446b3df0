// A pair of which one geom at least is an SDF: whether the two overlap, by their signed distance
// functions f1 and f2 alone.
//
// They overlap where max(f1, f2) < 0, and the least value of that is half the signed distance. It
// is sought by subdividing the box in which the geoms' bounding boxes meet: a cell whose middle has
// the value f holds nothing below f less the slope times half its diagonal. Were the functions no
// steeper than assumed and the cells without number, that would be a proof; as it is, an overlap
// that is thinner than some 1e-5 of the geoms may be missed, and the answer is never called
// certified.
#ifndef MJCF_PDG_SRC_VERIFY_SDF_PAIR_H_
#define MJCF_PDG_SRC_VERIFY_SDF_PAIR_H_

#include <vector>

#include "verify/posed_pair.h"

namespace mjcf_pdg::verify {

// Refers to the model, data and pair, which must outlive it.
class SdfPair {
 public:
  explicit SdfPair(const PosedPair& posed) : posed_(posed) {}

  // The least signed distance that is found, infinite if nothing is below `cutoff` [m].
  Reading Measure(double cutoff) const;

 private:
  struct Cell {
    double at_least, value;
    Vector3d middle_W, half;
  };
  struct Lowest {
    double value;
    Vector3d x_W;
  };

  Eigen::AlignedBox3d BoxOf(int geom) const;
  double Distance(int geom, const Vector3d& x_W) const;
  double Larger(const Vector3d& x_W) const;
  Cell MakeCell(const Vector3d& middle_W, const Vector3d& half) const;
  // Lowers `lowest` by what is found in the box in `most` cells, among those that may have values
  // below `below`. What is left of them is in `cells`.
  void Search(const Eigen::AlignedBox3d& box, double below, int most, std::vector<Cell>& cells,
              Lowest& lowest) const;
  void ZoomIn(double half, Lowest& lowest) const;

  const PosedPair& posed_;
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_SDF_PAIR_H_
