// A way round what is between where the follower stands and the optimum that it is to reach: two
// trees of free configurations, one from either end, that grow by a few queries in a tick until
// they meet.
//
// Source: Kuffner & LaValle, RRT-Connect (ICRA 2000); both trees go on greedily until they are
// blocked.
// Differs from it: both ends move while the trees grow. Where they have been is free, and becomes a
// part of the way. Edges are looked at once every stride; whoever goes along asks in every tick.
#ifndef MJCF_PDG_SRC_TRACK_DETOUR_H_
#define MJCF_PDG_SRC_TRACK_DETOUR_H_

#include <array>
#include <vector>

#include "base/random.h"
#include "ccd/ccdg.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

class Detour {
 public:
  // A joint moves by `max_step` in a tick [rad or m]; may be infinite. `proves`: edges are proven
  // free by CCDg instead of looked at.
  Detour(Workspace& work, double max_step, bool proves);

  // Forgets trees and way.
  void Reset();
  // The same where the way turned out to be blocked between the poses that were looked at.
  void Blocked();
  // Both ends (nq), in every tick: trees begin there, or, if there are some, the way goes on to
  // there. Forgets what is known if an end has jumped.
  void Ends(const VectorXd& from, const VectorXd& to);
  // The same of the way's end alone, for whoever goes along it.
  void EndAt(const VectorXd& to);
  // Lets the trees grow by at most `queries` queries. Returns whether they have met: there is a
  // way.
  bool Search(int queries);
  // Makes a way to the node of least σ that the first tree has; false if that is not below `sigma`.
  bool EndsNearer(double sigma);
  // Tries to leave points of the way out, by at most `queries` queries.
  void Shorten(int queries);

  bool planted() const { return planted_; }
  bool found() const { return found_; }
  // The trees are full: there may be no way.
  bool failed() const;
  // The point of the way to go to from `at`: the last one that is within a tick's reach and those
  // before it are dropped. The way must not be at its end.
  const VectorXd& Next(const VectorXd& at);
  // Where the way ends.
  const VectorXd& end() const { return way_[end_ - 1]; }
  // How many ticks the way takes, and the mean of σ from the workspace's q_in along it [m²].
  double Ticks(double& sigma);

 private:
  struct Tree {
    MatrixXd q;  // nq × nodes
    std::vector<int> parent;
    int size = 0;
  };

  void BeginAt(const VectorXd& from);
  void Plant(int tree, const VectorXd& q);
  int Add(int tree, const VectorXd& q, int parent);
  int Nearest(int tree, const VectorXd& q) const;
  void Aim(int tree, int node, const VectorXd& target);
  bool Grow();
  bool Leads(const VectorXd& from);
  void Meet();
  void AimNext();
  void Sample();
  void Join(int first, int second);
  void Append(const Eigen::Ref<const VectorXd>& q);
  double Distance(const VectorXd& from, const VectorXd& to);

  const Problem& problem_;
  Workspace& work_;
  double max_step_, stride_ = 0.0;  // [rad or m]
  double fineness_ = 1.0;           // of the stride [1]
  bool proves_;
  Ccdg ccd_;
  CcdOptions ccd_options_;
  BudgetMeter deadline_;
  int asked_ = 0;  // queries of the present Search or Shorten
  std::array<Tree, 2> trees_;
  std::array<std::vector<VectorXd>, 2> trails_;  // of either end since its tree was planted
  std::array<int, 2> trail_sizes_ = {};
  bool planted_ = false, found_ = false;
  bool partial_ = false;        // the way that was found does not lead to the other end
  int nearest_ = 0;             // the node of the first tree that had the least σ when it grew
  double nearest_sigma_ = 0.0;  // [m²]
  Random random_;
  // The present growth: tree, its node, and the configuration that it goes to.
  int tree_ = 0, node_ = 0, samples_ = 0;
  bool connecting_ = false;  // it goes to a node of the other tree,
  int other_ = 0;            // to this one
  VectorXd target_;

  std::vector<VectorXd> way_;  // its points are way_[begin_] to way_[end_ - 1]
  int begin_ = 0, end_ = 0;
  // Of Shorten: the points that are to be joined, -1 if there are none, and the poses between them
  // that have been looked at.
  int first_ = -1, second_ = 0, looked_ = 0;
  VectorXd dq_, q_, node_q_;
};

// How far the joint that moves farthest moves [rad or m]; a free joint's translation and rotation,
// and a ball's rotation, count by their length.
double LargestStep(const SceneTables& tables, const VectorXd& dq);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_DETOUR_H_
