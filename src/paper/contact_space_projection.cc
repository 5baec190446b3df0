#include "paper/contact_space_projection.h"

#include <algorithm>

namespace mjcf_pdg {

ContactSpaceProjection::ContactSpaceProjection(const SceneTables& tables, Ccdg& ccd)
    : tables_(tables),
      ccd_(ccd),
      moves_(tables.joints.size()),
      removed_(tables.model->nbody),
      dq_(tables.n),
      step_(tables.n),
      sample_(tables.model->nq) {
  result_.q.resize(tables.model->nq);
  result_.pairs.reserve(tables.pairs.size());
  const mjModel& m = *tables.model;
  std::vector<int> depth(m.nbody, 0);
  for (int body = 1; body < m.nbody; ++body) depth[body] = depth[m.body_parentid[body]] + 1;
  for (int j = 0; j < static_cast<int>(tables.joints.size()); ++j) base_to_terminal_.push_back(j);
  std::stable_sort(base_to_terminal_.begin(), base_to_terminal_.end(), [&](int a, int b) {
    return depth[tables.joints[a].body] < depth[tables.joints[b].body];
  });
}

const ProjectionResult& ContactSpaceProjection::GeneralizedCcd(const VectorXd& q_f,
                                                               const VectorXd& q_in,
                                                               const ProjectionOptions& options,
                                                               const VectorXd* required) {
  Start(q_f, options, required);
  RunGeneralizedCcd(q_in);
  return result_;
}

const ProjectionResult& ContactSpaceProjection::GreedyOptimization(const VectorXd& q_f,
                                                                   const VectorXd& q_in,
                                                                   const ProjectionOptions& options,
                                                                   const VectorXd* required) {
  Start(q_f, options, required);
  RunGreedyOptimization(q_in);
  return result_;
}

const ProjectionResult& ContactSpaceProjection::Project(const VectorXd& q_f, const VectorXd& q_in,
                                                        const ProjectionOptions& options,
                                                        const VectorXd* required) {
  Start(q_f, options, required);
  RunGeneralizedCcd(q_in);
  if (result_.start_free) RunGreedyOptimization(q_in);
  return result_;
}

void ContactSpaceProjection::Start(const VectorXd& q_f, const ProjectionOptions& options,
                                   const VectorXd* required) {
  options_ = options;
  required_ = required;
  result_.q = q_f;
  result_.start_free = result_.certified = result_.complete = true;
  result_.pairs.clear();
  result_.motions = result_.jumps = result_.poses = 0;
  const bool pairs = required && required->size() > 0;
  largest_required_ = pairs ? std::max(0.0, required->maxCoeff()) : 0.0;
}

void ContactSpaceProjection::RunGeneralizedCcd(const VectorXd& q_in) {
  std::fill(moves_.begin(), moves_.end(), 1);
  std::fill(removed_.begin(), removed_.end(), 0);
  RotateFirst(q_in);
  // Each motion but the last takes a link or a joint out of L.
  while (result_.complete && result_.start_free) {
    const CcdOutcome outcome = MoveFlagged(q_in);
    if (outcome != CcdOutcome::kContact && outcome != CcdOutcome::kLimit) return;
  }
}

// About the centre of mass, which stays where it is.
void ContactSpaceProjection::RotateFirst(const VectorXd& q_in) {
  if (tables_.joints.size() != 1 || tables_.joints[0].type != mjJNT_FREE) return;
  const JointEntry& joint = tables_.joints[0];
  const int quat = joint.qadr + 3;
  if (result_.q.segment<4>(quat) == q_in.segment<4>(quat)) return;
  ccd_.finder().Pose(result_.q);
  const mjData& d = *ccd_.finder().posed().data();
  const Vector3d com_W = AsVector(d.subtree_com + 3 * joint.body);
  const Vector3d com_B =
      AsMatrix(d.xmat + 9 * joint.body).transpose() * (com_W - AsVector(d.xpos + 3 * joint.body));
  sample_ = result_.q;
  sample_.segment<4>(quat) = q_in.segment<4>(quat);
  sample_.segment<3>(joint.qadr) += QuatAt(result_.q, quat) * com_B - QuatAt(sample_, quat) * com_B;
  if (!FreeSample(sample_)) return;
  result_.q = sample_;
  ++result_.jumps;
}

void ContactSpaceProjection::RunGreedyOptimization(const VectorXd& q_in) {
  std::fill(removed_.begin(), removed_.end(), 0);
  for (const int joint : base_to_terminal_) {
    if (!result_.complete || !result_.start_free) return;
    std::fill(moves_.begin(), moves_.end(), 0);
    moves_[joint] = 1;
    MoveFlagged(q_in);
  }
}

// dq_ from result_.q to q_in for the joints in L, zero for the others. False if none has to move.
bool ContactSpaceProjection::FlaggedDifference(const VectorXd& q_in) {
  Difference(tables_, result_.q, q_in, dq_);
  for (std::size_t j = 0; j < moves_.size(); ++j) {
    const JointEntry& joint = tables_.joints[j];
    if (!moves_[j]) dq_.segment(joint.col, joint.ndof).setZero();
  }
  return !dq_.isZero(0.0);
}

// CCDrg: the reversed path, from q_in back to result_.q, is sampled; result_.q becomes the first
// free sample. Returns false if there is none.
bool ContactSpaceProjection::JumpToFreeSample() {
  for (int k = options_.reverse_samples; k > 0; --k) {
    const BudgetMeter* budget = options_.ccd.budget;
    if (result_.poses >= options_.ccd.max_poses) return false;
    if (budget && budget->Spent(ccd_.finder().queries())) return false;
    step_ = (static_cast<double>(k) / options_.reverse_samples) * dq_;
    Integrate(tables_, result_.q, step_, sample_);
    if (!FreeSample(sample_)) continue;
    result_.q = sample_;
    ++result_.jumps;
    return true;
  }
  return false;
}

bool ContactSpaceProjection::FreeSample(const VectorXd& q) {
  for (const JointEntry& joint : tables_.joints) {  // balls alone can leave their limit on the way
    if (joint.type != mjJNT_BALL || !joint.limited || !moves_[&joint - tables_.joints.data()]) {
      continue;
    }
    if (BallAngle(q.data() + joint.qadr) > joint.hi) return false;
  }
  ++result_.poses;
  ccd_.finder().Pose(q);
  const std::vector<NearPair>& near = ccd_.finder().Find(largest_required_, Depths::kSkipped);
  return std::none_of(near.begin(), near.end(), [this](const NearPair& n) {
    const KeptPair& pair = tables_.pairs[n.pair];
    const double required = required_ ? (*required_)[n.pair] : -pair.allowed;
    return pair.moves && n.distance < required - options_.ccd.tolerance;
  });
}

// CCD(L, q, q_in) from result_.q on, or from CCDrg's sample: the joints in L move, the others stay.
// Those that were stopped leave L.
CcdOutcome ContactSpaceProjection::MoveFlagged(const VectorXd& q_in) {
  if (!FlaggedDifference(q_in)) return CcdOutcome::kFree;
  if (options_.reverse_samples > 0 && JumpToFreeSample() && !FlaggedDifference(q_in)) {
    return CcdOutcome::kFree;
  }
  CcdOptions options = options_.ccd;
  options.max_poses -= result_.poses;
  const CcdResult& ccd = ccd_.Move({result_.q, dq_, required_}, options);
  ++result_.motions;
  result_.poses += ccd.poses;
  result_.certified = result_.certified && ccd.certified;
  result_.complete = ccd.outcome != CcdOutcome::kBudget;
  result_.start_free = ccd.outcome != CcdOutcome::kStartInCollision;
  result_.q = ccd.q;
  for (const int pair : ccd.pairs) {
    if (std::find(result_.pairs.begin(), result_.pairs.end(), pair) == result_.pairs.end()) {
      result_.pairs.push_back(pair);
    }
  }
  if (ccd.outcome == CcdOutcome::kLimit) moves_[ccd.joint] = 0;
  RemoveLinks(ccd);
  return ccd.outcome;
}

// L.remove(N): the links in contact and their ancestors.
void ContactSpaceProjection::RemoveLinks(const CcdResult& ccd) {
  const mjModel& m = *tables_.model;
  for (const int pair : ccd.pairs) {
    for (const int geom : {tables_.pairs[pair].geom1, tables_.pairs[pair].geom2}) {
      for (int body = m.geom_bodyid[geom]; body != 0; body = m.body_parentid[body]) {
        removed_[body] = 1;
      }
    }
  }
  for (std::size_t j = 0; j < moves_.size(); ++j) {
    if (removed_[tables_.joints[j].body]) moves_[j] = 0;
  }
}

}  // namespace mjcf_pdg
