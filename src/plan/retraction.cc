#include "plan/retraction.h"

#include <algorithm>

namespace mjcf_pdg {
namespace {

// How much of the way to a contact is gone, so that the next motion does not begin in its band; not
// tuned.
constexpr double kUpToContact = 0.98;
// The most slides that are made; not tuned.
constexpr int kSlides = 8;

// How slides are tried. Three tries, each a quarter as long, took 1.2 s instead of 0.70 in slot.xml
// (models/passages; bench/README.md, plan_bench); with one, trees in a hole keep their roots alone.
struct SlideRules {
  int tries;  // of a slide, each half as long as the one before
  // Shorter steps are not made [share of the step that the tree was to make].
  double least_progress;
};
constexpr SlideRules kWhole = {.tries = 1, .least_progress = 0.05};
constexpr SlideRules kCareful = {.tries = 5, .least_progress = 0.01};
constexpr double kShorter = 0.5;

class ContactRetraction : public Retraction {
 public:
  explicit ContactRetraction(const RetractionInput& input)
      : input_(input),
        rules_(input.slide.careful ? kCareful : kWhole),
        slide_(input.scene.tables(), *input.space,
               {input.options.mocap_pos, input.options.mocap_quat}, input.slide) {}

  const std::vector<VectorXd>& Retract(const VectorXd& near, const VectorXd& target) override {
    chain_.clear();
    slide_.Forget();
    share_ = 1.0;
    double left = input_.space->Distance(target, near);
    least_ = rules_.least_progress * left;
    if (Advance(near, target)) return chain_;
    VectorXd at = chain_.empty() ? near : chain_.back();
    for (int k = 0; k < kSlides && Slide(at, target); ++k) {
      const double now = input_.space->Distance(target, chain_.back());
      if (now >= left) {
        chain_.pop_back();
        break;
      }
      left = now;
      at = chain_.back();
    }
    return chain_;
  }

  std::int64_t queries() const override { return slide_.queries(); }

 private:
  // Appends the end of the free part of the motion if that is progress. Returns whether all is
  // free.
  bool Advance(const VectorXd& from, const VectorXd& to) {
    const MotionProver::FreePart free = input_.prover->Move(from, to);
    input_.space->Interpolate(from, to, free.all ? 1.0 : kUpToContact * free.t, end_);
    const bool proven = free.all || input_.space->straight() ||
                        input_.prover->Move(from, end_).all;  // bends otherwise than the whole
    if (proven && input_.space->Distance(end_, from) >= least_) chain_.push_back(end_);
    return free.all;
  }

  // Appends where a slide towards the target leads, if that is progress, and returns whether it
  // is. After a slide that was free the next may be longer.
  bool Slide(const VectorXd& at, const VectorXd& target) {
    const std::size_t before = chain_.size();
    for (int k = 0; k < rules_.tries && chain_.size() == before; ++k) {
      input_.space->Interpolate(at, target, share_, to_);
      const VectorXd& end = slide_.Go(at, to_);
      if (input_.space->Distance(end, at) < least_) return false;
      if (Advance(at, end)) {
        share_ = std::min(1.0, share_ / kShorter);
      } else if (chain_.size() == before) {
        share_ *= kShorter;
      }
    }
    return chain_.size() > before;
  }

  const RetractionInput input_;
  const SlideRules rules_;
  ContactSlide slide_;
  double least_ = 0.0;  // progress [m]
  double share_ = 1.0;  // of the way to the target that the next slide tries
  std::vector<VectorXd> chain_;
  VectorXd end_, to_;
};

class PdgRetraction : public Retraction {
 public:
  explicit PdgRetraction(const RetractionInput& input)
      : along_contact_(input),
        solver_(input.scene, RetractingOptions(input.options, input.slide.clearance)) {
    // A new sample may be cheaper than a deep one. Processor seconds per path found (bridge with a
    // hole of 36 cm, 16 seeds): 1.56 with 16, 1.45 with 40, 3.0 with 100.
    constexpr int kQueries = 40;
    solver_.SetBudget({.queries = kQueries});
  }

  const std::vector<VectorXd>& Retract(const VectorXd& near, const VectorXd& blocked) override {
    solver_.SetHint(AsSpan(near));
    const Status status = solver_.Solve(AsSpan(blocked), result_);
    queries_ += result_.stats.collision_queries;
    const bool solved = status != Status::kUnsolved;
    return along_contact_.Retract(near, solved ? ToEigen(result_.q) : blocked);
  }

  std::int64_t queries() const override { return queries_ + along_contact_.queries(); }

 private:
  static std::span<const double> AsSpan(const VectorXd& q) {
    return {q.data(), static_cast<std::size_t>(q.size())};
  }

  ContactRetraction along_contact_;
  Solver solver_;
  Result result_;
  std::int64_t queries_ = 0;
};

}  // namespace

Options RetractingOptions(const Options& given, double clearance) {
  Options options = given;
  options.effort = Effort::kFast;
  options.clearance = std::max(options.clearance, clearance);
  options.report_lower_bound = false;
  options.report_contacts = false;  // takes queries, and nobody sees them
  return options;
}

std::unique_ptr<Retraction> MakeContactRetraction(const RetractionInput& input) {
  return std::make_unique<ContactRetraction>(input);
}

std::unique_ptr<Retraction> MakePdgRetraction(const RetractionInput& input) {
  return std::make_unique<PdgRetraction>(input);
}

}  // namespace mjcf_pdg
