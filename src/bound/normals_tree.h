// What parting several overlapping pairs at once costs at least: branch and bound over the
// directions of separation of all of them.
//
// Part of lower_bound.h; symbols are those of the derivation at the head of lower_bound.cc. Each
// pair k that is free has a unit normal n_k, for which (2) holds with any of its points. The part
// of (2) that is linear in the movers' slides and turns is g_k·x, with one x for all pairs and
// |x|² <= S. So for all rows of all pairs and all weights λ >= 0
//
//   Σ λ_k t_k <= g·x + ½ xᵀQx + E √S,   g = Σ λ_k g_k,   Q = Σ λ_k Q_k,   E = Σ λ_k e_k,       (3)
//
// where n_k may be anywhere in a cap of angle ε around the n that g_k is of: t_k is the least
// overlap over the cap, and e_k = 2 sin(ε/2) √λmax(G_k). Q_k is of ½ n·(w×(w×r)), as it is, and of
// the cross terms of (1) by their size. The largest of the right-hand side within √S says which S
// (3) rules out (farthest_motion.h). Any λ proves something; ours are those of the nearest x of the
// polyhedron of all rows, by coordinate ascent on its dual.
//
// A node of the tree has a cap for some of the pairs. The node that proves least is branched: the
// cap that costs most is cut in four, or a pair that x leaves overlapping is added, with the caps
// that cover the sphere. What the least node proves holds for all motions.
#ifndef MJCF_PDG_SRC_BOUND_NORMALS_TREE_H_
#define MJCF_PDG_SRC_BOUND_NORMALS_TREE_H_

#include <array>
#include <span>
#include <vector>

#include "bound/parting_rows.h"
#include "problem/budget.h"

namespace mjcf_pdg {

class NormalsTree {
 public:
  static constexpr int kMostTogether = 16;

  // Begins anew, where motions with √S of `known` part all pairs. Pairs are added to rows() then,
  // at most kMostTogether, those that promise most alone.
  void Begin(std::span<const Mover> movers, double known);
  PartingRows& rows() { return rows_; }

  // √S of all motions that part all pairs is at least this, which is a little less than what is
  // known at most. Looks at so many nodes at most.
  double Search(int nodes, const BudgetMeter* budget);

 private:
  static constexpr int kMostPairs = 8;  // of a node
  static constexpr int kMostRows = 6;   // of a cap
  struct Cap {
    DirectionCell cell;
    int pair = 0;
    Vector3d n;
    double eps = 0.0, root = 0.0;  // √S that it proves alone
    int parts = -1;                // the first of four; -1: not cut yet
    int size = 0;
    std::array<int, kMostRows> rows = {};
  };
  struct Node {
    double root = 0.0;  // √S
    bool solved = false;
    int size = 0;
    std::array<int, kMostPairs> caps = {};
    bool operator<(const Node& other) const { return root > other.root; }  // least on top
  };
  // A row of the node that is looked at.
  struct Term {
    int pair = 0, row = 0, at = 0;  // at: which cap of the node
    double lambda = 0.0, bend = 0.0;
  };

  // What √S could gain by branching a node in one way, and which cap or pair that is of; -1: none.
  struct Gain {
    double by = 0.0;
    int of = -1;
  };

  void Reserve();
  void AddFirstCaps(int pair);
  void AddCap(int pair, const DirectionCell& cell, const Vector3d& n, double eps);
  void AddFirstRows(Cap& cap);
  bool AddDeepest(const Node& node);
  void Cut(int cap);
  void Push(const Node& node);

  void Collect(const Node& node);
  void Weigh(double length);
  void SetLengths();
  void Shape(double guess);
  double Prove(const Node& node, int rounds);

  const PartingRow& Middle(int pair, int direction);
  double Overlapping(int pair, double enough);
  Gain ByCutting(const Node& node) const;
  Gain ByAdding(const Node& node, double by_cutting);
  bool Branch(const Node& node);

  PartingRows rows_;
  double known_ = 0.0;  // √S
  std::vector<Cap> caps_;
  std::vector<PairProblem::Ease> ease_;  // per pair
  std::vector<int> first_caps_;          // per pair; -1: not made yet
  std::vector<int> middles_;             // per pair and direction: a row, -1: not made yet
  std::vector<int> order_;               // per pair, the directions as they are asked
  std::vector<Node> heap_;
  std::vector<Term> terms_;
  Eigen::VectorXd x_, farthest_;                // Σ λ_k g_k; where (3) is largest
  Eigen::VectorXd lengths_, profile_, shared_;  // of farthest_, by mover; y; Q y
  std::vector<BendBlock> bends_;                // Q
  Eigen::VectorXd crosses_;                     // the sizes of its cross terms, movers × movers
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_NORMALS_TREE_H_
