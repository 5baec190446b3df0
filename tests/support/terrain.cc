#include "tests/support/terrain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/brute_distance.h"

namespace mjcf_pdg::test {
namespace {

// In MJCF the row of the largest y comes first.
std::string Elevation(const Field& field) {
  std::string text;
  for (int row = field.rows - 1; row >= 0; --row) {
    text += Join(field.heights.data() + row * field.cols, field.cols) + " ";
  }
  return text;
}

std::string FieldAsset(const Field& field) {
  const double size[] = {field.half_x, field.half_y, field.Top(), field.base};
  return "<hfield name='field' nrow='" + std::to_string(field.rows) + "' ncol='" +
         std::to_string(field.cols) + "' size='" + Join(size, 4) + "' elevation='" +
         Elevation(field) + "'/>";
}

std::string ShapeAsset(const Shape& shape) {
  if (shape.type != mjGEOM_MESH) return "";
  std::string vertices;
  for (const Eigen::Vector3d& p : shape.vertices) vertices += Join(p.data(), 3) + " ";
  return "<mesh name='shape' vertex='" + vertices + "'/>";
}

std::string ShapeGeom(const Shape& shape) {
  const std::string what =
      shape.type == mjGEOM_MESH ? "mesh='shape'" : "size='" + Join(shape.size.data(), 3) + "'";
  return "<body><freejoint/><geom name='geom' type='" + TypeName(shape.type) + "' " + what + " " +
         shape.attributes + "/></body>";
}

std::string Whole(const Field& field, const Shape& shape, const std::string& assets,
                  const std::string& extra) {
  // The field is not the first geom, whose offsets would all be 0.
  return "<mujoco><asset>" + FieldAsset(field) + ShapeAsset(shape) + assets +
         "</asset><worldbody><geom size='.01' pos='3 4 5' contype='0' conaffinity='0'/>"
         "<geom name='field' type='hfield' hfield='field' " +
         field.pose + "/>" + ShapeGeom(shape) + extra + "</worldbody></mujoco>";
}

}  // namespace

double Field::Top() const { return *std::max_element(heights.begin(), heights.end()); }

Eigen::Vector3d Field::Corner(int row, int col) const {
  return {half_x * (2.0 * col / (cols - 1) - 1.0), half_y * (2.0 * row / (rows - 1) - 1.0),
          heights[row * cols + col]};
}

Field MakeField(int rows, int cols, double half_x, double half_y,
                const std::function<double(double, double)>& height) {
  Field field{rows, cols, half_x, half_y};
  field.heights.resize(rows * cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const Eigen::Vector3d at = field.Corner(row, col);
      field.heights[row * cols + col] = height(at.x(), at.y());
    }
  }
  const double least = *std::min_element(field.heights.begin(), field.heights.end());
  for (double& h : field.heights) h -= least;
  return field;
}

Field NoisyField(int rows, int cols, double half_x, double half_y, double top, Random& rng) {
  return MakeField(rows, cols, half_x, half_y, [&](double, double) { return rng.Uniform(0, top); });
}

std::string FieldXml(const Field& field, const Shape& shape, const std::string& extra) {
  return Whole(field, shape, "", extra);
}

std::string FieldWithPrismsXml(const Field& field, const Shape& shape) {
  std::string assets, geoms;
  for (int row = 0; row + 1 < field.rows; ++row) {
    for (int col = 0; col + 1 < field.cols; ++col) {
      for (int triangle = 0; triangle < 2; ++triangle) {
        const std::string name =
            std::to_string(row) + "_" + std::to_string(col) + "_" + std::to_string(triangle);
        std::string vertices;
        for (const auto& [r, c] : std::array<std::array<int, 2>, 3>{
                 {{0, 0}, {1, 1}, {triangle == 0 ? 0 : 1, triangle == 0 ? 1 : 0}}}) {
          Eigen::Vector3d p = field.Corner(row + r, col + c);
          vertices += Join(p.data(), 3) + " ";
          p.z() = -field.base;
          vertices += Join(p.data(), 3) + " ";
        }
        assets += "<mesh name='" + name + "' vertex='" + vertices + "'/>";
        geoms += "<geom name='prism" + name + "' type='mesh' mesh='" + name +
                 "' contype='0' conaffinity='0' " + field.pose + "/>";
      }
    }
  }
  return Whole(field, shape, assets, geoms);
}

PrismOracle::PrismOracle(const std::string& xml)
    : model_(LoadModel(xml)), data_(mj_makeData(model_.get())) {}

void PrismOracle::Pose(const Eigen::VectorXd& q) {
  q_ = q;
  mju_copy(data_->qpos, q.data(), static_cast<int>(model_->nq));
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
}

double PrismOracle::Distance(const Eigen::Vector3d& shift_W) {
  Eigen::VectorXd q = q_;
  q.head<3>() += shift_W;
  const Eigen::VectorXd kept = q_;
  Pose(q);
  q_ = kept;
  const mjModel& m = *model_;
  const double* x = data_->geom_xpos;
  double least = 1.0;
  for (int g = 0; g < m.ngeom; ++g) {
    if (m.geom_type[g] != mjGEOM_MESH || g == geom()) continue;
    const double apart = mju_dist3(x + 3 * g, x + 3 * geom()) - m.geom_rbound[g];
    if (apart - m.geom_rbound[geom()] > least) continue;
    least = std::min(least, BruteDistance(&m, data_.get(), g, geom()).distance);
  }
  return least;
}

}  // namespace mjcf_pdg::test
