// The questions of library_bench: asked of our own code and of the libraries, each answer's time
// and error into a table.
#ifndef MJCF_PDG_BENCH_LIBRARY_QUESTIONS_H_
#define MJCF_PDG_BENCH_LIBRARY_QUESTIONS_H_

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "library/library.h"
#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"

namespace mjcf_pdg::bench {

inline constexpr int kRepeats = 5;  // of each question; the shortest time counts
// Not answered: given up, or infeasible.
inline constexpr double kNoAnswer = std::numeric_limits<double>::infinity();
inline constexpr char kOurs[] = "ours, cold", kOursWarm[] = "ours, warm", kMujoco[] = "MuJoCo";

double Seconds(const std::function<void()>& ask);

// One row of a table: how one library did on all questions of a kind.
struct Score {
  std::vector<double> seconds;
  double largest_error = 0.0;  // of those that are neither wrong nor unanswered
  int wrong = 0, unanswered = 0;

  void Add(double time, double error);
};

// By kind of question, then by library in the order of `names`.
class Table {
 public:
  void Add(const std::string& kind, const std::string& name, double seconds, double error);
  void Print(const std::vector<std::string>& names) const;

 private:
  std::vector<std::string> kinds_;
  std::map<std::string, std::map<std::string, Score>> scores_;
};

// Those that this program was built with.
std::vector<std::unique_ptr<Library>> Libraries(const mjModel& m, bool triangles);

// The questions of one scene.
class Questions {
 public:
  virtual ~Questions() = default;
  virtual void Ask(const VectorXd& q) = 0;
};

// Distances: every convex pair that is near at q, asked of all.
std::unique_ptr<Questions> ConvexQuestions(const Scene& scene, Table& table);
// Pairs of two triangle meshes: do they overlap; if not, how far apart are they, and is that less
// than `share_of_radius` of the smaller geom's radius?
std::unique_ptr<Questions> TriangleQuestions(const Scene& scene, double share_of_radius,
                                             Table& table);
// Linearizes at q as a local optimization's first step does, and asks for the step. Rows that
// conflict are counted instead.
void AskLcp(const Scene& scene, const VectorXd& q, Table& table, int& infeasible);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_LIBRARY_QUESTIONS_H_
