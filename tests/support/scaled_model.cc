#include "tests/support/scaled_model.h"

#include <cstddef>

namespace mjcf_pdg::test {
namespace {

template <typename Number>
void Scale(Number* values, std::size_t count, double scale) {
  for (std::size_t k = 0; k < count; ++k) values[k] = static_cast<Number>(scale * values[k]);
}

// Scales the lengths in a qpos: slides and the positions of free joints.
void ScaleQpos(const mjModel& m, double* q, double scale) {
  for (int j = 0; j < m.njnt; ++j) {
    if (m.jnt_type[j] == mjJNT_SLIDE) Scale(q + m.jnt_qposadr[j], 1, scale);
    if (m.jnt_type[j] == mjJNT_FREE) Scale(q + m.jnt_qposadr[j], 3, scale);
  }
}

}  // namespace

ModelPtr Scaled(const mjModel& model, double scale) {
  ModelPtr copy(mj_copyModel(nullptr, &model));
  mjModel& m = *copy;
  const auto bodies = static_cast<std::size_t>(m.nbody), geoms = static_cast<std::size_t>(m.ngeom);
  const auto joints = static_cast<std::size_t>(m.njnt), meshes = static_cast<std::size_t>(m.nmesh);
  const auto pairs = static_cast<std::size_t>(m.npair), keys = static_cast<std::size_t>(m.nkey);
  Scale(m.body_pos, 3 * bodies, scale);
  Scale(m.body_ipos, 3 * bodies, scale);
  Scale(m.body_inertia, 3 * bodies, scale * scale);
  Scale(m.body_margin, bodies, scale);
  Scale(m.geom_pos, 3 * geoms, scale);
  Scale(m.geom_size, 3 * geoms, scale);
  Scale(m.geom_aabb, 6 * geoms, scale);
  Scale(m.geom_rbound, geoms, scale);
  Scale(m.geom_margin, geoms, scale);
  Scale(m.geom_gap, geoms, scale);
  Scale(m.bvh_aabb, 6 * static_cast<std::size_t>(m.nbvhstatic), scale);
  Scale(m.jnt_pos, 3 * joints, scale);
  for (std::size_t j = 0; j < joints; ++j) {
    if (m.jnt_type[j] == mjJNT_SLIDE) Scale(m.jnt_range + 2 * j, 2, scale);
  }
  Scale(m.mesh_vert, 3 * static_cast<std::size_t>(m.nmeshvert), scale);
  Scale(m.mesh_pos, 3 * meshes, scale);
  Scale(m.mesh_scale, 3 * meshes, scale);
  Scale(m.hfield_size, 4 * static_cast<std::size_t>(m.nhfield), scale);
  Scale(m.pair_margin, pairs, scale);
  Scale(m.pair_gap, pairs, scale);
  ScaleQpos(m, m.qpos0, scale);
  ScaleQpos(m, m.qpos_spring, scale);
  for (std::size_t k = 0; k < keys; ++k) ScaleQpos(m, m.key_qpos + k * m.nq, scale);
  return copy;
}

std::vector<double> Scaled(const mjModel& model, std::vector<double> q, double scale) {
  ScaleQpos(model, q.data(), scale);
  return q;
}

}  // namespace mjcf_pdg::test
