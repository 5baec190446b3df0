// One step of the local optimization: the contacts and the object norm linearized at a
// configuration, and the dq that minimizes the norm there.
//
// Source: Tang & Kim, Sec. 5.3: minimize ½‖r + J dq‖² subject to C dq + gap >= 0 (Eq. 24-30).
// Differs from it:
//   1. Rows are elastic: a contact that cannot be held costs `penalty` per metre, so that contacts
//      in conflict have an answer. Limits of joints and tendons are far stiffer.
//   2. Witness points of earlier steps add rows (witness_memory.h).
//   3. Equality constraints that hold stay so to first order: beside the step that corrects them,
//      it is sought in the null space of their Jacobian. Where they do not hold and their rows
//      depend on each other, what is left may be 1e-3 (a weld, measured); later steps mend it.
//   4. Levenberg-Marquardt damping, and a trust radius in the units of the object norm.
//   5. Where many degrees of freedom move, in several kinematic trees or along one, and no
//      constraint joins them, rows are packed: of each only the columns of the joints between its
//      two bodies are looked at (base/support.h).
//   6. There the LCP begins with the forces of the step before, too (force_memory.h).
#ifndef MJCF_PDG_SRC_OPTIMIZE_LINEARIZED_STEP_H_
#define MJCF_PDG_SRC_OPTIMIZE_LINEARIZED_STEP_H_

#include <cstdint>
#include <vector>

#include "base/block_cholesky.h"
#include "optimize/contact_matrix.h"
#include "optimize/force_memory.h"
#include "optimize/lcp.h"
#include "optimize/witness_memory.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

// Which rows a linearization gets, and what they ask for.
struct RowOptions {
  // Remembered witness points that are farther beyond the clearance than this, along the normal,
  // get no row [m].
  double margin = 0.0;
  double aim = 0.0;            // overlap that every row still allows [m]
  double safety_margin = 0.0;  // kept beyond that in rows of exact meshes [m]
};

// How a step is held back.
struct StepOptions {
  double scale = 1.0;         // of the lengths of a large scene, see Descent in local_optimization
  double penalty = 0.0;       // μ, of contacts [m]
  double damping = 0.0;       // added to H: so much for a slide; nothing where it is left out
  double trust_radius = 0.0;  // largest ‖J dq‖ [m]
};

class LinearizedStep {
 public:
  explicit LinearizedStep(Workspace& work);

  // Forgets the witness points and the forces of earlier steps.
  void Clear() {
    memory_.Clear(problem_.tables.pairs.size());
    rows_.Clear(problem_.tables.n);
  }

  // The rows of `near`, the pairs close to q, of joint limits, and the norm's Jacobian. The finder
  // must be posed at q.
  void Linearize(const VectorXd& q, const std::vector<NearPair>& near, const RowOptions& options);

  // Solves for dq at the present linearization; returns its length ‖J dq‖ [m].
  double Solve(const StepOptions& options);

  const VectorXd& dq() const { return dq_; }
  // What the linearization says of where dq leads: σ [m²], and Σ over the contact rows of the
  // overlap beyond the aim [m].
  double sigma() const { return sigma_; }
  double violation() const { return violation_; }
  // The same σ before the step was cut to its trust radius.
  double uncut_sigma() const { return uncut_sigma_; }
  // What the damping D took of dq's cost, dqᵀ D dq over ‖J dq‖²: the share, about, by which dq is
  // shorter than without it [1].
  double DampingShare() const;
  // ‖J dq‖ of the tree that moves farthest, as if there were no other: over the root of its share
  // of the mass [m].
  double LargestLength() const;
  bool several_trees() const { return trees_.size() > 1; }
  // The largest λ of a contact [m]; 0 without contacts.
  double LargestForce() const;
  // ‖J dq‖² of any dq: what it costs by the linearized norm [m²].
  double SquaredLength(const VectorXd& dq);

  // The rows and multipliers of the last Solve.
  void AppendObserved(std::vector<ObservedRow>& observed) const {
    mjcf_pdg::AppendObserved(problem_.tables, rows_, lambda_, observed);
  }

  std::int64_t lcp_steps() const { return lcp_steps_; }

 private:
  void AppendContactRows(const NearPair& near, const RowOptions& options);
  void AppendTendonRows();
  void AddDamping();
  double DampingOf(const JointEntry& joint, int k) const;
  void SolveLcp(const StepOptions& options);
  int FindTrees();
  int FindSupports();
  void FillWhitened(Eigen::Ref<MatrixXd> G);
  void HoldEqualities(Eigen::Ref<MatrixXd> G, Eigen::Ref<VectorXd> b);
  double LargestTurn() const;  // of dq [rad]
  void Predict();

  const Problem& problem_;
  Workspace& work_;
  const std::size_t contacts_;  // pairs that get rows: the nearest, if there are more
  WitnessMemory memory_;
  ForceMemory forces_;
  ContactRows rows_;
  int contact_rows_ =
      0;  // rows_ begins with these; the rows after them are limits of joints and tendons
  ActiveSetLcp lcp_;
  std::int64_t lcp_steps_ = 0;
  double sigma_ = 0.0, violation_ = 0.0, uncut_sigma_ = 0.0, squared_length_ = 0.0;
  double damping_ = 0.0;  // of the last Solve

  // The kinematic trees that move. Where only one does, or H has blocks that span several: empty.
  struct Tree {
    ColumnRange columns;  // in dq
    double mass = 0.0;    // as a share of all that moves [1]
  };
  std::vector<Tree> trees_;
  std::vector<int> tree_of_;       // per tree of the model, an index into trees_; -1: none
  bool packs_ = false;             // rows may be packed: no constraint or block of H joins joints
  std::vector<Support> supports_;  // of the rows of C; empty: they are not packed

  // Scratch. Of what has an entry or a column per row, those past the rows in use mean nothing.
  std::vector<const NearPair*> nearest_;
  VectorXd moved_, r_, z_, dq_, y_;
  VectorXd lambda_, b_, bounds_, slack_;  // per row
  VectorXd whitened_;                     // the columns of G, packed or not
  MatrixXd J_, H_;
  BlockCholesky whitening_;
  // Of the equality constraints, whitened: the step that makes them hold, and its decomposition.
  VectorXd held_;
  MatrixXd K_, range_;
  Eigen::ColPivHouseholderQR<MatrixXd> range_of_K_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_LINEARIZED_STEP_H_
