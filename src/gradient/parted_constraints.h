// The constraints of the nearest free configuration as smooth functions: limits of joints and
// tendons, equality constraints, and that a plane parts the two geoms of each near pair.
//
// The distance of two convex geoms has kinks wherever the nearest features change, and a vertex
// that lies on an edge has no normal. "A plane parts them" has neither. With n and c the plane's
// normal and offset in the frame of geom 1, h the support function of a geom (support_pieces.h),
// and d the distance that the pair must keep,
//
//   c - h_1(n) >= 0    and    n · x_2 - h_2(-n) - c - d >= 0
//
// for each piece of h near its maximum; n and c are unknowns beside q. A vertex on a face, two
// crossing edges, a face on a face are then only different sets of active rows. A pair whose geom 1
// is a plane keeps that plane.
#ifndef MJCF_PDG_SRC_GRADIENT_PARTED_CONSTRAINTS_H_
#define MJCF_PDG_SRC_GRADIENT_PARTED_CONSTRAINTS_H_

#include <cstdint>
#include <span>
#include <vector>

#include "base/relative_pose.h"
#include "equality/equality_constraints.h"
#include "gradient/support_pieces.h"
#include "optimize/contact_matrix.h"
#include "problem/problem.h"

namespace mjcf_pdg {

// The tables of a scene in which every joint may move: dq has MuJoCo's nv entries. Only what is
// movable in `tables` has limits.
SceneTables WithAllJoints(const SceneTables& tables);

// A plane between the geoms of a kept pair, in the frame of geom 1, with the pieces that may touch
// it.
struct PartingPlane {
  int pair = 0;
  Vector3d n_G = Vector3d::UnitZ();
  double offset = 0.0;                   // c [m]
  Eigen::Matrix<double, 3, 2> tangents;  // a basis normal to n_G
  std::vector<SupportPiece> pieces1, pieces2;
  int col = -1;  // of its three unknowns (tilts about the tangents [rad], c) in by_plane; -1: given
  bool held = false;  // some row of it is active

  // Nothing says where between the geoms it is.
  bool Idle() const { return col >= 0 && !held; }
  bool AtRoundGeom() const;
};

// What a row is about. Rows of the same key are the same constraint.
struct ConstraintRow {
  enum class Kind { kLowerLimit, kUpperLimit, kTendon, kEquality, kGeom1, kGeom2 };
  Kind kind = Kind::kLowerLimit;
  std::int64_t key = 0;
  int of = 0;     // its joint (of `all`), tendon limit, residual or plane
  int piece = 0;  // of kGeom1 and kGeom2: of pieces1 or pieces2

  bool IsPiece() const { return kind == Kind::kGeom1 || kind == Kind::kGeom2; }
};

class PartedConstraints {
 public:
  // References are kept. `all` is WithAllJoints(problem.tables).
  PartedConstraints(const Problem& problem, const SceneTables& all);

  void SetMocap(const MocapPoses& poses);
  void SetActive(std::span<const mjtBool> active) { equality_.SetActive(active); }

  // Plane by plane from the near pairs of q. Returns false if one of them has no support pieces
  // (exact meshes, SDFs, height fields): its constraint is not smooth here.
  bool Begin(const VectorXd& q, const std::vector<NearPair>& near);
  // Chooses the rows for q (nq) and the planes as they are.
  void ChooseRows(const VectorXd& q);
  // Fills values, by_q and by_plane at q; where `lambda` is given, only of rows with λ ≠ 0.
  void Evaluate(const VectorXd& q, const VectorXd* lambda = nullptr);
  // Notes which planes are held: those with a row whose λ is not 0.
  void MarkHeld(const VectorXd& lambda);
  // Moves the planes by their unknowns.
  void MovePlanes(const VectorXd& step);

  int size() const { return static_cast<int>(rows_.size()); }
  int plane_unknowns() const { return unknowns_; }
  const std::vector<ConstraintRow>& rows() const { return rows_; }
  const std::vector<PartingPlane>& planes() const { return planes_; }

  // Of each row: its slack, or residual if it is an equality [m; limits: m at the scene's size];
  // its derivative by dq of all joints (rows × nv) and by the planes' unknowns (rows ×
  // plane_unknowns).
  const ContactRows& values() const { return values_; }
  const MatrixXd& by_plane() const { return by_plane_; }

  // Adds to `second` (plane_unknowns square) minus the rows' second derivatives by the planes'
  // unknowns, weighted by λ, at the pose of the last Evaluate.
  void AddPlaneCurvature(const VectorXd& lambda, MatrixXd& second) const;

 private:
  void AppendPlane(const NearPair& near);
  void ChooseRowsOf(int plane);
  void EvaluateLimit(const ConstraintRow& row, const VectorXd& q, int k);
  void EvaluatePiece(const ConstraintRow& row, int k);
  RelativePose Relative(const KeptPair& pair) const;  // of geom 2 in the frame of geom 1

  const Problem& problem_;
  const SceneTables& all_;
  PosedModel posed_;
  EqualityConstraints equality_;
  std::vector<PartingPlane> planes_;
  int unknowns_ = 0;
  std::vector<ConstraintRow> rows_;
  ContactRows values_;
  MatrixXd by_plane_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_GRADIENT_PARTED_CONSTRAINTS_H_
