#include "verify/limits.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg::verify {
namespace {

// How far a joint may be outside its range in a configuration that is free [rad or m].
constexpr double kRangeTolerance = 1e-6;

}  // namespace

double CheckLimits(const mjModel& m, std::span<const double> q, std::vector<LimitExcess>& outside) {
  double largest = 0.0;
  for (int j = 0; j < m.njnt; ++j) {
    const int type = m.jnt_type[j];
    if (!m.jnt_limited[j] || type == mjJNT_FREE) continue;
    const double* value = q.data() + m.jnt_qposadr[j];
    const double low = m.jnt_range[2 * j], high = m.jnt_range[2 * j + 1];
    double excess = 0.0;
    if (type == mjJNT_BALL) {
      const double sine = std::hypot(value[1], value[2], value[3]);
      excess = 2.0 * std::atan2(sine, std::abs(value[0])) - high;
    } else {
      excess = std::max(low - *value, *value - high);
    }
    largest = std::max(largest, excess);
    if (excess > kRangeTolerance) outside.push_back({j, excess});
  }
  return largest;
}

}  // namespace mjcf_pdg::verify
