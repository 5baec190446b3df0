// The point nearest to the origin of the hull of at most four points.
#ifndef MJCF_PDG_SRC_SIMPLEX_H_
#define MJCF_PDG_SRC_SIMPLEX_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

// Corners are differences p1 - p2 of points of two bodies.
class Simplex {
 public:
  struct Corner {
    Eigen::Vector3d x, p1, p2;  // x = p1 - p2
    double weight = 1.0;
  };

  int size() const { return size_; }
  const Corner& operator[](int k) const { return corners_[k]; }
  const Eigen::Vector3d& Last() const { return corners_[size_ - 1].x; }

  void Clear() { size_ = 0; }
  void Add(const Eigen::Vector3d& p1, const Eigen::Vector3d& p2) {
    corners_[size_++] = {p1 - p2, p1, p2};
  }
  void DropLast() { --size_; }

  // Weighs the corners so that their mean is nearest to the origin and drops those without weight;
  // four are left only if the origin is inside.
  void Reduce();

  // Weighted means: the nearest point, and where it is on either body.
  Eigen::Vector3d Nearest() const { return Mean(&Corner::x); }
  Eigen::Vector3d Nearest1() const { return Mean(&Corner::p1); }
  Eigen::Vector3d Nearest2() const { return Mean(&Corner::p2); }

 private:
  Eigen::Vector3d Mean(Eigen::Vector3d Corner::*what) const {
    Eigen::Vector3d mean = corners_[0].weight * (corners_[0].*what);
    for (int k = 1; k < size_; ++k) mean += corners_[k].weight * (corners_[k].*what);
    return mean;
  }

  Corner corners_[4];
  int size_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SIMPLEX_H_
