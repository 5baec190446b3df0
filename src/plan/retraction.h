// What becomes of a sample that is in collision: it is moved to the contact space and becomes a
// node, so that a tree grows along the walls of a narrow passage.
#ifndef MJCF_PDG_SRC_PLAN_RETRACTION_H_
#define MJCF_PDG_SRC_PLAN_RETRACTION_H_

#include <memory>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "plan/configuration_space.h"
#include "plan/contact_slide.h"
#include "plan/motion_prover.h"

namespace mjcf_pdg {

class Retraction {
 public:
  virtual ~Retraction() = default;
  // Configurations that lead from `near`, which is free, towards `blocked`, to which the motion is
  // not free. Each is joined to the one before by a motion that is proven free. Empty: none was
  // found. Valid until the next call.
  virtual const std::vector<VectorXd>& Retract(const VectorXd& near, const VectorXd& blocked) = 0;
  virtual std::int64_t queries() const = 0;  // collision queries, those of the prover aside
};

// What both kinds work with.
struct RetractionInput {
  const Scene& scene;
  Options options;
  std::shared_ptr<ConfigurationSpace> space;
  std::shared_ptr<MotionProver> prover;
  // The clearance is that of contact samples, so that motions along walls are provable. Where
  // slides are careful, shorter ones are tried.
  ContactSlide::Options slide = {};
};

// Of a solver that retracts: fast, without reports, with the clearance of contact samples [m].
Options RetractingOptions(const Options& options, double clearance);

// Along the contact, without PDg: to the first contact by CCD, then sliding towards the sample as
// long as that comes nearer to it (contact_slide.h).
//
// Source: Pan, Zhang & Manocha, Retraction-based RRT planner for articulated models (ICRA 2010).
// Differs from it:
//   1. Every slide is proven free by CCDg.
//   2. Where a slide is not free, careful ones are tried half of the way, a quarter, down to a
//   sixteenth.
std::unique_ptr<Retraction> MakeContactRetraction(const RetractionInput& input);

// By generalized penetration depth: towards the nearest free configuration to the sample, from the
// nearest node, and along the contact where the straight motion is not free.
//
// Source: Tang & Kim, Sec. 6.3.
// Differs from it:
//   1. The sample is the end of the step that the tree was to make, not the configuration that was
//      drawn, which may lie far beyond it.
//   2. birrt-pdg asks for it where its trees are to be joined (planners.cc).
//   3. Where the solver finds nothing free, the tree goes along the contact towards the sample
//      itself.
std::unique_ptr<Retraction> MakePdgRetraction(const RetractionInput& input);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_RETRACTION_H_
