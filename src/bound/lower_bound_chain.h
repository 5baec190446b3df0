// The movers that lie between two geoms, and how far each can take a point per √S.
//
// Part of lower_bound.h; symbols are those of the derivation at the head of lower_bound.cc.
#ifndef MJCF_PDG_SRC_BOUND_LOWER_BOUND_CHAIN_H_
#define MJCF_PDG_SRC_BOUND_LOWER_BOUND_CHAIN_H_

#include <span>
#include <vector>

#include "bound/lower_bound_input.h"
#include "model/kinematics.h"
#include "norm/norm_evaluator.h"

namespace mjcf_pdg {

// A joint, or a rigid piece for the displacement metric: one term of S.
struct Mover {
  Matrix3d T = Matrix3d::Zero(), C = Matrix3d::Zero();
  Vector3d anchor = Vector3d::Zero();
  Vector3d axis = Vector3d::Zero();  // hinge and slide only
  bool hinge = false;
  double slide = 0.0;  // √λmax(T): farthest slide per √S
  double turn = 0.0;   // √λmax(C): largest |w| per √S
};
// The movers of one or more chains, one chain after the other.
using MoverPool = std::vector<Mover>;
// Base to terminal.
using Chain = std::span<const Mover>;

// [r] C [r]ᵀ of the point x.
Matrix3d TurnCompliance(const Mover& mover, const Vector3d& x);

// ρ_j² at most, within `radius` of x.
double ReachSquared(const Mover& mover, const Vector3d& x, double radius);

// False if something in the chain moves for free: then nothing is proven.
bool Finite(Chain chain);

// All movers of a scene at q_in.
class Chains {
 public:
  // `in` must stay while paths are asked for.
  void Fill(const LowerBoundInput& in);

  // Indices of the movers between the world, or the root link, and a body, base to terminal.
  void Path(int body, std::vector<int>& path);

  // Appends the movers of (a part of) a path. Consecutive slides that move a mass become one mover:
  // no rotation lies between them.
  void AppendAlong(std::span<const int> path, MoverPool& pool) const;

  const MoverPool& movers() const { return movers_; }

 private:
  Mover MoverOf(const NormTerm& term) const;
  // The body that carries `body` rigidly: up to the next movable joint.
  int Piece(int body) const;
  bool HasJoint(int body) const;
  // The displacement metric of bodies that are welded together is that of one rigid body.
  void MergeRigidPieces();
  // Joints of the bodies on the way.
  void JointPath(int body, std::vector<int>& path);
  void AppendJoints(int body, bool reversed, std::vector<int>& path) const;
  int RootTerm() const;  // -1: none

  const LowerBoundInput* in_ = nullptr;
  const mjModel* m_ = nullptr;
  MoverPool movers_;              // per term of the norm; per body for the displacement metric
  std::vector<NormTerm> pieces_;  // scratch: per body
  std::vector<int> above_;        // scratch: bodies on the way up
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LOWER_BOUND_CHAIN_H_
