// Exact meshes: a start for models of several links, which parts one overlapping pair after the
// other. Not in the paper, whose Eq. 20 moves whole trees.
//
// The depth of two overlapping thin-walled meshes says little about the way out. So ways are tried:
// the joints between the two bodies move as the object norm finds cheapest for parting them in a
// given direction, as far as it takes until they are apart; of several directions the one that ends
// with the least σ is taken.
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

  // Starts from `q`, which must be inside its limits. The result may still overlap, or overlap
  // elsewhere. Returns nothing if no pair of exact meshes overlaps, or none can be parted.
  std::optional<VectorXd> Start(const VectorXd& q);

 private:
  std::vector<NearPair> ExactOverlaps(const VectorXd& q);
  bool Overlaps(int pair, const VectorXd& q);
  std::optional<VectorXd> Part(const VectorXd& q, const NearPair& overlap);
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
