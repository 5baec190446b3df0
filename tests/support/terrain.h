// Height fields for tests, and a slow oracle of them: each prism as a convex mesh of its own.
#ifndef MJCF_PDG_TESTS_SUPPORT_TERRAIN_H_
#define MJCF_PDG_TESTS_SUPPORT_TERRAIN_H_

#include <functional>
#include <string>
#include <vector>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

// Heights [m] at rows × cols corners, rows along y; at least one must be 0 and one positive.
struct Field {
  int rows = 2, cols = 2;
  double half_x = 1.0, half_y = 1.0, base = 0.1;  // [m]
  std::vector<double> heights = {};
  std::string pose = {};  // XML attributes of the geom: pos, quat

  double Top() const;                              // the largest height
  Eigen::Vector3d Corner(int row, int col) const;  // in the frame of the field
};

// Sets the heights from a function of x and y, less its least value.
Field MakeField(int rows, int cols, double half_x, double half_y,
                const std::function<double(double, double)>& height);
// Every height uniform in [0, top].
Field NoisyField(int rows, int cols, double half_x, double half_y, double top, Random& rng);

// A scene with the field as geom "field" and `shape` as geom "geom" of a free body; `extra` is
// further XML in the world.
std::string FieldXml(const Field& field, const Shape& shape, const std::string& extra = {});
// The same, and the prism below each triangle as a mesh geom that collides with nothing. MuJoCo's
// diagonals are those of its own collision code.
std::string FieldWithPrismsXml(const Field& field, const Shape& shape);

// Of a model from FieldWithPrismsXml.
class PrismOracle {
 public:
  explicit PrismOracle(const std::string& xml);

  void Pose(const Eigen::VectorXd& q);
  // The distance of "geom" moved by `shift` from the nearest prism [m]. Negative: the deepest
  // overlap with one prism; as the depth of the whole it may be too small.
  double Distance(const Eigen::Vector3d& shift_W = Eigen::Vector3d::Zero());

  const mjModel* model() const { return model_.get(); }
  const mjData* data() const { return data_.get(); }
  int field() const { return mj_name2id(model(), mjOBJ_GEOM, "field"); }
  int geom() const { return mj_name2id(model(), mjOBJ_GEOM, "geom"); }

 private:
  ModelPtr model_;
  DataPtr data_;
  Eigen::VectorXd q_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_TERRAIN_H_
