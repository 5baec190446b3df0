#include "gradient/parted_constraints.h"

#include <algorithm>

#include "collide/convex/support_points.h"

namespace mjcf_pdg {
namespace {

using Kind = ConstraintRow::Kind;

// Pieces this far behind the farthest may come to touch the plane [the geom's bounding radius].
constexpr double kSlab = 0.05;
// A ball's limit counts from this angle on: at 0 there is no axis [rad].
constexpr double kLeastAngle = 1e-3;

void SetTangents(PartingPlane& plane) {
  plane.tangents.col(0) = plane.n_G.unitOrthogonal();
  plane.tangents.col(1) = plane.n_G.cross(plane.tangents.col(0));
}

}  // namespace

bool PartingPlane::AtRoundGeom() const {
  const auto round = [](const SupportPiece& piece) {
    return piece.kind != SupportPiece::Kind::kPoint || piece.radius > 0.0;
  };
  return std::any_of(pieces1.begin(), pieces1.end(), round) ||
         std::any_of(pieces2.begin(), pieces2.end(), round);
}

SceneTables WithAllJoints(const SceneTables& tables) {
  const mjModel& m = *tables.model;
  SceneTables all = tables;
  all.joints.clear();
  all.n = static_cast<int>(m.nv);
  std::size_t movable = 0;
  for (int j = 0; j < m.njnt; ++j) {
    JointEntry joint;
    if (movable < tables.joints.size() && tables.joints[movable].id == j) {
      joint = tables.joints[movable++];
    } else {
      joint.id = j;
      joint.type = m.jnt_type[j];
      joint.body = m.jnt_bodyid[j];
      joint.qadr = m.jnt_qposadr[j];
      joint.vadr = m.jnt_dofadr[j];
      joint.ndof = joint.type == mjJNT_FREE ? 6 : joint.type == mjJNT_BALL ? 3 : 1;
    }
    joint.col = joint.vadr;
    all.joints.push_back(joint);
  }
  for (int dof = 0; dof < all.n; ++dof) all.column_of_dof[dof] = dof;
  return all;
}

PartedConstraints::PartedConstraints(const Problem& problem, const SceneTables& all)
    : problem_(problem), all_(all), posed_(&all.query_model), equality_(all) {}

void PartedConstraints::SetMocap(const MocapPoses& poses) {
  posed_.SetMocap(poses);
  equality_.SetMocap(poses);
}

bool PartedConstraints::Begin(const VectorXd& q, const std::vector<NearPair>& near) {
  planes_.clear();
  unknowns_ = 0;
  posed_.Pose(q);
  bool smooth = true;
  for (const NearPair& one : near) {
    const KeptPair& pair = all_.pairs[one.pair];
    if (!pair.moves) continue;
    const bool plane = all_.model->geom_type[pair.geom1] == mjGEOM_PLANE;
    const bool known = PartedByOnePlane(pair.kind) && all_.support->Knows(pair.geom2) &&
                       (plane || all_.support->Knows(pair.geom1));
    if (known) AppendPlane(one);
    smooth = smooth && known;
  }
  return smooth;
}

void PartedConstraints::AppendPlane(const NearPair& near) {
  const mjData& d = *posed_.data();
  const int geom1 = all_.pairs[near.pair].geom1;
  PartingPlane plane;
  plane.pair = near.pair;
  if (all_.model->geom_type[geom1] != mjGEOM_PLANE) {
    const Matrix3d R = AsMatrix(d.geom_xmat + 9 * geom1);
    plane.n_G = (R.transpose() * near.n_W).normalized();
    plane.offset = near.n_W.dot(near.p1_W - AsVector(d.geom_xpos + 3 * geom1));
    plane.col = unknowns_;
    unknowns_ += 3;
  }
  SetTangents(plane);
  planes_.push_back(plane);
}

void PartedConstraints::ChooseRows(const VectorXd& q) {
  rows_.clear();
  for (std::size_t j = 0; j < all_.joints.size(); ++j) {
    const JointEntry& joint = all_.joints[j];
    if (!joint.limited) continue;
    const int id = static_cast<int>(j);
    const bool ball = joint.type == mjJNT_BALL;
    if (ball && BallAngle(q.data() + joint.qadr) < kLeastAngle) continue;
    rows_.push_back({Kind::kUpperLimit, 2LL * id, id, 0});
    if (!ball) rows_.push_back({Kind::kLowerLimit, 2LL * id + 1, id, 0});
  }
  equality_.Linearize(q);
  const int equalities = equality_.any() ? static_cast<int>(equality_.residual().size()) : 0;
  for (int k = 0; k < equalities; ++k) rows_.push_back({Kind::kEquality, (1LL << 60) + k, k, 0});
  const TendonLimits& tendons = equality_.tendon_limits();
  for (int k = 0; k < tendons.slack().size(); ++k) {
    if (tendons.scale()[k] > 0.0) rows_.push_back({Kind::kTendon, (1LL << 61) + k, k, 0});
  }
  posed_.Pose(q);
  for (std::size_t p = 0; p < planes_.size(); ++p) ChooseRowsOf(static_cast<int>(p));
}

void PartedConstraints::ChooseRowsOf(int index) {
  PartingPlane& plane = planes_[index];
  const KeptPair& pair = all_.pairs[plane.pair];
  const auto slab = [this](int geom) { return kSlab * all_.model->geom_rbound[geom]; };
  if (plane.col >= 0) FindPieces(all_, pair.geom1, plane.n_G, slab(pair.geom1), plane.pieces1);
  const Vector3d u = -(Relative(pair).R.transpose() * plane.n_G);
  FindPieces(all_, pair.geom2, u, slab(pair.geom2), plane.pieces2);
  for (const Kind side : {Kind::kGeom1, Kind::kGeom2}) {
    const auto& pieces = side == Kind::kGeom1 ? plane.pieces1 : plane.pieces2;
    const std::int64_t key = (2LL * (plane.pair + 1) + (side == Kind::kGeom2)) << 28;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      rows_.push_back({side, key + pieces[k].id, index, static_cast<int>(k)});
    }
  }
}

