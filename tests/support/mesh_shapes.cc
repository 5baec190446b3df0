#include "tests/support/mesh_shapes.h"

#include <cmath>
#include <cstdio>

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kTurn = 2.0 * M_PI;

}  // namespace

Eigen::Matrix3Xd MeshShape::Vertices() const {
  Eigen::Matrix3Xd all(3, vertices.size());
  for (std::size_t k = 0; k < vertices.size(); ++k) all.col(k) = vertices[k];
  return all;
}

Eigen::Matrix3Xi MeshShape::Faces() const {
  Eigen::Matrix3Xi all(3, faces.size());
  for (std::size_t k = 0; k < faces.size(); ++k) all.col(k) = faces[k];
  return all;
}

MeshShape& MeshShape::Append(const MeshShape& other) {
  const Vector3i offset = Vector3i::Constant(static_cast<int>(vertices.size()));
  vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Vector3i& face : other.faces) faces.push_back(face + offset);
  return *this;
}

MeshShape& MeshShape::TurnInsideOut() {
  for (Vector3i& face : faces) std::swap(face[1], face[2]);
  return *this;
}

MeshShape& MeshShape::Move(const Eigen::Matrix3d& R, const Vector3d& t) {
  for (Vector3d& p : vertices) p = R * p + t;
  return *this;
}

MeshShape TorusSurface(int nu, int nv, const std::function<Vector3d(double, double)>& point) {
  MeshShape shape;
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      shape.vertices.push_back(point(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
      const int i2 = (i + 1) % nu, j2 = (j + 1) % nv;
      shape.faces.emplace_back(i * nv + j, i2 * nv + j, i2 * nv + j2);
      shape.faces.emplace_back(i * nv + j, i2 * nv + j2, i * nv + j2);
    }
  }
  return shape;
}

MeshShape Torus(double ring, double tube, int nu, int nv) {
  return TorusSurface(nu, nv, [&](double u, double v) {
    const double across = ring + tube * std::cos(kTurn * v);
    return Vector3d(across * std::cos(kTurn * u), across * std::sin(kTurn * u),
                    tube * std::sin(kTurn * v));
  });
}

MeshShape TorusKnot(double size, double tube, int nu, int nv) {
  auto center = [size](double u) {
    const double a = 2.0 * kTurn * u, b = 3.0 * kTurn * u, r = 1.0 + 0.45 * std::cos(b);
    return Vector3d(size * r * std::cos(a), size * r * std::sin(a), size * 0.45 * std::sin(b));
  };
  return TorusSurface(nu, nv, [&](double u, double v) {
    const Vector3d c = center(u), t = (center(u + 1e-5) - center(u - 1e-5)).normalized();
    const Vector3d n = (Vector3d(c.x(), c.y(), 0.0) - t * t.dot(Vector3d(c.x(), c.y(), 0.0)));
    const Vector3d e = n.normalized(), f = t.cross(e);
    return Vector3d(c + tube * (std::cos(kTurn * v) * e - std::sin(kTurn * v) * f));
  });
}

MeshShape Globe(int rings, int sectors, const std::function<double(const Vector3d&)>& r) {
  MeshShape shape;
  auto add = [&](double polar, double around) {
    const Vector3d d(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                     std::cos(polar));
    shape.vertices.push_back(r(d) * d);
  };
  add(0.0, 0.0);
  for (int i = 1; i < rings; ++i) {
    for (int j = 0; j < sectors; ++j) add(M_PI * i / rings, kTurn * j / sectors);
  }
  add(M_PI, 0.0);
  const int last = static_cast<int>(shape.vertices.size()) - 1;
  for (int j = 0; j < sectors; ++j) {
    const int j2 = (j + 1) % sectors;
    shape.faces.emplace_back(0, 1 + j, 1 + j2);
    for (int i = 0; i + 2 < rings; ++i) {
      const int a = 1 + i * sectors, b = a + sectors;
      shape.faces.emplace_back(a + j, b + j, b + j2);
      shape.faces.emplace_back(a + j, b + j2, a + j2);
    }
    const int a = 1 + (rings - 2) * sectors;
    shape.faces.emplace_back(a + j, last, a + j2);
  }
  return shape;
}

