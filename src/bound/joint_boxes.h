// The least σ of all free configurations, bracketed by branch and bound: for problems of up to
// three degrees of freedom, where all of joint space can be looked at.
//
// A box is a set of displacements y from q_in, q = q_in ⊕ y, with a centre c and half widths h.
// With the sequential metric σ is a sum over joints (Eq. 19), and so is the least σ in a box. At
// q_in ⊕ c a pair of convex geoms overlaps by δ; no point moves by more than the motion bound λ(h)
// from there to anywhere in the box, and signed distances change no faster. Where δ - λ is more
// than may overlap, no configuration of the box is free. Every other box is halved, the one with
// the least σ first: the least σ of those that are left bounds that of all free configurations,
// from a solve's first box on. A centre that is free and nearer than what descents have found is
// told to them.
//
// Not in the source, which has no lower bound.
#ifndef MJCF_PDG_SRC_BOUND_JOINT_BOXES_H_
#define MJCF_PDG_SRC_BOUND_JOINT_BOXES_H_

#include <array>
#include <cstdint>
#include <vector>

#include "ccd/motion_bound.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

class JointBoxes {
 public:
  static constexpr int kMostDofs = 3;

  // Keeps a reference to the workspace, whose finder it poses.
  explicit JointBoxes(Workspace& work);

  // Begins anew for the workspace's problem, where a free configuration with σ = `known_sigma` is
  // known [m²]; at most `most_boxes` will be looked at. Returns false if nothing can be proven: too
  // many degrees of freedom, another metric or root link (terms of σ that are not a joint's), a
  // slide without mass, or pairs at q_in that are not convex.
  bool Begin(const std::vector<NearPair>& overlaps, double known_sigma, int most_boxes);

  // Goes on until every free configuration is proven to have `known_sigma` / kClosed or more, or
  // the boxes or the budget are spent. One query a box. Returns true as soon as a free
  // configuration is found whose σ is less than known_sigma / kClosed: nearer(), by the solver's
  // own distances.
  bool Search(double known_sigma);
  const VectorXd& nearer() const { return q_; }  // nq

  // Proven so far [m²].
  double sigma_lower_bound() const;

  // A bracket so narrow counts as closed: within it two answers count as the same.
  static constexpr double kClosed = 1.01;

 private:
  using Displacement = std::array<double, kMostDofs>;
  struct Box {
    double least_sigma = 0.0;  // [m²]
    Displacement center{}, half{};
    int halvings = 0;  // that made it
  };
  // A joint, and where its entries of y are.
  struct Axis {
    const NormTerm* term = nullptr;
    const JointEntry* joint = nullptr;
    int first = 0;
    double inertia = 0.0;  // slide: mass [kg]; hinge; ball: the largest principal one [kg m²]
    double low = 0.0, high = 0.0;  // hinge, slide: limits of y
  };

  bool CollectAxes(double known_sigma);
  void SetRange(double S, Axis& axis) const;
  double LeastSigma(const Box& box) const;
  double LeastOfBall(const Axis& axis, const Box& box) const;
  void PoseAtCenter(const Box& box);
  bool OutsideLimits(const Box& box) const;
  bool Counts(const KeptPair& pair) const;
  bool AllOverlap(bool& center_is_free, int& widest);
  int WidestBySigma(const Box& box) const;
  void Push(const Box& box);

  Workspace& work_;
  const SceneTables& tables_;
  MotionBound motion_;
  std::vector<int> body_pair_of_;  // by kept pair
  std::vector<Axis> axes_;
  std::vector<Box> heap_;   // by least σ, the least in front
  double pruned_at_ = 0.0;  // boxes of this σ or more are not kept [m²]
  int left_ = 0;            // boxes that may be looked at
  VectorXd y_, half_, q_, shares_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_JOINT_BOXES_H_
