#include "collide/permanent.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "collide/contacts.h"

namespace mjcf_pdg {
namespace {

constexpr int kSamples = 200;
constexpr double kOverlap = 1e-5;  // what counts as one [scene's size]

double Between(Random& random, double low, double high) {
  return low + random.Uniform() * (high - low);
}

// Uniform inside limits; what has none turns all the way round, or slides and flies as far as the
// model is large.
VectorXd RandomConfiguration(const mjModel& m, Random& random) {
  VectorXd q = Eigen::Map<const VectorXd>(m.qpos0, m.nq);
  const double extent = m.stat.extent;
  for (int j = 0; j < m.njnt; ++j) {
    double* value = q.data() + m.jnt_qposadr[j];
    const int type = m.jnt_type[j];
    if (type == mjJNT_HINGE || type == mjJNT_SLIDE) {
      const double reach = type == mjJNT_HINGE ? mjPI : extent;
      const bool limited =
          m.jnt_limited[j] && std::isfinite(m.jnt_range[2 * j + 1] - m.jnt_range[2 * j]);
      *value = Between(random, limited ? m.jnt_range[2 * j] : *value - reach,
                       limited ? m.jnt_range[2 * j + 1] : *value + reach);
      continue;
    }
    if (type == mjJNT_FREE) {
      for (int k = 0; k < 3; ++k) value[k] += Between(random, -extent, extent);
      value += 3;
    }
    for (int k = 0; k < 4; ++k) value[k] = random.Normal();
    mju_normalize4(value);
    const double most = m.jnt_range[2 * j + 1];  // of a ball's rotation
    if (type == mjJNT_BALL && m.jnt_limited[j]) {
      mjtNum axis[3] = {value[1], value[2], value[3]};
      mju_normalize3(axis);
      mju_axisAngle2Quat(value, axis, Between(random, 0.0, most));
    }
  }
  return q;
}

// Leaves of `pairs` (indices) those that overlap at q.
void KeepOverlapping(ContactFinder& finder, const SceneTables& tables, const VectorXd& q,
                     std::vector<int>& pairs) {
  finder.Pose(q);
  std::vector<int> here;
  for (const NearPair& near : finder.Find(0.0)) {
    if (near.distance < -kOverlap * tables.size - tables.pairs[near.pair].allowed) {
      here.push_back(near.pair);
    }
  }
  std::erase_if(
      pairs, [&here](int pair) { return std::find(here.begin(), here.end(), pair) == here.end(); });
}

}  // namespace

std::vector<std::array<int, 2>> FindPermanentOverlaps(const SceneTables& tables) {
  const mjModel& m = *tables.model;
  ContactFinder finder(tables);
  std::vector<int> pairs;
  for (int k = 0; k < static_cast<int>(tables.pairs.size()); ++k) pairs.push_back(k);
  KeepOverlapping(finder, tables, Eigen::Map<const VectorXd>(m.qpos0, m.nq), pairs);
  for (int key = 0; key < m.nkey && !pairs.empty(); ++key) {
    const Eigen::Map<const VectorXd> q(m.key_qpos + static_cast<std::ptrdiff_t>(key) * m.nq, m.nq);
    KeepOverlapping(finder, tables, q, pairs);
  }
  Random random(0);
  for (int k = 0; k < kSamples && !pairs.empty(); ++k) {
    KeepOverlapping(finder, tables, RandomConfiguration(m, random), pairs);
  }
  std::vector<std::array<int, 2>> geoms;
  for (const int k : pairs) {
    const auto [low, high] = std::minmax(tables.pairs[k].geom1, tables.pairs[k].geom2);
    geoms.push_back({low, high});
  }
  std::sort(geoms.begin(), geoms.end());
  return geoms;
}

}  // namespace mjcf_pdg
