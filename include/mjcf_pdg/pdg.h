// The front door: generalized penetration depth PDg of a configuration.
//
//   mjcf_pdg::Scene scene = mjcf_pdg::Scene::FromFile("robot.xml");
//   mjcf_pdg::Solver solver(scene);
//   mjcf_pdg::Result result = solver.Solve(q_in);   // result.q is free if result.status says so
//
// Source: Tang & Kim: PDg is the least σ (object norm, Sec. 3.1 and 4) of all free configurations,
// sought as in Sec. 5 (Method::kPaper) or by more starts of the same local steps (Method::kAuto).
// Shapes and units: configurations (nq) in MuJoCo's qpos layout; metres, radians, seconds.
#ifndef MJCF_PDG_PDG_H_
#define MJCF_PDG_PDG_H_

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mjcf_pdg/export.h"
#include "mjcf_pdg/motion.h"
#include "mjcf_pdg/object_norm.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

struct mjData_;
typedef struct mjData_ mjData;

namespace mjcf_pdg {

// What Options::without can name and Result::start may say: the method's starts, then its other
// steps.
MJCF_PDG_API std::vector<std::string> Components(Method method);

// One per thread; has MuJoCo data of its own and never writes to the user's model or data.
class MJCF_PDG_API Solver {
 public:
  // Throws Error if an option is out of range, Options::without has an unknown name, the scene an
  // active equality constraint, or the libmujoco of this process is not the 4.0.x that we were
  // built for.
  explicit Solver(const Scene& scene, const Options& options = {});
  ~Solver();
  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;

  // The free configuration nearest to q_in (nq). A hard case never throws: see Result::status.
  // Throws Error for a bad q_in (size, NaN, zero quaternion), and where the user's model has
  // changed its sizes since the scene was made.
  Result Solve(std::span<const double> q_in);
  // Refills `result`, whose status it returns; q_in may be result.q. Once solver and result have
  // seen problems of this size it allocates nothing on the heap, exact meshes and MuJoCo's own
  // arena excepted.
  Status Solve(std::span<const double> q_in, Result& result);
  // The same at `data`'s qpos, with its mocap poses, which stay set (SetMocap). `data` belongs to
  // the scene's model and is only read. Throws Error if it is null, or an equality constraint
  // active in it.
  Status Solve(const mjData* data, Result& result);
  // `free_hint` counts for this solve alone, beside what SetHint has set: see there.
  Result Solve(const std::vector<double>& q_in,
               const std::optional<std::vector<double>>& free_hint = std::nullopt);

  // Is q (nq) free, by the verifier's word? Nothing else is computed. Throws as Solve does.
  bool IsFree(std::span<const double> q);

  // A configuration (nq) known or hoped to be free, kept until set anew; empty: none. It becomes
  // one of the starts, what is frozen taken from q_in, and if it is free, whatever a solve returns
  // is free. Throws Error as for a bad q_in.
  void SetHint(std::span<const double> q_free);

  // Bounds what each later solve may cost, instead of Options::time_limit. Throws Error for
  // negative numbers or NaN.
  void SetBudget(const Budget& budget);

  // Where the mocap bodies are from now on, instead of Options' poses: position [m] and quaternion
  // (w, x, y, z), 3 and 4 values per body; empty: as in the model. What the solver remembers of
  // earlier frames stays. Throws Error for wrong sizes or values.
  void SetMocap(const std::vector<double>& pos, const std::vector<double>& quat);

  // Forgets every earlier solve (Options::trajectory). Hint, budget and mocap poses stay.
  void Reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Rows of `q` (n × nq, one after the other) over `threads` solvers, at least one; a trajectory is
// solved by one. `done` gets every row's number and result in order, from one thread at a time;
// what it throws ends the batch and is thrown again, false ends it. At most some rows per thread
// wait for a slow one before them. Throws Error as Solver does, with the number of the row.
MJCF_PDG_API void SolveBatch(const Scene& scene, const Options& options, std::span<const double> q,
                             int threads,
                             const std::function<bool(std::size_t, const Result&)>& done);

// What the verifier says of a configuration.
struct Verdict {
  bool free = false;
  bool certified = false;         // every kept pair has a signed distance (no SDF, no height field)
  double min_distance = 0.0;      // as in Result, cut off 1 m beyond the clearance [m]
  double limit_excess = 0.0;      // largest violation of a joint limit [rad or m]
  std::vector<Contact> contacts;  // pairs nearer than `tolerance` or than required, deepest first
  std::string reason;             // what is not free, in words; empty when free
};

// Whether q is free (overlaps of at most `tolerance` beyond what the model or `options.rest`
// allows, joint limits hold to 1e-6), decided by certificates: for each pair a plane that parts the
// two, or else points that show that they overlap. Meshes that collide as triangles are asked of
// FCL, height fields and SDFs of mj_collision. Shares nothing with the solver's own queries. `q_in`
// is the configuration `rest` refers to. Throws Error for a bad q or option.
MJCF_PDG_API Verdict Verify(const Scene& scene, const std::vector<double>& q,
                            const Options& options = {}, const std::vector<double>* q_in = nullptr);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_PDG_H_
