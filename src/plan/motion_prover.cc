#include "plan/motion_prover.h"

#include "plan/configuration_space.h"

namespace mjcf_pdg {
namespace {

namespace ob = ompl::base;

// A motion that stops so late may end at a contact; then it is asked the other way round. CCDg
// stops a few tolerances before a contact, 1e-5 of a motion of half a metre.
constexpr double kNearlyThere = 0.99;

std::span<const double> AsSpan(const VectorXd& q) {
  return {q.data(), static_cast<std::size_t>(q.size())};
}

class FreeConfigurations : public ob::StateValidityChecker {
 public:
  FreeConfigurations(const ob::SpaceInformationPtr& space, std::shared_ptr<MotionProver> prover)
      : ob::StateValidityChecker(space), prover_(std::move(prover)) {}
  bool isValid(const ob::State* state) const override {
    return prover_->IsFree(ConfigurationSpace::Q(state));
  }

 private:
  std::shared_ptr<MotionProver> prover_;
};

class ProvenMotions : public ob::MotionValidator {
 public:
  ProvenMotions(const ob::SpaceInformationPtr& space, std::shared_ptr<MotionProver> prover)
      : ob::MotionValidator(space), prover_(std::move(prover)) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return Count(prover_->IsFree(ConfigurationSpace::Q(from), ConfigurationSpace::Q(to)));
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_free) const override {
    const Motion& motion = prover_->Move(ConfigurationSpace::Q(from), ConfigurationSpace::Q(to));
    const bool free = motion.outcome == MotionOutcome::kFree;
    if (!free) {
      last_free.second = motion.t;
      if (last_free.first) si_->getStateSpace()->interpolate(from, to, motion.t, last_free.first);
    }
    return Count(free);
  }

 private:
  bool Count(bool free) const {
    ++(free ? valid_ : invalid_);
    return free;
  }
  std::shared_ptr<MotionProver> prover_;
};

}  // namespace

const Motion& MotionProver::Move(const VectorXd& from, const VectorXd& to) {
  const Motion& motion = checker_.Check(AsSpan(from), AsSpan(to));
  queries_ += motion.poses;
  certified_ = motion.certified;
  return motion;
}

bool MotionProver::IsFree(const VectorXd& q) { return Move(q, q).outcome == MotionOutcome::kFree; }

bool MotionProver::IsFree(const VectorXd& from, const VectorXd& to) {
  if (!IsFree(to)) return false;  // one pose tells most of those that are not
  const Motion& motion = Move(from, to);
  if (motion.outcome == MotionOutcome::kFree) return true;
  return motion.outcome == MotionOutcome::kContact && motion.t > kNearlyThere &&
         Move(to, from).outcome == MotionOutcome::kFree;
}

void UseProver(const std::shared_ptr<MotionProver>& prover, const ob::SpaceInformationPtr& space) {
  space->setStateValidityChecker(std::make_shared<FreeConfigurations>(space, prover));
  space->setMotionValidator(std::make_shared<ProvenMotions>(space, prover));
}

}  // namespace mjcf_pdg
