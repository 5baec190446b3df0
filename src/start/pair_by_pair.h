// Exact meshes: a start for models of several links, one overlapping pair parted after the other.
//
// How deep two thin-walled meshes overlap says little of the way out. So it is tried: the joints
// between the two bodies move along the cheapest motion, by the object norm, that parts them in a
// given direction, up to where they are apart; of several directions the one with the least σ
// counts. Not of the paper, whose Eq. 20 moves whole trees.
#ifndef MJCF_PDG_SRC_START_PAIR_BY_PAIR_H_
#define MJCF_PDG_SRC_START_PAIR_BY_PAIR_H_

#include <optional>
#include <vector>

#include "base/block_cholesky.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

class PairByPair {
 public:
  explicit PairByPair(Workspace& work) : problem_(work.problem()), work_(work) {}

  // From `q`, inside its limits. The result may overlap still, or anew. None if no pair of exact
  // meshes overlaps, or none can be parted.
  std::optional<VectorXd> Start(const VectorXd& q);

 private:
  std::vector<NearPair> ExactOverlaps(const VectorXd& q);
  bool Overlaps(int pair, const VectorXd& q);
  std::optional<VectorXd> WayOut(const VectorXd& q, const NearPair& overlap);
  bool Motion(const VectorXd& q, const NearPair& overlap, const Vector3d& n_W, VectorXd& dq);
  std::optional<double> PartedAt(const VectorXd& q, int pair, const VectorXd& dq,
                                 double largest_sigma);
  void MoveTo(const VectorXd& q, const VectorXd& dq, double t);

  const Problem& problem_;
  Workspace& work_;
  std::vector<NearPair> scratch_;
  VectorXd trial_;
  MatrixXd J_, H_;
  BlockCholesky whitening_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_START_PAIR_BY_PAIR_H_
