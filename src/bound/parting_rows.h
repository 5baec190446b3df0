// What parting a pair asks of a motion: linear inequalities, each for a pair of points and a cap of
// directions, and how the way of these points is bent.
//
// Part of normals_tree.h, whose symbols these are.
#ifndef MJCF_PDG_SRC_BOUND_PARTING_ROWS_H_
#define MJCF_PDG_SRC_BOUND_PARTING_ROWS_H_

#include <span>
#include <vector>

#include "bound/farthest_motion.h"
#include "bound/lower_bound_chain.h"
#include "bound/lower_bound_pair.h"

namespace mjcf_pdg {

// A point a of geom 1 and b of geom 2 of a pair: for all unit vectors of a cap, what is left of
// their overlap after a motion x is at most t - g·x + e |x|, plus what bends.
struct PartingRow {
  Vector3d a, b;
  double t = 0.0, t_middle = 0.0;  // over all of the cap; in its middle [m]
  double e = 0.0;                  // how much g changes within the cap
  double gg = 0.0;                 // |g|²
  int values = 0;                  // where g begins, which has an entry per column of the pair
  int bends = 0;                   // where the row's bends begin, one per mover of the pair
  int crosses = 0;                 // where its cross terms begin, one per two movers of a geom
};

// The movers of some pairs have one x; all rows are kept here.
class PartingRows {
 public:
  // Begins anew with these movers, which must stay. Only motions with |x| <= `length` are of
  // interest. Makes room for so many pairs.
  void Begin(std::span<const Mover> movers, double length, int pairs);
  // Adds a pair, which must stay, and whose movers are own1 (of geom 1) and own2. Returns its
  // number.
  int AddPair(const PairProblem& pair, std::span<const int> own1, std::span<const int> own2);
  // Makes room for so many rows of the pairs there are, in memory that is kept.
  void Reserve(int rows, int middles);
  // Adds a row for all unit vectors within eps of n. Returns its number.
  int AddRow(int pair, const Vector3d& n, double eps, const Vector3d& a, const Vector3d& b);
  // The same without e and bends, for n alone.
  int AddMiddle(int pair, const Vector3d& n, const Vector3d& a, const Vector3d& b);

  // Drops the row that was added last.
  void DropLast();

  int num_rows() const { return static_cast<int>(rows_.size()); }
  int num_pairs() const { return static_cast<int>(pairs_.size()); }
  const PairProblem& problem(int pair) const { return *pairs_[pair].problem; }
  const PartingRow& row(int k) const { return rows_[k]; }
  int dims() const { return dims_; }
  const std::vector<Coordinates>& coordinates() const { return coordinates_; }

  double Dot(int pair, const PartingRow& row, const Eigen::VectorXd& x) const;
  void AddTo(int pair, const PartingRow& row, double factor, Eigen::VectorXd& x) const;
  // The points of the two geoms that x leaves deepest along n, to first order.
  std::pair<Vector3d, Vector3d> Deepest(int pair, const Vector3d& n,
                                        const Eigen::VectorXd& x) const;

  // Adds `factor` times Q of a row: the turns' own terms to `bends`, one per mover, and the cross
  // terms, by their size, to both halves of `crosses`, movers × movers.
  void AddBends(int pair, const PartingRow& row, double factor, std::span<BendBlock> bends,
                Eigen::Map<Eigen::MatrixXd>& crosses) const;
  // ½ xᵀQx of a row at most, where `lengths` are those of x, one per mover.
  double BendAlong(int pair, const PartingRow& row, const Eigen::VectorXd& lengths,
                   const Eigen::VectorXd& x) const;

 private:
  struct Pair {
    const PairProblem* problem = nullptr;
    int movers = 0, split = 0, end = 0;  // of geom 1: from movers to split; of geom 2: to end
    int columns = 0, size = 0;           // of g
  };
  // A mover that some pair has.
  struct Used {
    const Mover* mover = nullptr;
    Matrix3d factor = Matrix3d::Zero();  // F with C = F Fᵀ, where it turns about any axis
  };
  // Of one mover of a row, which turns by w: B of ½ wᵀBw = ½ n·(w×(w×r)) at most.
  using Bend = Matrix3d;

  int Use(int mover);
  void AddGradient(const Pair& pair, const Vector3d& n, PartingRow& row);
  void AddBend(const Used& used, const Vector3d& n, double wide, const Vector3d& p);
  void AddCrosses(int begin, int end, const Vector3d& n, double wide, const Vector3d& p);
  Vector3d Turn(int begin, int end, const Eigen::VectorXd& x) const;
  // Calls visit(i, j, size) for the cross terms of a row.
  template <typename Visit>
  void ForEachCross(const Pair& pair, const PartingRow& row, const Visit& visit) const;

  std::span<const Mover> all_;
  double length_ = 0.0;
  std::vector<Pair> pairs_;
  std::vector<int> movers_;   // of the pairs, pair after pair: numbers of used_
  std::vector<int> columns_;  // entries of x, pair after pair
  std::vector<int> number_;   // per mover of all_; -1: not used
  std::vector<Used> used_;
  std::vector<Coordinates> coordinates_;  // one for each of used_
  int dims_ = 0;
  std::vector<PartingRow> rows_;
  std::vector<double> values_;
  std::vector<Bend> bends_;
  std::vector<double> crosses_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_PARTING_ROWS_H_
