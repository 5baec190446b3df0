#include <algorithm>
#include <chrono>
#include <cmath>

#include "collide/convex/convex_distance.h"
#include "collide/convex/support_points.h"
#include "library/questions.h"

namespace mjcf_pdg::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Pairs are asked about if the gap of their bounding spheres is less than this, as a share of the
// smaller sphere's radius.
constexpr double kNear = 0.5;
// Change of every degree of freedom between a warm question and the one before [rad or m].
constexpr double kSmallMove = 1e-3;

// The gap that a plane with the normal n proves: -(h_1(n) + h_2(-n)), where h is the support
// function. The signed distance is the largest gap over all n, so the best gap of several answers'
// normals shows which answers are wrong.
double ProvenBy(const Vector3d& n_W, const SceneTables& tables, const PosedModel& posed,
                const KeptPair& pair) {
  double gap = 0.0;
  for (const int side : {0, 1}) {
    const int geom = side == 0 ? pair.geom1 : pair.geom2;
    const Vector3d n = side == 0 ? n_W : Vector3d(-n_W);
    const Matrix3d R = AsMatrix(posed.data()->geom_xmat + 9 * geom);
    const Vector3d farthest = AsVector(posed.data()->geom_xpos + 3 * geom) +
                              R * tables.support->Support(geom, R.transpose() * n);
    gap -= n.dot(farthest) + CoreRadius(*posed.model(), geom);
  }
  return gap;
}

// The signed distance by mj_geomDistance. Returns false if there is no answer.
bool AskMujoco(const mjModel& m, mjData& d, const KeptPair& pair, SignedGap& gap) {
  mjtNum fromto[6];
  constexpr double kFar = 1e3;
  gap.distance = mj_geomDistance(&m, &d, pair.geom1, pair.geom2, kFar, fromto);
  const Vector3d between = AsVector(fromto + 3) - AsVector(fromto);
  gap.n = (gap.distance < 0.0 ? -1.0 : 1.0) * between.normalized();
  return gap.distance < kFar && gap.n.allFinite();
}

class ConvexBench : public Questions {
 public:
  ConvexBench(const Scene& scene, Table& table)
      : tables_(scene.tables()),
        table_(table),
        model_(tables_.query_model),
        posed_(&model_),
        convex_(tables_),
        libraries_(Libraries(model_, false)) {}

  void Ask(const VectorXd& q) override {
    VectorXd before;
    Integrate(tables_, q, VectorXd::Constant(tables_.n, kSmallMove), before);
    for (int pair = 0; pair < static_cast<int>(tables_.pairs.size()); ++pair) {
      const KeptPair& kept = tables_.pairs[pair];
      if (kept.kind == PairKind::kExact || !tables_.support->Knows(kept.geom1) ||
          !tables_.support->Knows(kept.geom2)) {
        continue;
      }
      posed_.Pose(q);
      const double r1 = model_.geom_rbound[kept.geom1], r2 = model_.geom_rbound[kept.geom2];
      const double apart = (AsVector(posed_.data()->geom_xpos + 3 * kept.geom1) -
                            AsVector(posed_.data()->geom_xpos + 3 * kept.geom2))
                               .norm() -
                           r1 - r2;
      if (apart < kNear * std::min(r1, r2)) Ask(pair, before, q);
    }
  }

 private:
  struct Answer {
    std::string name;
    bool given = false;
    double seconds = 0.0;
    SignedGap gap = {};
  };

  template <typename Question>
  void Add(const std::string& name, Question ask) {
    Answer answer{.name = name};
    answer.seconds = Seconds([&] { answer.given = ask(answer.gap); });
    answers_.push_back(answer);
  }

  bool AskOurs(int pair, SignedGap& gap) {
    return convex_.Ask(posed_, pair, kInfinity, gap) == ConvexDistance::Answer::kNear;
  }

  void Ask(int pair, const VectorXd& before, const VectorXd& q) {
    const KeptPair& kept = tables_.pairs[pair];
    answers_.clear();
    Add(kOurs, [&](SignedGap& gap) {
      convex_.Forget();
      return AskOurs(pair, gap);
    });
    AskWarm(pair, before, q);
    Add(kMujoco, [&](SignedGap& gap) { return AskMujoco(model_, *posed_.data(), kept, gap); });
    for (const auto& library : libraries_) {
      Add(library->name(), [&](SignedGap& gap) {
        return library->Distance(*posed_.data(), kept.geom1, kept.geom2, gap);
      });
    }
    double truth = -kInfinity;
    for (const Answer& a : answers_) {
      if (a.given) truth = std::max(truth, ProvenBy(a.gap.n, tables_, posed_, kept));
    }
    const double radius = std::min(model_.geom_rbound[kept.geom1], model_.geom_rbound[kept.geom2]);
    const std::string kind =
        truth < 0.0 ? "convex distance, overlapping" : "convex distance, apart";
    for (const Answer& a : answers_) {
      const double error = a.given ? std::abs(a.gap.distance - truth) / radius : kNoAnswer;
      table_.Add(kind, a.name, a.seconds, error);
    }
  }

  // Asks our own code for a pair at q, each time after asking at the configuration `before`.
  void AskWarm(int pair, const VectorXd& before, const VectorXd& q) {
    Answer answer{.name = kOursWarm};
    answer.seconds = kInfinity;
    for (int k = 0; k < kRepeats; ++k) {
      SignedGap unused;
      convex_.Forget();
      posed_.Pose(before);
      AskOurs(pair, unused);
      posed_.Pose(q);
      const auto begin = std::chrono::steady_clock::now();
      answer.given = AskOurs(pair, answer.gap);
      const auto end = std::chrono::steady_clock::now();
      answer.seconds = std::min(answer.seconds, std::chrono::duration<double>(end - begin).count());
    }
    answers_.push_back(answer);
  }

  const SceneTables& tables_;
  Table& table_;
  mjModel model_;
  PosedModel posed_;
  ConvexDistance convex_;
  std::vector<std::unique_ptr<Library>> libraries_;
  std::vector<Answer> answers_;
};

}  // namespace

std::unique_ptr<Questions> ConvexQuestions(const Scene& scene, Table& table) {
  return std::make_unique<ConvexBench>(scene, table);
}

}  // namespace mjcf_pdg::bench
