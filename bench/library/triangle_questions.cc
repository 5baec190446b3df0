#include <algorithm>
#include <cmath>

#include "collide/exact/exact_contacts.h"
#include "library/questions.h"

namespace mjcf_pdg::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class TriangleBench : public Questions {
 public:
  TriangleBench(const Scene& scene, double share_of_radius, Table& table)
      : tables_(scene.tables()),
        share_of_radius_(share_of_radius),
        table_(table),
        posed_(&tables_.query_model),
        exact_(tables_, 0.0),
        libraries_(Libraries(tables_.query_model, true)) {}

  void Ask(const VectorXd& q) override {
    posed_.Pose(q);
    const mjModel& m = tables_.query_model;
    for (int pair = 0; pair < static_cast<int>(tables_.pairs.size()); ++pair) {
      const KeptPair& kept = tables_.pairs[pair];
      const bool meshes = kept.kind == PairKind::kExact && m.geom_type[kept.geom1] == mjGEOM_MESH &&
                          m.geom_type[kept.geom2] == mjGEOM_MESH;
      if (!meshes) continue;
      AskWhetherTheyCross(pair, kept);
      const double radius = std::min(m.geom_rbound[kept.geom1], m.geom_rbound[kept.geom2]);
      AskHowFar(pair, kept, kInfinity, "triangle distance", radius);
      AskHowFar(pair, kept, share_of_radius_ * radius, "triangle distance, cutoff 0.05 radius",
                radius);
    }
  }

 private:
  void AskWhetherTheyCross(int pair, const KeptPair& kept) {
    bool own = false;
    const double seconds = Seconds([&] {
      exact_.Forget();
      features_.clear();
      exact_.Features(posed_, pair, 0.0, Depths::kSkipped, features_);
      own = !features_.empty();
    });
    const std::string kind = own ? "triangles overlap: yes" : "triangles overlap: no";
    table_.Add(kind, kOurs, seconds, 0.0);
    for (const auto& library : libraries_) {
      bool crossing = false;
      const double time = Seconds(
          [&] { crossing = library->TrianglesCross(*posed_.data(), kept.geom1, kept.geom2); });
      table_.Add(kind, library->name(), time, crossing == own ? 0.0 : 1.0);
    }
  }

  void AskHowFar(int pair, const KeptPair& kept, double cutoff, const std::string& what,
                 double radius) {
    SignedGap gap;
    bool near = false;
    auto ask = [&] { near = exact_.Distance(posed_, pair, cutoff, gap); };
    const double cold = Seconds([&] {
      exact_.Forget();
      ask();
    });
    if (near && gap.distance <= 0.0) return;  // these libraries do not measure depths of meshes
    const double warm = Seconds(ask);  // from the triangles just found, which is the best case
    const double own = near ? gap.distance : cutoff;
    const std::string kind = what + (near ? "" : ": beyond");
    table_.Add(kind, kOurs, cold, 0.0);
    table_.Add(kind, kOursWarm, warm, 0.0);
    const double limit = std::min(cutoff, std::numeric_limits<double>::max());
    for (const auto& library : libraries_) {
      double distance = 0.0;
      const double time = Seconds([&] {
        distance = library->TriangleDistance(*posed_.data(), kept.geom1, kept.geom2, limit);
      });
      table_.Add(kind, library->name(), time, std::abs(distance - own) / radius);
    }
  }

  const SceneTables& tables_;
  const double share_of_radius_;
  Table& table_;
  PosedModel posed_;
  ExactContacts exact_;
  std::vector<std::unique_ptr<Library>> libraries_;
  std::vector<SignedGap> features_;
};

}  // namespace

std::unique_ptr<Questions> TriangleQuestions(const Scene& scene, double share_of_radius,
                                             Table& table) {
  return std::make_unique<TriangleBench>(scene, share_of_radius, table);
}

}  // namespace mjcf_pdg::bench
