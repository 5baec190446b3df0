// The proven side of the bracket: no free configuration has a smaller σ.
//
// Source: the bound from moment arms at q_in (an overlap of depth δ cannot be undone unless points
// move by δ), made directional. The derivation is at the head of lower_bound.cc.
#ifndef MJCF_PDG_SRC_BOUND_LOWER_BOUND_H_
#define MJCF_PDG_SRC_BOUND_LOWER_BOUND_H_

#include <span>
#include <vector>

#include "bound/lower_bound_chain.h"
#include "bound/lower_bound_input.h"
#include "bound/lower_bound_pair.h"
#include "bound/lower_bound_terrain.h"
#include "bound/normals_tree.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

// Keeps its memory between calls.
class LowerBound {
 public:
  LowerBound();

  // A lower bound of σ over all free configurations [m²], >= 0.
  double Sigma(const LowerBoundInput& input);

  // After Sigma, of the same problem: a bound that is no lower, and may be much higher, where free
  // configurations are known and the nearest of them has `known_sigma` [m²]. `nodes_per_pair`:
  // effort (normals_tree.h).
  double Tighten(double known_sigma, int nodes_per_pair, const BudgetMeter* budget);

  // The same for the workspace's problem; its finder is posed at q_in. `cells`: as max_cells.
  double Sigma(const Workspace& work, const std::vector<NearPair>& overlaps, int cells) {
    const Problem& problem = work.problem();
    return Sigma({problem.tables, work.norm, work.finder.posed(), overlaps, problem.required,
                  problem.options.metric, problem.options.tolerance, cells, &work.budget});
  }

 private:
  // A part of concerned_.
  struct Range {
    int begin = 0, end = 0;
  };
  struct Overlap {
    PairProblem problem;
    Range movers1, movers2;  // of the chains of the two geoms, one behind the other
    Range movers() const { return {movers1.begin, movers2.end}; }
    // Of a height field; then `hope` is that of a plane until a solid inside the field is chosen.
    const NearPair* on_terrain = nullptr;
    bool has_solid = false;  // such a solid has been chosen
  };
  // What is proven of one pair or joint, and the movers it concerns.
  struct Claim {
    double S = 0.0;  // [kg m²]
    Range movers;
  };

  void AddOverlap(const LowerBoundInput& in, const NearPair& near);
  // False if none promises anything.
  bool ChooseInscribed(const LowerBoundInput& in, const NearPair& near, PairProblem& pair);
  void ClaimOverlaps(const LowerBoundInput& in);
  void ClaimLimits(const LowerBoundInput& in);
  double SumOfDisjoint();
  void Group(int first, int group);

  std::span<const int> In(Range range) const {
    return std::span(concerned_).subspan(range.begin, range.end - range.begin);
  }

  double mass_ = 0.0;   // M
  double sigma_ = 0.0;  // of the last Sigma
  Chains chains_;
  NormalsTree tree_;
  MoverPool pool_;  // of the chains of all overlaps
  std::vector<Overlap> overlaps_;
  std::vector<Claim> claims_;
  std::vector<int> concerned_;      // movers, range after range
  std::vector<int> path1_, path2_;  // of the bodies of one pair
  std::vector<int> order_, used_;
  std::vector<int> group_, pending_;  // per overlap: the first of its group; scratch of Group
  std::vector<InscribedSolid> inscribed_;
  std::vector<DirectionCell> heap_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LOWER_BOUND_H_
