// Contact-space projection: from a free configuration q_f as near as possible to q_in.
//
// Source: Tang & Kim, Sec. 5.2, Alg. 2. A link is a body with movable joints, its inboard joints.
// Differs from it:
//   1. Every CCD is certified, or says that it is not (ccdg.h).
//   2. A joint that reaches its limit stops alone; links in contact stop with their ancestors.
//   3. Reverse projection (CCDrg) finds the first free sample of the reversed path as the paper
//      does; CCD from there, towards q_in, then finds the contact. The jump to the sample is no
//      motion, so `certified` speaks of the motions around it.
//   4. A limited ball joint stays a quaternion here; samples outside its limit are not free.
// A rigid model, one free joint, goes as in Sec. 3.2: first it is rotated to the orientation at
// q_in, where that is free (a jump, as in 3), and then translated; else full CCD.
#ifndef MJCF_PDG_SRC_PAPER_CONTACT_SPACE_PROJECTION_H_
#define MJCF_PDG_SRC_PAPER_CONTACT_SPACE_PROJECTION_H_

#include <vector>

#include "ccd/ccdg.h"

namespace mjcf_pdg {

struct ProjectionOptions {
  CcdOptions ccd;           // max_poses is the budget of the whole projection
  int reverse_samples = 0;  // static checks per CCDrg; 0: CCDg alone
};

struct ProjectionResult {
  VectorXd q;              // free if q_f was
  bool start_free = true;  // false: the start overlaps (in `pairs`), and so does q
  bool certified = true;   // every motion on the way was proven free
  bool complete = true;    // false: the budget ran out
  std::vector<int> pairs;  // that stopped something, in the order found, without repetition
  int motions = 0;         // CCD calls
  int jumps = 0;           // to free samples nearer to q_in: CCDrg, or a rigid model's rotation
  int poses = 0;
};

// One per thread. Results are valid until the next call. `required` as in CcdMotion.
class ContactSpaceProjection {
 public:
  ContactSpaceProjection(const SceneTables& tables, Ccdg& ccd);

  // Lines 1-6: all links move towards q_in; links in contact and their ancestors drop out of L, the
  // rest moves on until L is empty.
  const ProjectionResult& GeneralizedCcd(const VectorXd& q_f, const VectorXd& q_in,
                                         const ProjectionOptions& options = {},
                                         const VectorXd* required = nullptr);

  // Lines 7-14: one joint after the other, base to terminal, moves alone towards q_in until
  // contact.
  const ProjectionResult& GreedyOptimization(const VectorXd& q_f, const VectorXd& q_in,
                                             const ProjectionOptions& options = {},
                                             const VectorXd* required = nullptr);

  // Both, one after the other.
  const ProjectionResult& Project(const VectorXd& q_f, const VectorXd& q_in,
                                  const ProjectionOptions& options = {},
                                  const VectorXd* required = nullptr);

 private:
  void Start(const VectorXd& q_f, const ProjectionOptions& options, const VectorXd* required);
  void RotateFirst(const VectorXd& q_in);
  void RunGeneralizedCcd(const VectorXd& q_in);
  void RunGreedyOptimization(const VectorXd& q_in);
  CcdOutcome MoveFlagged(const VectorXd& q_in);
  bool FlaggedDifference(const VectorXd& q_in);
  bool JumpToFreeSample();
  bool FreeSample(const VectorXd& q);
  void RemoveLinks(const CcdResult& ccd);

  const SceneTables& tables_;
  Ccdg& ccd_;
  ProjectionOptions options_;
  const VectorXd* required_ = nullptr;
  std::vector<char> moves_;            // joints: still in L
  std::vector<char> removed_;          // bodies: in contact or above such a link
  std::vector<int> base_to_terminal_;  // joints by depth in the tree
  double largest_required_ = 0.0;      // [m]
  VectorXd dq_, step_, sample_;
  ProjectionResult result_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PAPER_CONTACT_SPACE_PROJECTION_H_
