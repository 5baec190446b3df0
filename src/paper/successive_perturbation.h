// Successive perturbation: a free configuration by moving one colliding link after the other.
//
// Source: Tang & Kim, Sec. 5.1, Alg. 1. A link is a body with movable joints, those are its inboard
// joints. Colliding links are perturbed from the terminal ones towards the base; a link succeeds
// when it and all its descendants are free.
// Differs from it:
//   1. Line 9's "> 2" means two or more children, as its text and Fig. 5 say.
//   2. A joint is tried over its whole range, not "some small range", in steps that grow with the
//      distance; the tries of all joints of a link are taken nearest first in the object norm.
//   3. Preprocessing (colliding links with several children, the root first) asks for less: the
//      link must come clear of all but its own descendants, whose turn comes with Alg. 1.
//   4. Several moving trees: each has its own root.
#ifndef MJCF_PDG_SRC_PAPER_SUCCESSIVE_PERTURBATION_H_
#define MJCF_PDG_SRC_PAPER_SUCCESSIVE_PERTURBATION_H_

#include <vector>

#include "problem/workspace.h"

namespace mjcf_pdg {

// The tree T of the links that can move; several trees of the model make a forest.
struct LinkTree {
  struct Link {
    int body = 0;
    int parent = -1;  // index into links; -1: a root
    int depth = 0;
    std::vector<int> children;
    std::vector<int> joints;  // indices into SceneTables::joints, in MJCF order
  };

  explicit LinkTree(const SceneTables& tables);
  // `link` is `ancestor` or one of its descendants; false for link -1.
  bool IsBelow(int link, int ancestor) const;

  std::vector<Link> links;        // parents before children
  std::vector<int> link_of_body;  // nbody; a body without movable joints belongs to the link that
                                  // carries it, -1 if none does
};

// Pairs of links that overlap beyond what is required and accepted. Link -1: what cannot move.
struct LinkPair {
  int link1 = -1, link2 = -1;
};

struct PerturbationOptions {
  int steps = 18;          // tries per dof and direction
  double growth = 1.3;     // of each step over the one before
  int max_queries = 4000;  // collision queries of one run
};

struct PerturbationResult {
  bool free = false;
  VectorXd q;         // free, or what was reached
  int perturbed = 0;  // links moved
  int queries = 0;
};

// One per thread.
class SuccessivePerturbation {
 public:
  explicit SuccessivePerturbation(Workspace& work);

  // From work.problem().q_in; limits exceeded there are left at once.
  PerturbationResult Run(const PerturbationOptions& options = {});

  // One query. The pairs are valid until the next.
  const std::vector<LinkPair>& Overlaps(const VectorXd& q);
  // No link overlaps another link of its own tree.
  bool SelfCollisionFree(const VectorXd& q);

  const LinkTree& tree() const { return tree_; }

 private:
  // What has to come free when a link is perturbed.
  enum class Scope { kSubtree, kLinkWithoutDescendants };
  struct Try {
    VectorXd q;
    double sigma = 0.0;
  };

  bool Preprocess();
  bool RunAlgorithm1();
  bool Perturb(int link, Scope scope);
  bool Succeeds(int link, Scope scope, const VectorXd& q);
  void AppendTries(const JointEntry& joint);
  void AppendLinearTries(const JointEntry& joint);
  void AppendTurns(const JointEntry& joint);
  void AppendTry(VectorXd q);
  double Offset(int step, double range) const;
  std::vector<int> CollidingLinks();

  const Problem& problem_;
  Workspace& work_;
  LinkTree tree_;
  PerturbationOptions options_;
  std::vector<LinkPair> overlaps_;
  std::vector<Try> tries_;
  PerturbationResult result_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PAPER_SUCCESSIVE_PERTURBATION_H_