MeshShape BoxMesh(const Vector3d& half) {
  MeshShape shape;
  for (int k = 0; k < 8; ++k) {
    const Vector3d signs(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    shape.vertices.push_back(signs.cwiseProduct(half));
  }
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    shape.faces.emplace_back(q[0], q[1], q[2]);
    shape.faces.emplace_back(q[0], q[2], q[3]);
  }
  return shape;
}

MeshShape Revolution(const std::vector<Vector2d>& profile, int sectors) {
  const int n = static_cast<int>(profile.size());
  return TorusSurface(sectors, n, [&](double u, double v) {
    const Vector2d& p = profile[static_cast<std::size_t>(std::lround(v * n)) % profile.size()];
    return Vector3d(p.x() * std::cos(kTurn * u), p.x() * std::sin(kTurn * u), p.y());
  });
}

// Four circles from the outer bottom over the rim to the inner floor, and two discs that close the
// bottom and the floor.
MeshShape Cup(double radius, double height, double wall, int sectors) {
  MeshShape shape;
  const double inner = radius - wall;
  const double rings[4][2] = {{radius, 0.0}, {radius, height}, {inner, height}, {inner, wall}};
  for (const auto& ring : rings) {
    for (int j = 0; j < sectors; ++j) {
      const double a = kTurn * j / sectors;
      shape.vertices.emplace_back(ring[0] * std::cos(a), ring[0] * std::sin(a), ring[1]);
    }
  }
  const int below = static_cast<int>(shape.vertices.size()), above = below + 1;
  shape.vertices.emplace_back(0.0, 0.0, 0.0);
  shape.vertices.emplace_back(0.0, 0.0, wall);
  for (int j = 0; j < sectors; ++j) {
    const int j2 = (j + 1) % sectors;
    shape.faces.emplace_back(below, j2, j);
    for (int k = 0; k < 3; ++k) {
      const int a = k * sectors, b = a + sectors;
      shape.faces.emplace_back(a + j, a + j2, b + j2);
      shape.faces.emplace_back(a + j, b + j2, b + j);
    }
    shape.faces.emplace_back(above, 3 * sectors + j, 3 * sectors + j2);
  }
  return shape;
}

std::string MeshXml(const std::string& name, const MeshShape& shape,
                    const std::string& attributes) {
  std::string xml = "<mesh name='" + name + "' " + attributes + " vertex='";
  char text[96];
  for (const Vector3d& p : shape.vertices) {
    std::snprintf(text, sizeof text, "%.9g %.9g %.9g ", p.x(), p.y(), p.z());
    xml += text;
  }
  xml += "' face='";
  for (const Vector3i& f : shape.faces) {
    std::snprintf(text, sizeof text, "%d %d %d ", f.x(), f.y(), f.z());
    xml += text;
  }
  return xml + "'/>\n";
}

std::string MeshSceneXml(const MeshShape& fixed, const std::string& moving_geom,
                         const std::string& assets) {
  return "<mujoco><asset>" + MeshXml("fixed", fixed) + assets +
         "</asset><worldbody><body name='b2'><geom name='g2' type='mesh' mesh='fixed'/></body>"
         "<body name='b1'><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='.1 .1 .1'/>"
         "<geom name='g1' " +
         moving_geom + "/></body></worldbody></mujoco>";
}

SceneOptions Exact() {
  SceneOptions options;
  options.exact_mesh = true;
  return options;
}

Scene MeshScene(const MeshShape& fixed, const std::string& moving_geom, const MeshShape& moving) {
  return Scene::FromString(MeshSceneXml(fixed, moving_geom, MeshXml("moving", moving)), Exact());
}

std::vector<double> FreePose(const Vector3d& p, const Eigen::Quaterniond& turn) {
  return {p.x(), p.y(), p.z(), turn.w(), turn.x(), turn.y(), turn.z()};
}

bool InsideBySolidAngle(const MeshShape& shape, const Vector3d& x) {
  double angle = 0.0;
  for (const Vector3i& face : shape.faces) {
    const Vector3d a = shape.vertices[face[0]] - x, b = shape.vertices[face[1]] - x,
                   c = shape.vertices[face[2]] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(angle) > kTurn;
}

}  // namespace mjcf_pdg::test
