#include "plan/retraction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

namespace mjcf_pdg {
namespace {

// How much of the way to a contact is gone, so that the next motion does not begin in its band.
// This and the next are not tuned.
constexpr double kUpToContact = 0.98;
// Shorter steps do not count as progress [share of the step that the tree was to make].
constexpr double kLeastProgress = 0.05;

class ContactRetraction : public Retraction {
 public:
  explicit ContactRetraction(const RetractionInput& input)
      : input_(input),
        tables_(input.scene.tables()),
        finder_(tables_, input.clearance),
        norm_(tables_, Metric::kSequential),
        mocap_{input.options.mocap_pos, input.options.mocap_quat} {
    finder_.SetMocap(mocap_);
  }

  const std::vector<VectorXd>& Retract(const VectorXd& near, const VectorXd& target) override {
    constexpr int kSlides = 8;  // most that are made
    chain_.clear();
    double left = input_.space->Distance(target, near);
    const double least = kLeastProgress * left;
    if (Advance(near, target, least)) return chain_;
    VectorXd at = chain_.empty() ? near : chain_.back(), step;
    for (int k = 0; k < kSlides; ++k) {
      Slide(at, target, step);
      const std::size_t before = chain_.size();
      Advance(at, step, least);
      if (chain_.size() == before) break;
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

  std::int64_t queries() const override { return finder_.queries(); }

 private:
  // Appends the end of the free part of the motion if that is progress. Returns whether all is
  // free.
  bool Advance(const VectorXd& from, const VectorXd& to, double least) {
    const MotionProver::FreePart free = input_.prover->Move(from, to);
    input_.space->Interpolate(from, to, free.all ? 1.0 : kUpToContact * free.t, end_);
    const bool proven = free.all || input_.space->straight() ||
                        input_.prover->Move(from, end_).all;  // bends otherwise than the whole
    if (proven && input_.space->Distance(end_, from) >= least) chain_.push_back(end_);
    return free.all;
  }

  // The nearest configuration to `to` that keeps the clearance of the contacts as they are
  // linearized at q: min ½ ‖dq - (to ⊖ q)‖²_H subject to C dq + gap >= 0.
  void Slide(const VectorXd& q, const VectorXd& to, VectorXd& out) {
    // Pairs nearer than this are rows, a tenth of a link [m].
    const double margin = 0.1 * tables_.size;
    finder_.Forget();
    finder_.Pose(q);
    rows_.Clear(tables_.n);
    for (const NearPair& near : finder_.Find(margin)) {
      const int row = rows_.Append(near.distance - input_.clearance);
      ContactRow(tables_, finder_.posed(), near.pair, near.p1_W, near.p2_W, near.n_W,
                 rows_.C.row(row));
    }
    dq_.resize(tables_.n);
    Difference(tables_, q, to, dq_);
    if (rows_.m > 0) Correct(q);
    out = q;
    Integrate(tables_, out, dq_, out);
    ClampToLimits(tables_, out);
    if (!input_.space->Project(out)) out = q;
  }

  // dq_ += H⁻¹ Cᵀ λ.
  void Correct(const VectorXd& q) {
    const int n = tables_.n, m = rows_.m;
    norm_.SetReference(q, mocap_);
    norm_.Linearize(q, r_, J_);
    H_.setZero(n, n);
    norm_.InnerProduct(J_, H_);
    const Eigen::LLT<MatrixXd> llt(H_);
    const MatrixXd C = rows_.C.topRows(m);
    const MatrixXd G = llt.matrixL().solve(C.transpose());
    const VectorXd b = -(C * dq_) - rows_.gap.head(m);
    const VectorXd mu = VectorXd::Constant(m, 1e9);  // rows are hard
    VectorXd lambda = VectorXd::Zero(m);
    lcp_.Reserve(n, m);
    lcp_.Solve(G, b, mu, {}, lambda);
    dq_ += llt.matrixU().solve(G * lambda);
  }

  const RetractionInput input_;
  const SceneTables& tables_;
  ContactFinder finder_;
  NormEvaluator norm_;
  const MocapPoses mocap_;
  ContactRows rows_;
  ActiveSetLcp lcp_;
  std::vector<VectorXd> chain_;
  VectorXd end_, dq_, r_;
  MatrixXd J_, H_;
};

class PdgRetraction : public Retraction {
 public:
  explicit PdgRetraction(const RetractionInput& input)
      : along_contact_(input),
        solver_(input.scene, RetractingOptions(input.options, input.clearance)) {
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
