#include "plan/contact_slide.h"

#include <Eigen/Cholesky>

#include "base/tuning.h"

namespace mjcf_pdg {

ContactSlide::ContactSlide(const SceneTables& tables, const ConfigurationSpace& space,
                           const MocapPoses& mocap, const Options& options)
    : tables_(tables),
      space_(space),
      mocap_(mocap),
      options_(options),
      finder_(tables_, options.clearance),
      norm_(tables_, Metric::kSequential) {
  finder_.SetMocap(mocap_);
  Forget();
}

void ContactSlide::Forget() { touched_.Clear(tables_.pairs.size()); }

const VectorXd& ContactSlide::Go(const VectorXd& q, const VectorXd& to) {
  finder_.Forget();
  dq_.resize(tables_.n);
  Difference(tables_, q, to, dq_);
  Step(q);
  if (!options_.careful) return end_;
  from_ = end_;
  dq_.setZero();
  Step(from_);
  return end_;
}

// end_ := q ⊕ dq, where dq is the nearest to dq_ that the contacts admit.
void ContactSlide::Step(const VectorXd& q) {
  // Pairs nearer than this are rows, a tenth of a link [m].
  const double margin = 0.1 * tables_.size;
  finder_.Pose(q);
  rows_.Clear(tables_.n);
  for (const NearPair& near : finder_.Find(margin)) AppendRows(near, margin);
  if (rows_.m > 0) HoldContacts(q);
  Integrate(tables_, q, dq_, end_);
  ClampToLimits(tables_, end_);
  if (!space_.Project(end_)) end_ = q;
}

// The row of the pair's witness points, and those of others that are as near along its normal.
void ContactSlide::AppendRows(const NearPair& near, double margin) {
  AppendRow(near, near.p1_W, near.p2_W, near.distance);
  if (!options_.careful || !PartedByOnePlane(near.kind)) return;
  const double merge = tuning::step::kSamePoint * tables_.size;
  touched_.ForEach(tables_, finder_.posed(), near, merge,
                   [&](const Vector3d& p1_W, const Vector3d& p2_W) {
                     const double distance = near.n_W.dot(p2_W - p1_W);
                     if (distance < margin) AppendRow(near, p1_W, p2_W, distance);
                   });
  touched_.Add(tables_, finder_.posed(), near, merge);
}

void ContactSlide::AppendRow(const NearPair& near, const Vector3d& p1_W, const Vector3d& p2_W,
                             double distance) {
  const double required = tables_.pairs[near.pair].Required(options_.clearance);
  const int row = rows_.Append(distance - required);
  ContactRow(tables_, finder_.posed(), near.pair, p1_W, p2_W, near.n_W, rows_.C.row(row));
}

// dq_ += H⁻¹ Cᵀ λ.
void ContactSlide::HoldContacts(const VectorXd& q) {
  const int n = tables_.n, m = rows_.m;
  norm_.SetReference(q, mocap_);
  norm_.Linearize(q, r_, J_);
  H_.setZero(n, n);
  norm_.InnerProduct(J_, H_);
  const Eigen::LLT<MatrixXd> llt(H_);
  const MatrixXd C = rows_.C.topRows(m);
  const MatrixXd G = llt.matrixL().solve(C.transpose());
  const VectorXd b = -(C * dq_) - rows_.gap.head(m);
  const VectorXd mu = VectorXd::Constant(m, 1e9);  // rows are hard
  VectorXd lambda = VectorXd::Zero(m);
  lcp_.Reserve(n, m);
  lcp_.Solve(G, b, mu, {}, lambda);
  dq_ += llt.matrixU().solve(G * lambda);
}

}  // namespace mjcf_pdg
