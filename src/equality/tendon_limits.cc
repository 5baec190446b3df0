#include "equality/tendon_limits.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {

TendonLimits::TendonLimits(const SceneTables& tables) : tables_(tables) {
  for (int t = 0; t < static_cast<int>(tables.held_tendons.size()); ++t) {
    if (tables.held_tendons[t]) tendons_.push_back(t);
  }
  const Eigen::Index limits = 2 * static_cast<Eigen::Index>(tendons_.size());
  slack_.setZero(limits);
  scale_.setZero(limits);
  jacobian_.setZero(limits, tables.n);
}

void TendonLimits::Linearize(const mjData& d) {
  const mjModel& m = *tables_.model;
  jacobian_.setZero();
  for (std::size_t k = 0; k < tendons_.size(); ++k) {
    const int tendon = tendons_[k], begin = m.ten_J_rowadr[tendon];
    const Eigen::Index row = 2 * static_cast<Eigen::Index>(k);
    slack_[row] = d.ten_length[tendon] - m.tendon_range[2 * tendon];
    slack_[row + 1] = m.tendon_range[2 * tendon + 1] - d.ten_length[tendon];
    for (int at = begin; at < begin + m.ten_J_rownnz[tendon]; ++at) {
      const int col = tables_.column_of_dof[m.ten_J_colind[at]];
      if (col < 0) continue;
      jacobian_(row, col) = d.ten_J[at];
      jacobian_(row + 1, col) = -d.ten_J[at];
    }
    double fastest = 0.0;
    for (const JointEntry& joint : tables_.joints) {
      for (int i = 0; i < joint.ndof; ++i) {
        const double rate = std::abs(jacobian_(row, joint.col + i));
        fastest = std::max(fastest, joint.Slides(i) ? rate : rate / tables_.size);
      }
    }
    scale_[row] = scale_[row + 1] = fastest > 0.0 ? 1.0 / fastest : 0.0;
  }
}

double TendonLimits::Excess() const { return any() ? std::max(0.0, -slack_.minCoeff()) : 0.0; }

}  // namespace mjcf_pdg
