// How far a solve goes, by effort: the one place where effort is decided.
#ifndef MJCF_PDG_SRC_PROBLEM_EFFORT_H_
#define MJCF_PDG_SRC_PROBLEM_EFFORT_H_

#include <limits>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

// The numbers of default and max were chosen on 7700 random problems of nine robots, by success
// first, then σ, then time (bench/README.md, Agreement).
struct EffortPlan {
  // The search ends when so many independent starts have ended at the best answer: fewer where that
  // is near what is proven (stopping_rule.h).
  int agree_near_proven = 3, agree = 6;
  int queries = 800;       // collision queries after which no further start is made
  double box_tests = 9e3;  // ... and per dof, of triangle meshes, unless the answer is very far
  double evaluations = 1000.0;  // ... and estimated time since something was free [evaluations]
  int blind = 20;               // noisy starts while nothing is free, then as many anywhere
  bool follows = true;          // exact meshes: a frame may trust the last one's answer
  bool polishes_meshes = true;  // a fifth of a fast solve of exact meshes, for 1e-3 of σ
  int bound_cells = 100;  // pieces of the sphere of directions for the lower bound; 0: moment arms
};

inline EffortPlan PlanFor(Effort effort) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  switch (effort) {
    case Effort::kFast:
      return {.agree_near_proven = 1,
              .agree = 1,
              .queries = 0,
              .evaluations = kInfinity,
              .polishes_meshes = false,
              .bound_cells = 0};
    case Effort::kDefault:
      return {};
    case Effort::kMax:
      return {.agree_near_proven = 8,
              .agree = 12,
              .queries = 4000,
              .box_tests = kInfinity,
              .evaluations = kInfinity,
              .blind = 80,
              .follows = false,
              .bound_cells = 2000};
  }
  return {};
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_EFFORT_H_
