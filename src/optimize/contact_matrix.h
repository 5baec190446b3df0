// The contact matrix C and its right-hand side: rows C dq + gap >= 0.
//
// Source: Tang & Kim, Eq. 22-23: row i is n_iᵀ (J_2 - J_1), from MuJoCo's motion axes.
// Differs from it:
//   1. Rows are kept for every pair within a margin, not only touching ones; `gap` is what is left.
//   2. Joint limits are rows, not truncated afterwards.
#ifndef MJCF_PDG_SRC_OPTIMIZE_CONTACT_MATRIX_H_
#define MJCF_PDG_SRC_OPTIMIZE_CONTACT_MATRIX_H_

#include <vector>

#include "base/support.h"
#include "collide/contacts.h"
#include "mjcf_pdg/observer.h"

namespace mjcf_pdg {

// What a row is about: a kept pair, or the limit of a joint (its id).
struct RowSource {
  int pair = -1;
  int joint = -1;
};

// m rows over n movable degrees of freedom. Its memory only grows.
struct ContactRows {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> C;  // capacity × n
  VectorXd gap;                    // capacity; signed slack of each row [m]
  std::vector<RowSource> sources;  // capacity
  int m = 0;

  void Clear(int n);
  // Makes room for `rows` rows of n entries, and forgets all rows.
  void Reserve(int rows, int n);
  // Appends a zero row and returns its index.
  int Append(double gap_value, RowSource source = {});
};

// out(j) = nᵀ (J_2 - J_1)_j, the rate of n · (p2 - p1) per unit of dq_j; joints above both bodies
// give exact zeros. `out` has n entries.
void ContactRow(const SceneTables& tables, const PosedModel& posed, int pair, const Vector3d& p1_W,
                const Vector3d& p2_W, const Vector3d& n_W, Eigen::Ref<Eigen::RowVectorXd> out);

// Where a row may be other than 0. Of a pair's, at the joints from each body up to the first that
// is above both, whose columns are in one range for each; of a limit's, at the joint; else
// anywhere.
Support RowSupport(const SceneTables& tables, const RowSource& source);

// Which joint limits get a row, and in which unit.
struct LimitRowOptions {
  double turn;   // limits of hinges and balls get one if they are nearer than this [rad]
  double slide;  // limits of slides, if nearer than this [m]
  double
      radius;  // the gap of a turn is the arc at this distance, so that all rows are in metres [m]
};
// Appends a row for every joint limit that is near enough at q (nq).
void AppendLimitRows(const SceneTables& tables, const VectorXd& q, const LimitRowOptions& reach,
                     ContactRows& rows);

// Appends the rows as an Observer sees them; `lambda` has a multiplier per row [m].
void AppendObserved(const SceneTables& tables, const ContactRows& rows, const VectorXd& lambda,
                    std::vector<ObservedRow>& observed);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_CONTACT_MATRIX_H_
