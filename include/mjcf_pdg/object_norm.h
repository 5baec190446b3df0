// Object norm σ between two configurations of an articulated model.
//
// Source: Tang & Kim, Eq. 1 (rigid), 13-19 (joint by joint, sequential change).
// Differs from it:
//   1. Masses, not volumes, weigh the motion (MuJoCo's body inertias).
//   2. A free joint is three slides and a ball at the subtree's centre of mass, so that a single
//      free body gives exactly Eq. 1.
//   3. Several moving trees add up.
//   4. With another root link B, the pose change of B moves B's whole tree as one rigid piece, and
//      each joint between the tree's top body and B moves the side of the tree that B is not on.
//   5. A second metric, the true mean squared displacement, is offered beside the paper's.
// Shapes and units: q (nq), σ [m²]. Mocap bodies are where the model has them.
#ifndef MJCF_PDG_OBJECT_NORM_H_
#define MJCF_PDG_OBJECT_NORM_H_

#include <memory>
#include <string>
#include <vector>

#include "mjcf_pdg/export.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

// One term of the sum over joints, Eq. 19.
struct NormPart {
  // A joint's name, or "root" for the pose of the root link; with Metric::kDisplacement, a body's.
  std::string name;
  double sigma = 0.0;  // [m²]
};

// The function σ(q_in, ·). Use one per thread, because it poses private MuJoCo data.
class MJCF_PDG_API ObjectNorm {
 public:
  // Measures from q_in (nq entries). All functions that take a configuration throw Error if
  // Scene::CheckConfiguration refuses it.
  ObjectNorm(const Scene& scene, Metric metric, const std::vector<double>& q_in);
  ~ObjectNorm();
  ObjectNorm(ObjectNorm&&) noexcept;
  ObjectNorm& operator=(ObjectNorm&&) noexcept;

  double Sigma(const std::vector<double>& q);                 // σ(q_in, q) [m²]
  std::vector<NormPart> Parts(const std::vector<double>& q);  // the terms that add up to Sigma(q)

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_OBJECT_NORM_H_