void PartedConstraints::Evaluate(const VectorXd& q, const VectorXd* lambda) {
  values_.Clear(all_.n);
  by_plane_.setZero(size(), unknowns_);
  if (equality_.any()) equality_.Linearize(q);
  posed_.Pose(q);
  for (int k = 0; k < size(); ++k) {
    values_.Append(0.0);
    if (lambda && (*lambda)[k] == 0.0) continue;
    const ConstraintRow& row = rows_[k];
    if (row.kind == Kind::kEquality) {
      values_.gap[k] = equality_.residual()[row.of];
      values_.C.row(k) = equality_.jacobian().row(row.of);
    } else if (row.kind == Kind::kTendon) {
      const TendonLimits& tendons = equality_.tendon_limits();
      values_.gap[k] = tendons.scale()[row.of] * tendons.slack()[row.of];
      values_.C.row(k) = tendons.scale()[row.of] * tendons.jacobian().row(row.of);
    } else if (row.IsPiece()) {
      EvaluatePiece(row, k);
    } else {
      EvaluateLimit(row, q, k);
    }
  }
}

// Turns count as arcs at the scene's size, so that all rows are lengths.
void PartedConstraints::EvaluateLimit(const ConstraintRow& row, const VectorXd& q, int k) {
  const JointEntry& joint = all_.joints[row.of];
  const double arm = joint.type == mjJNT_SLIDE ? 1.0 : all_.size;
  if (joint.type == mjJNT_BALL) {
    // The angle grows by axis · w, w the body-frame rotation.
    const Eigen::Quaterniond quat = QuatAt(q, joint.qadr);
    values_.gap[k] = arm * (joint.hi - BallAngle(q.data() + joint.qadr));
    const Vector3d axis = quat.vec().normalized() * (quat.w() < 0.0 ? -1.0 : 1.0);
    values_.C.row(k).segment<3>(joint.col) = -arm * axis.transpose();
    return;
  }
  const bool upper = row.kind == Kind::kUpperLimit;
  values_.gap[k] = arm * (upper ? joint.hi - q[joint.qadr] : q[joint.qadr] - joint.lo);
  values_.C(k, joint.col) = upper ? -arm : arm;
}

