// A simplex of one to four points and its point nearest to the origin: the inner step of the GJK
// search in ConvexDistance.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_SIMPLEX_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_SIMPLEX_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

// Its corners are points of the Minkowski difference of two bodies. All points are in one frame and
// lengths in one unit, both of the caller's choice.
class Simplex {
 public:
  struct Corner {
    Eigen::Vector3d x, p1, p2;  // x = p1 - p2, with p1 on body 1 and p2 on body 2
    double weight = 1.0;        // barycentric coordinate of the nearest point
  };

  int size() const { return size_; }
  const Corner& operator[](int k) const { return corners_[k]; }
  const Eigen::Vector3d& Last() const { return corners_[size_ - 1].x; }

  void Clear() { size_ = 0; }
  void Add(const Corner& corner) { corners_[size_++] = corner; }  // at most four
  void DropLast() { --size_; }

  // Reduces a non-empty simplex to the corners of its smallest face that contains the point nearest
  // to the origin, and sets their weights. Four corners are left only if the origin is inside;
  // their weights are then not set.
  void KeepClosestSubSimplex();

  // The weighted mean of the corners: after KeepClosestSubSimplex with at most three corners left,
  // x is the point nearest to the origin, p1 and p2 the witness points on the bodies.
  Corner Nearest() const;

 private:
  Corner corners_[4];
  int size_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_SIMPLEX_H_
