#include "gradient/support_pieces.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "collide/convex/support_points.h"

namespace mjcf_pdg {
namespace {

using Kind = SupportPiece::Kind;

// A plane that is tilted by less than this against a cylinder's cap touches the cap, not its rim
// [rad]: the rim's support function has no derivative along the axis.
constexpr double kFlat = 1e-4;
// A cap that a plane touches is a polygon of this many points of its rim, which covers 95 % of it.
constexpr int kCapPoints = 12;
// The most pieces of a geom that a plane may touch at once [1]. A finely cut mesh has more within
// the slab; the nearest count.
constexpr std::size_t kMost = 32;

void AppendCylinder(const Vector3d& size, const Vector3d& u_G, std::vector<SupportPiece>& pieces) {
  const double radius = size[0], half = size[1];
  const double across = u_G.head<2>().norm();
  for (const double side : {1.0, -1.0}) {
    const int id = side > 0.0 ? 0 : 1;
    if (across > kFlat) {
      pieces.push_back({Kind::kRim, id, Vector3d(0.0, 0.0, side * half), radius});
      continue;
    }
    for (int k = 0; k < kCapPoints; ++k) {
      const double angle = 2.0 * mjPI * k / kCapPoints;
      const Vector3d p(radius * std::cos(angle), radius * std::sin(angle), side * half);
      pieces.push_back({Kind::kPoint, 2 + 2 * k + id, p, 0.0});
    }
  }
}

void AppendAll(const SceneTables& tables, int geom, const Vector3d& u_G,
               std::vector<SupportPiece>& pieces) {
  const mjModel& m = *tables.model;
  const Vector3d size = AsVector(m.geom_size + 3 * geom);
  switch (m.geom_type[geom]) {
    case mjGEOM_SPHERE:
      pieces.push_back({Kind::kPoint, 0, Vector3d::Zero(), size[0]});
      break;
    case mjGEOM_CAPSULE:
      for (const int end : {0, 1}) {
        pieces.push_back(
            {Kind::kPoint, end, Vector3d(0.0, 0.0, end == 0 ? size[1] : -size[1]), size[0]});
      }
      break;
    case mjGEOM_ELLIPSOID:
      pieces.push_back({Kind::kEllipsoid, 0, size, 0.0});
      break;
    case mjGEOM_CYLINDER:
      AppendCylinder(size, u_G, pieces);
      break;
    case mjGEOM_BOX:
      for (int k = 0; k < 8; ++k) {
        const Vector3d signs(k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0);
        pieces.push_back({Kind::kPoint, k, signs.cwiseProduct(size), 0.0});
      }
      break;
    case mjGEOM_MESH: {
      const std::span<const Eigen::Vector3f> points = tables.support->HullPoints(geom);
      for (std::size_t k = 0; k < points.size(); ++k) {
        pieces.push_back({Kind::kPoint, static_cast<int>(k), points[k].cast<double>(), 0.0});
      }
      break;
    }
    default:
      break;
  }
}

}  // namespace

SupportValue Evaluate(const SupportPiece& piece, const Vector3d& u_G) {
  SupportValue value;
  switch (piece.kind) {
    case Kind::kPoint:
      value.x_G = piece.p_G + piece.radius * u_G;
      value.second_G = piece.radius * (Matrix3d::Identity() - u_G * u_G.transpose());
      break;
    case Kind::kRim: {
      const double across = u_G.head<2>().norm();
      if (across == 0.0) {
        value.x_G << piece.radius, 0.0, piece.p_G.z();
        break;
      }
      const Eigen::Vector2d out = u_G.head<2>() / across;
      value.x_G << piece.radius * out, piece.p_G.z();
      value.second_G.topLeftCorner<2, 2>() =
          piece.radius / across * (Eigen::Matrix2d::Identity() - out * out.transpose());
      break;
    }
    case Kind::kEllipsoid: {
      const Vector3d squares = piece.p_G.cwiseAbs2();
      const double h = u_G.cwiseProduct(piece.p_G).norm();
      value.x_G = squares.cwiseProduct(u_G) / h;
      value.second_G = squares.asDiagonal();
      value.second_G = (value.second_G - value.x_G * value.x_G.transpose()).eval() / h;
      break;
    }
  }
  value.h = u_G.dot(value.x_G);
  return value;
}

void FindPieces(const SceneTables& tables, int geom, const Vector3d& u_G, double slab,
                std::vector<SupportPiece>& pieces) {
  pieces.clear();
  AppendAll(tables, geom, u_G, pieces);
  std::vector<std::pair<double, std::size_t>> reach;
  for (std::size_t k = 0; k < pieces.size(); ++k) reach.push_back({-Evaluate(pieces[k], u_G).h, k});
  std::sort(reach.begin(), reach.end());
  std::vector<SupportPiece> kept;
  for (const auto& [minus_h, k] : reach) {
    if (kept.size() == kMost || minus_h > reach.front().first + slab) break;
    kept.push_back(pieces[k]);
  }
  pieces.swap(kept);
}

}  // namespace mjcf_pdg
