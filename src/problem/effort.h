// How far a solve goes, by effort: the one place where effort is decided.
#ifndef MJCF_PDG_SRC_PROBLEM_EFFORT_H_
#define MJCF_PDG_SRC_PROBLEM_EFFORT_H_

#include <limits>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

// The numbers of default and max were chosen on random problems of nine robots, by success
// first, then σ, then time (bench/README.md, Agreement).
struct EffortPlan {
  // The search ends when so many independent starts have ended at the best answer as this many
  // times √(σ/bound), or when `agree` have (search/stopping_rule.h).
  double agree_over_bound = 2.0;
  int agree = 7;
  // Collision queries after which no further start is made, over the kinematic trees that move.
  int queries = 800;
  // Exact meshes: tests of bounding boxes per degree of freedom after which no further start is
  // made, unless the answer is very far.
  double box_tests = 9e3;
  // Estimated time after which no further start is made, from when something free was found on.
  double evaluations = 1000.0;
  int blind = 20;       // noisy starts while nothing free is known, and then starts anywhere
  bool follows = true;  // exact meshes: a frame of a trajectory may end with the last one's answer
  // Whether answers of exact meshes are polished: it gains 1e-3 of σ for a fifth of a fast solve.
  bool polishes_meshes = true;
  int bound_cells =
      100;  // cells of the sphere of directions for the lower bound; 0: moment arms only
  // Nodes of the tree of normals (bound/normals_tree.h) for each pair that is parted, where the
  // bound is asked for. On 120 problems √(bound/σ) is 0.59 in the median without, 0.72, 0.74 and
  // 0.75 with 10, 15 and 20, of 2 to 4 µs each. 60 whatever the pairs gave no more than 10, and
  // took longer than the search where two boxes overlap.
  int bound_nodes = 10;
  // Where no more degrees of freedom than this move, so many boxes of joint space are looked at
  // (bound/joint_boxes.h). On 666 random problems of one to three all of one are closed by 1,650,
  // half of them by 33, which is what starts take that prove nothing; all of two by 27,000, and 98
  // % of three by 200,000. A box takes 1 to 5 µs.
  int box_dofs = 1;
  int boxes = 2000;
};

inline EffortPlan PlanFor(Effort effort) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  switch (effort) {
    case Effort::kFast:
      return {.agree = 1,
              .queries = 0,
              .evaluations = kInfinity,
              .polishes_meshes = false,
              .bound_cells = 0,
              .bound_nodes = 0,
              .box_dofs = 0};
    case Effort::kDefault:
      return {};
    case Effort::kMax:
      return {.agree_over_bound = 4.0,
              .agree = 12,
              .queries = 4000,
              .box_tests = kInfinity,
              .evaluations = kInfinity,
              .blind = 80,
              .follows = false,
              .bound_cells = 2000,
              .bound_nodes = 400,
              .box_dofs = 3,
              .boxes = 200'000};
  }
  return {};
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_EFFORT_H_
