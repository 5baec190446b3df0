// Our own collision code and LCP beside the libraries that could stand in for them: time on the
// same inputs as a ratio to ours, what they disagree by, and what they fail at. README.md beside
// this file says what the columns mean.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "collide/convex/convex_distance.h"
#include "collide/exact/exact_contacts.h"
#include "library/library.h"
#include "library/quadratic_program.h"
#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "optimize/contact_matrix.h"
#include "optimize/lcp.h"
#include "problem/workspace.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kRepeats = 5;  // of each question; the shortest time counts
constexpr double kNear =
    0.5;  // pairs whose spheres are farther apart are not asked [smaller radius]
constexpr double kWrong = 1e-3;  // a distance that is off by more is a failure [smaller radius]
constexpr double kSmallMove =
    1e-3;  // of each dof, between a question and the one before [rad or m]

double Seconds(const std::function<void()>& ask) {
  double least = kInfinity;
  for (int k = 0; k < kRepeats; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    ask();
    least = std::min(
        least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return least;
}

// Not answered: given up, or infeasible.
constexpr double kNoAnswer = kInfinity;

// One row of a table: how one library did on all questions of a kind.
struct Score {
  std::vector<double> seconds;
  double largest_error = 0.0;  // of those that are neither wrong nor unanswered
  int wrong = 0, unanswered = 0;

  void Add(double time, double error) {
    seconds.push_back(time);
    if (error == kNoAnswer) {
      ++unanswered;
    } else if (error > kWrong) {
      ++wrong;
    } else {
      largest_error = std::max(largest_error, error);
    }
  }
};

// By kind of question, then by library in the order of `names`.
class Table {
 public:
  void Add(const std::string& kind, const std::string& name, double seconds, double error) {
    if (scores_.find(kind) == scores_.end()) kinds_.push_back(kind);
    scores_[kind][name].Add(seconds, error);
  }
  void Print(const std::vector<std::string>& names) const {
    std::printf("%-46s %-12s %6s %10s %6s %10s %6s %6s\n", "question", "by", "n", "median us",
                "ratio", "max error", "wrong", "none");
    for (const std::string& kind : kinds_) {
      const std::map<std::string, Score>& scores = scores_.at(kind);
      const double own = Quantile(scores.at(names.front()).seconds, 0.5);
      for (const std::string& name : names) {
        const auto found = scores.find(name);
        if (found == scores.end()) continue;
        const Score& s = found->second;
        const double median = Quantile(s.seconds, 0.5);
        std::printf("%-46s %-12s %6zu %10.3f %6.2f %10.1e %6d %6d\n", kind.c_str(), name.c_str(),
                    s.seconds.size(), 1e6 * median, median / own, s.largest_error, s.wrong,
                    s.unanswered);
      }
    }
    std::fflush(stdout);
  }

 private:
  std::vector<std::string> kinds_;
  std::map<std::string, std::map<std::string, Score>> scores_;
};

std::vector<std::unique_ptr<Library>> Libraries(const mjModel& m, bool triangles) {
  std::vector<std::unique_ptr<Library>> libraries;
  for (auto make : {MakeFcl, MakeCoal}) {
    if (auto library = make(m, triangles)) libraries.push_back(std::move(library));
  }
  return libraries;
}

// ---- Distances of convex geoms ----

// -(h_1(n) + h_2(-n)): what a plane with normal n proves. The signed distance is the largest over
// all n, so the best of several answers' normals tells which of them are short of it.
double ProvenBy(const Vector3d& n_W, const SceneTables& tables, const PosedModel& posed,
                const KeptPair& pair) {
  double gap = 0.0;
  for (const int side : {0, 1}) {
    const int geom = side == 0 ? pair.geom1 : pair.geom2;
    const Vector3d n = side == 0 ? n_W : Vector3d(-n_W);
    const Matrix3d R = AsMatrix(posed.data()->geom_xmat + 9 * geom);
    const Vector3d farthest = AsVector(posed.data()->geom_xpos + 3 * geom) +
                              R * tables.support->Farthest(geom, R.transpose() * n);
    gap -= n.dot(farthest) + CoreRadius(*posed.model(), geom);
  }
  return gap;
}

bool AskMujoco(const mjModel& m, mjData& d, const KeptPair& pair, SignedGap& gap) {
  mjtNum fromto[6];
  constexpr double kFar = 1e3;
  gap.distance = mj_geomDistance(&m, &d, pair.geom1, pair.geom2, kFar, fromto);
  const Vector3d between = AsVector(fromto + 3) - AsVector(fromto);
  gap.n = (gap.distance < 0.0 ? -1.0 : 1.0) * between.normalized();
  return gap.distance < kFar && gap.n.allFinite();
}

const char kOurs[] = "ours, cold", kOursWarm[] = "ours, warm", kMujoco[] = "MuJoCo";

// Every convex pair that is near at q, asked of all.
class ConvexBench {
 public:
  ConvexBench(const Scene& scene, Table& table)
      : tables_(scene.tables()),
        table_(table),
        model_(tables_.query_model),
        posed_(&model_),
        convex_(tables_),
        libraries_(Libraries(model_, false)) {}

  void Ask(const VectorXd& q) {
    VectorXd before;
    Integrate(tables_, q, VectorXd::Constant(tables_.n, kSmallMove), before);
    for (int pair = 0; pair < static_cast<int>(tables_.pairs.size()); ++pair) {
      const KeptPair& kept = tables_.pairs[pair];
      if (kept.exact || !tables_.support->Knows(kept.geom1) ||
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

  // Each time from what was found at the configuration before.
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

// ---- Trees of triangles ----

// Pairs of two triangle meshes: do they overlap, at q_in; how far apart are they, at the answer of
// a fast solve and beyond it.
class TriangleBench {
 public:
  TriangleBench(const Scene& scene, Table& table)
      : tables_(scene.tables()),
        table_(table),
        posed_(&tables_.query_model),
        exact_(tables_, 0.0),
        libraries_(Libraries(tables_.query_model, true)) {}

  void Ask(const VectorXd& q, double share_of_radius) {
    posed_.Pose(q);
    const mjModel& m = tables_.query_model;
    for (int pair = 0; pair < static_cast<int>(tables_.pairs.size()); ++pair) {
      const KeptPair& kept = tables_.pairs[pair];
      const bool meshes = kept.exact && m.geom_type[kept.geom1] == mjGEOM_MESH &&
                          m.geom_type[kept.geom2] == mjGEOM_MESH;
      if (!meshes) continue;
      AskWhetherTheyCross(pair, kept);
      const double radius = std::min(m.geom_rbound[kept.geom1], m.geom_rbound[kept.geom2]);
      AskHowFar(pair, kept, kInfinity, "triangle distance", radius);
      AskHowFar(pair, kept, share_of_radius * radius, "triangle distance, cutoff 0.05 radius",
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
    if (near && gap.distance <= 0.0) return;  // depths are not what these libraries tell
    const double warm = Seconds(ask);  // from the triangles that it has just found: a best case
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
  Table& table_;
  PosedModel posed_;
  ExactContacts exact_;
  std::vector<std::unique_ptr<Library>> libraries_;
  std::vector<SignedGap> features_;
};

// ---- The LCP ----

// Linearizes at q as a local optimization's first step does, and asks for the step.
void AskLcp(const Scene& scene, const VectorXd& q, Table& table, int& infeasible) {
  constexpr double kMargin = 0.12, kLimitReach = 0.5, kTolerance = 1e-8, kPrice = 1e6,
                   kImmovable = 1e-12;
  const SceneTables& tables = scene.tables();
  const Options options;
  Workspace work(tables, options);
  work.Begin(q);
  work.finder.Pose(q);
  ContactRows rows;
  rows.Clear(tables.n);
  for (const NearPair& near : work.finder.Find(kMargin * work.problem().size)) {
    if (!tables.pairs[near.pair].moves) continue;
    const int row = rows.Append(near.distance);
    ContactRow(tables, work.finder.posed(), near.pair, near.p1_W, near.p2_W, near.n_W,
               rows.C.row(row));
  }
  const double size = work.problem().size;
  AppendLimitRows(tables, q, {kLimitReach, kLimitReach * size, size}, rows);
  const int n = tables.n, m = rows.m;
  if (m == 0) return;
  VectorXd r;
  MatrixXd J, H;
  work.norm.Linearize(q, r, J);
  work.norm.InnerProduct(J, H);
  BlockCholesky whitening;
  whitening.Factor(H, work.norm.blocks());
  VectorXd y = J.transpose() * r;
  whitening.SolveLower(y);
  MatrixXd G = rows.C.topRows(m).transpose();
  whitening.SolveLower(G);
  // To first order nothing moves these two apart: then there is no answer that is not elastic.
  const auto lengths = G.colwise().norm();
  if (lengths.minCoeff() < kImmovable * lengths.maxCoeff()) {
    ++infeasible;
    return;
  }
  const VectorXd gap = rows.gap.head(m), b = G.transpose() * y - gap;
  const VectorXd mu = VectorXd::Constant(m, kPrice);
  VectorXd lambda(m);
  LcpOptions how;
  how.max_steps = 10 * (n + m);
  how.tolerance = kTolerance;
  ActiveSetLcp active_set;
  LcpOutcome outcome;
  const double seconds = Seconds([&] { outcome = active_set.Solve(G, b, mu, how, lambda); });
  if ((lambda.array() >= mu.array()).any()) {  // rows conflict: only an elastic answer exists
    ++infeasible;
    return;
  }
  const std::string kind = m < 20 ? "LCP, fewer than 20 rows" : "LCP, 20 rows and more";
  const VectorXd z = G * lambda - y;
  // Objectives: the steps are unique, but rows may be dependent and multipliers not.
  auto error = [&](const VectorXd& other) {
    const double violation = -(G.transpose() * other + gap).minCoeff();
    const double worse = (other + y).norm() - (z + y).norm();
    return std::max(violation, worse) / work.problem().size;
  };
  table.Add(kind, kOurs, seconds, outcome.converged ? error(z) : kNoAnswer);
  const QpOutcome daqp = SolveByDaqp(G, y, gap);
  if (daqp.built) {
    double setup = daqp.setup_seconds;
    const double alone = [&] {
      double least = daqp.seconds;
      for (int k = 1; k < kRepeats; ++k) {
        const QpOutcome again = SolveByDaqp(G, y, gap);
        least = std::min(least, again.seconds);
        setup = std::min(setup, again.setup_seconds);
      }
      return least;
    }();
    const double off = daqp.solved ? error(daqp.z) : kNoAnswer;
    table.Add(kind, "DAQP", alone, off);
    table.Add(kind, "DAQP, setup", setup + alone, off);
  }
  GaussSeidelLcp gauss_seidel;
  VectorXd swept(m);
  const double sweeping = Seconds([&] {
    swept.setZero();
    outcome = gauss_seidel.Solve(G, b, mu, how, swept);
  });
  table.Add(kind, "Gauss-Seidel", sweeping, outcome.converged ? error(G * swept - y) : kNoAnswer);
}

// ---- All of them ----

void Run(const SetArguments& arguments) {
  SetArguments hulls = arguments, triangles = arguments;
  if (arguments.models.empty()) {
    for (const char* name : {"spoon_cup", "linked_rings", "l_shape_torus_knot", "pawn_cad",
                             "hammer_bumpy_sphere", "ball_in_cup", "ring_on_post"}) {
      triangles.models.push_back(std::string(MJCF_PDG_MODEL_DIR "/rigid/") + name + ".xml");
    }
  }
  triangles.exact_mesh = true;
  Table convex, meshes, lcp;
  int infeasible = 0;
  for (const Workload& workload : LoadSoundWorkloads(hulls)) {
    ConvexBench bench(*workload.scene, convex);
    for (const BenchProblem& problem : workload.set.problems) {
      const VectorXd q = Normalized(workload.scene->tables(), ToEigen(problem.q_in));
      bench.Ask(q);
      AskLcp(*workload.scene, q, lcp, infeasible);
    }
  }
  convex.Print({kOurs, kOursWarm, kMujoco, "FCL", "Coal"});
  Options fast;
  fast.effort = Effort::kFast;
  for (const Workload& workload : LoadSoundWorkloads(triangles)) {
    const SceneTables& tables = workload.scene->tables();
    TriangleBench bench(*workload.scene, meshes);
    Solver solver(*workload.scene, fast);
    for (const BenchProblem& problem : workload.set.problems) {
      const VectorXd q_in = Normalized(tables, ToEigen(problem.q_in));
      VectorXd dq, q;
      Difference(tables, q_in, ToEigen(solver.Solve(problem.q_in).q), dq);
      for (const double times : {0.0, 1.0, 1.05, 1.5}) {
        Integrate(tables, q_in, times * dq, q);
        bench.Ask(q, 0.05);
      }
    }
  }
  meshes.Print({kOurs, kOursWarm, "FCL", "Coal"});
  lcp.Print({kOurs, "DAQP", "DAQP, setup", "Gauss-Seidel"});
  std::printf("%d steps whose rows conflict, which have only an elastic answer, are left out\n",
              infeasible);
}

// Says which of the libraries that may be there are not.
void ReportMissing() {
#ifndef MJCF_PDG_HAVE_COAL
  std::printf("no Coal: built without it (README.md)\n");
#endif
#ifndef MJCF_PDG_HAVE_DAQP
  std::printf("no DAQP: built without it (README.md)\n");
#endif
}

}  // namespace

int Main(int argc, char** argv) {
  SetArguments arguments;
  CLI::App app("Our own collision code and LCP beside libraries.", "library_bench");
  AddSetArguments(app, arguments);
  return RunProgram(app, argc, argv, [&] {
    ReportMissing();
    Run(arguments);
  });
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) {
  const int status = mjcf_pdg::bench::Main(argc, argv);
  std::fflush(nullptr);
  // Without static destructors: FCL and Coal bring two versions of OctoMap, and both free one map.
  std::quick_exit(status);
}
