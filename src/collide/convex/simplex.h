// The point nearest to the origin of the hull of at most four points.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_SIMPLEX_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_SIMPLEX_H_

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
  void Add(const Corner& corner) { corners_[size_++] = corner; }
  void DropLast() { --size_; }

  // Weighs the corners so that their mean is nearest to the origin and drops those without weight;
  // four are left only if the origin is inside.
  void KeepClosestSubSimplex();

  // The weighted mean of the corners: the nearest point, and where it is on either body.
  Corner Nearest() const;

 private:
  Corner corners_[4];
  int size_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_SIMPLEX_H_
