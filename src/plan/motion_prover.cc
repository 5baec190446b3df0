#include "plan/motion_prover.h"

#include <cmath>

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
  ProvenMotions(const ob::SpaceInformationPtr& space, std::shared_ptr<MotionProver> prover,
                std::function<bool()> ended)
      : ob::MotionValidator(space), prover_(std::move(prover)), ended_(std::move(ended)) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return Count(!ended_() &&
                 prover_->IsFree(ConfigurationSpace::Q(from), ConfigurationSpace::Q(to)));
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_free) const override {
    const MotionProver::FreePart free =
        prover_->Move(ConfigurationSpace::Q(from), ConfigurationSpace::Q(to));
    if (!free.all) {
      last_free.second = free.t;
      if (last_free.first) si_->getStateSpace()->interpolate(from, to, free.t, last_free.first);
    }
    return Count(free.all);
  }

 private:
  bool Count(bool free) const {
    ++(free ? valid_ : invalid_);
    return free;
  }
  std::shared_ptr<MotionProver> prover_;
  std::function<bool()> ended_;
};

}  // namespace

const Motion& MotionProver::GoStraight(const VectorXd& from, const VectorXd& to) {
  const Motion& motion = checker_.Check(AsSpan(from), AsSpan(to));
  queries_ += motion.poses;
  certified_ = certified_ && motion.certified;
  return motion;
}

MotionProver::FreePart MotionProver::Move(const VectorXd& from, const VectorXd& to) {
  certified_ = true;
  VectorXd at = from;
  double t = 0.0;
  const bool all = space_->Follow(from, to, [&](const ConfigurationSpace::Piece& piece) {
    const Motion& motion = GoStraight(at, piece.q);
    const bool free = motion.outcome == MotionOutcome::kFree;
    t = free ? piece.t : std::lerp(t, piece.t, motion.t);
    at = piece.q;
    return free;
  });
  return {all, t};
}

bool MotionProver::IsFree(const VectorXd& q) {
  certified_ = true;
  return GoStraight(q, q).outcome == MotionOutcome::kFree;
}

bool MotionProver::IsFree(const VectorXd& from, const VectorXd& to) {
  if (!IsFree(to)) return false;  // one pose tells most of those that are not
  const FreePart free = Move(from, to);
  return free.all || (free.t > kNearlyThere && Move(to, from).all);
}

void Straighten(MotionProver& prover, const std::function<bool()>& ended,
                std::vector<VectorXd>& corners) {
  const auto at = [&corners](std::size_t k) {
    return corners.begin() + static_cast<std::ptrdiff_t>(k);
  };
  for (std::size_t k = 0; k + 2 < corners.size(); ++k) {
    const std::size_t next = k + 1;
    std::size_t last = corners.size() - 1;
    for (; last > next; last = next + (last - next) / 2) {
      if (ended()) return;
      if (prover.IsFree(corners[k], corners[last])) break;
    }
    corners.erase(at(next), at(last));
  }
}

void UseProver(const std::shared_ptr<MotionProver>& prover, std::function<bool()> ended,
               const ob::SpaceInformationPtr& space) {
  space->setStateValidityChecker(std::make_shared<FreeConfigurations>(space, prover));
  space->setMotionValidator(std::make_shared<ProvenMotions>(space, prover, std::move(ended)));
}

}  // namespace mjcf_pdg
