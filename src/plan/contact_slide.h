// A slide along contacts: the step of a retraction that goes on where a motion is blocked.
//
// Source: Pan, Zhang & Manocha, Retraction-based RRT planner for articulated models (ICRA 2010).
// Differs from it: the distance is the object norm's. Careful slides (below) are not in the paper.
#ifndef MJCF_PDG_SRC_PLAN_CONTACT_SLIDE_H_
#define MJCF_PDG_SRC_PLAN_CONTACT_SLIDE_H_

#include "collide/contacts.h"
#include "norm/norm_evaluator.h"
#include "optimize/contact_matrix.h"
#include "optimize/lcp.h"
#include "optimize/witness_memory.h"
#include "plan/configuration_space.h"

namespace mjcf_pdg {

class ContactSlide {
 public:
  // Careful slides end where they keep the clearance after all, to second order, and they remember
  // where pairs touched: a query finds one point where two faces meet, around which a body would
  // turn until its far corner is in the way. In a hole no step gets far that does not know both.
  struct Options {
    double clearance = 0.0;  // that is kept from all that can be touched [m]
    bool careful = false;
  };

  // Contacts are those of `tables`, which may be a shrunken scene's; ends are brought onto the
  // equality constraints that `space` holds. Both must outlive this object.
  ContactSlide(const SceneTables& tables, const ConfigurationSpace& space, const MocapPoses& mocap,
               const Options& options);

  // Forgets where pairs touched.
  void Forget();

  // The nearest configuration to `to` (nq) that keeps the clearance of the contacts as they are
  // linearized at q (nq): min ½ ‖dq - (to ⊖ q)‖²_H subject to C dq + gap >= 0. Valid until the next
  // call.
  const VectorXd& Go(const VectorXd& q, const VectorXd& to);

  std::int64_t queries() const { return finder_.queries(); }

 private:
  void Step(const VectorXd& q);
  void AppendRows(const NearPair& near, double margin);
  void AppendRow(const NearPair& near, const Vector3d& p1_W, const Vector3d& p2_W, double distance);
  void HoldContacts(const VectorXd& q);

  const SceneTables& tables_;
  const ConfigurationSpace& space_;
  const MocapPoses mocap_;
  const Options options_;
  ContactFinder finder_;
  NormEvaluator norm_;
  WitnessMemory touched_;
  ContactRows rows_;
  ActiveSetLcp lcp_;
  VectorXd end_;
  VectorXd from_, dq_, r_;  // scratch
  MatrixXd J_, H_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_CONTACT_SLIDE_H_
