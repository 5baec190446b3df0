// How the nearest free configuration changes with the given one: dσ/dq_in and dq/dq_in.
//
//   mjcf_pdg::Result result = solver.Solve(q_in);
//   mjcf_pdg::Gradient gradient = mjcf_pdg::Differentiator(scene).At(q_in, result);
//
// Not in the source. At an optimum, the derivatives follow from the contacts and limits that hold q
// back (implicit differentiation of the optimality conditions). dσ/dq_in is the derivative of σ by
// its first argument alone, for q is optimal (envelope theorem); that includes the norm's inertias,
// which are those at q_in. It is that of a local optimum: σ of another one may be smaller.
// Shapes and units: tangent vectors (nv) as MuJoCo's: [m] or [rad] by degree of freedom, the three
// of a ball joint in the body frame.
#ifndef MJCF_PDG_GRADIENT_H_
#define MJCF_PDG_GRADIENT_H_

#include <memory>
#include <span>
#include <vector>

#include "mjcf_pdg/export.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

struct Gradient {
  // nv entries: σ of q_in moved by a small dq is σ + sigma · dq [m² per m or rad]. Empty: the
  // result is unsolved.
  std::vector<double> sigma;
  // nv × nv, row by row: the answer moves by (matrix) · dq, in its own tangent space. Empty where
  // there is no such matrix: the result is unsolved, the optimum is not one point (a joint that
  // moves no mass), what touches is a triangle mesh, SDF or height field, or the answer is no local
  // optimum.
  std::vector<double> q;
  // A small change of q_in changes which contacts and limits hold q, so that the derivatives are
  // those of one side. Also set if the answer is not close to a local optimum; `sigma` is then that
  // of the answer as it is.
  bool active_set_changes = false;
};

// Differentiates results of one scene. Use one per thread. It never writes to the user's model.
class MJCF_PDG_API Differentiator {
 public:
  // The options that the results were solved with. Throws Error as Solver does, and for
  // options.rest: what contacts may keep then depends on q_in in a way that is not differentiated.
  explicit Differentiator(const Scene& scene, const Options& options = {});
  ~Differentiator();
  Differentiator(Differentiator&&) noexcept;
  Differentiator& operator=(Differentiator&&) noexcept;

  // `result` is a solver's for q_in (nq entries). The derivatives are those of the optimum close to
  // result.q, with the overlap that answers keep (half the tolerance), to some 1e-6 of their size:
  // its convergence to that is part of the work. Throws Error for a bad q_in or result.q.
  Gradient At(std::span<const double> q_in, const Result& result);

  // As Solver::SetMocap.
  void SetMocap(const std::vector<double>& pos, const std::vector<double>& quat);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_GRADIENT_H_