RelativePose PartedConstraints::Relative(const KeptPair& pair) const {
  const mjData& d = *posed_.data();
  const Matrix3d R1 = AsMatrix(d.geom_xmat + 9 * pair.geom1);
  return {R1.transpose() * AsMatrix(d.geom_xmat + 9 * pair.geom2),
          R1.transpose() *
              (AsVector(d.geom_xpos + 3 * pair.geom2) - AsVector(d.geom_xpos + 3 * pair.geom1))};
}

// The farthest point of a piece stays the farthest to first order: its own motion along the geom
// is not in the derivatives.
void PartedConstraints::EvaluatePiece(const ConstraintRow& row, int k) {
  const PartingPlane& plane = planes_[row.of];
  const KeptPair& pair = all_.pairs[plane.pair];
  Vector3d by_n;  // of the row, in the frame of geom 1
  if (row.kind == Kind::kGeom1) {
    const SupportValue value = mjcf_pdg::Evaluate(plane.pieces1[row.piece], plane.n_G);
    values_.gap[k] = plane.offset - value.h;
    by_n = -value.x_G;
  } else {
    const RelativePose pose = Relative(pair);
    const Vector3d u = -(pose.R.transpose() * plane.n_G);
    by_n = pose * mjcf_pdg::Evaluate(plane.pieces2[row.piece], u).x_G;
    const double required = problem_.required[plane.pair] - problem_.tolerances.aim;
    values_.gap[k] = plane.n_G.dot(by_n) - plane.offset - required;
    const mjData& d = *posed_.data();
    const Matrix3d R1 = AsMatrix(d.geom_xmat + 9 * pair.geom1);
    const Vector3d x_W = AsVector(d.geom_xpos + 3 * pair.geom1) + R1 * by_n;
    ContactRow(all_, posed_, plane.pair, x_W, x_W, R1 * plane.n_G, values_.C.row(k));
  }
  if (plane.col < 0) return;
  by_plane_.row(k).segment<2>(plane.col) = by_n.transpose() * plane.tangents;
  by_plane_(k, plane.col + 2) = row.kind == Kind::kGeom1 ? 1.0 : -1.0;
}

// With n(a) = (n + T a)/‖n + T a‖, the second derivative of f(n) by a is Tᵀ f'' T - (f' · n) I.
void PartedConstraints::AddPlaneCurvature(const VectorXd& lambda, MatrixXd& second) const {
  for (int k = 0; k < size(); ++k) {
    const ConstraintRow& row = rows_[k];
    if (!row.IsPiece() || lambda[k] == 0.0 || planes_[row.of].col < 0) continue;
    const PartingPlane& plane = planes_[row.of];
    Matrix3d by_nn;  // minus the row's second derivative by n
    Vector3d by_n;
    if (row.kind == Kind::kGeom1) {
      const SupportValue value = mjcf_pdg::Evaluate(plane.pieces1[row.piece], plane.n_G);
      by_nn = value.second_G;
      by_n = -value.x_G;
    } else {
      const RelativePose pose = Relative(all_.pairs[plane.pair]);
      const Vector3d u = -(pose.R.transpose() * plane.n_G);
      const SupportValue value = mjcf_pdg::Evaluate(plane.pieces2[row.piece], u);
      by_nn = pose.R * value.second_G * pose.R.transpose();
      by_n = pose * value.x_G;
    }
    second.block<2, 2>(plane.col, plane.col) +=
        lambda[k] * (plane.tangents.transpose() * by_nn * plane.tangents +
                     by_n.dot(plane.n_G) * Eigen::Matrix2d::Identity());
  }
}

void PartedConstraints::MarkHeld(const VectorXd& lambda) {
  for (PartingPlane& plane : planes_) plane.held = false;
  for (int k = 0; k < size(); ++k) {
    if (rows_[k].IsPiece() && lambda[k] != 0.0) planes_[rows_[k].of].held = true;
  }
}

void PartedConstraints::MovePlanes(const VectorXd& step) {
  for (PartingPlane& plane : planes_) {
    if (plane.col < 0) continue;
    plane.n_G = (plane.n_G + plane.tangents * step.segment<2>(plane.col)).normalized();
    plane.offset += step[plane.col + 2];
    SetTangents(plane);
  }
}

}  // namespace mjcf_pdg
