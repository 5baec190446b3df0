// The questions of library_bench. Each is asked of our own code and of the libraries, and each
// answer's time and error go into a table.
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

inline constexpr int kRepeats = 5;  // times that a question is asked; the shortest time counts
// The error of a question without an answer: given up, or infeasible.
inline constexpr double kNoAnswer = std::numeric_limits<double>::infinity();
// Names of the columns that are not libraries. Cold: from scratch; warm: from an answer nearby.
inline constexpr char kOurs[] = "ours, cold", kOursWarm[] = "ours, warm", kMujoco[] = "MuJoCo";

// The shortest wall time of kRepeats calls [s].
double Seconds(const std::function<void()>& ask);

// One row of a table: the answers of one library to all questions of a kind.
struct Score {
  std::vector<double> seconds;  // by question
  double largest_error = 0.0;   // of answers that are not wrong
  int wrong = 0,
      unanswered = 0;  // answers with an error above a limit; questions without an answer

  void Add(double time, double error);
};

// The scores by kind of question and library.
class Table {
 public:
  // Adds an answer. `error` is relative: to the smaller geom's radius, for a step of an LCP to the
  // scene's size. Without an answer it is kNoAnswer.
  void Add(const std::string& kind, const std::string& name, double seconds, double error);
  // Prints the rows in the order of `names`. The first of them is what the others are compared
  // with.
  void Print(const std::vector<std::string>& names) const;

 private:
  std::vector<std::string> kinds_;
  std::map<std::string, std::map<std::string, Score>> scores_;
};

// The libraries that this program was built with; the arguments are those of MakeFcl.
std::vector<std::unique_ptr<Library>> Libraries(const mjModel& m, bool triangles);

// The questions about one scene, which must outlive them like the table.
class Questions {
 public:
  virtual ~Questions() = default;
  virtual void Ask(const VectorXd& q) = 0;  // asks them all at the configuration q
};

// Asks for the signed distance of every convex pair that is near at q.
std::unique_ptr<Questions> ConvexQuestions(const Scene& scene, Table& table);
// Asks of every pair of two triangle meshes whether they overlap, and if not, how far apart they
// are: without a cutoff, and with the cutoff `share_of_radius` times the smaller geom's radius.
std::unique_ptr<Questions> TriangleQuestions(const Scene& scene, double share_of_radius,
                                             Table& table);
// Linearizes at q as the first step of a local optimization does, and asks for the step. If its
// rows conflict, it only increments `infeasible`.
void AskLcp(const Scene& scene, const VectorXd& q, Table& table, int& infeasible);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_LIBRARY_QUESTIONS_H_
