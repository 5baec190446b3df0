// The header that most programs include: generalized penetration depth PDg of a configuration.
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
#include "mjcf_pdg/observer.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/tracker.h"
#include "mjcf_pdg/types.h"

struct mjData_;
typedef struct mjData_ mjData;

namespace mjcf_pdg {

// The names that Options::without accepts: the method's starts, which Result::start may name, then
// its other steps.
MJCF_PDG_API std::vector<std::string> Components(Method method);

// Finds nearest free configurations of one scene. Use one solver per thread; it has MuJoCo data of
// its own and never writes to the user's model or data.
class MJCF_PDG_API Solver {
 public:
  // Throws Error if an option is out of range, if Options::without has an unknown name, if method
  // paper is to hold equality constraints, or if the libmujoco of this process is not the 4.0.x
  // that this library was built for.
  explicit Solver(const Scene& scene, const Options& options = {});
  ~Solver();
  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;

  // Returns the nearest free configuration to q_in (nq entries) that the search finds. Not finding
  // any is no error: see Result::status. Throws Error for a bad q_in (size, NaN, zero quaternion),
  // and if the user's model has changed its sizes since the scene was made.
  Result Solve(std::span<const double> q_in);
  // Writes the result to `result` and returns its status; q_in may be result.q. Once solver and
  // result have seen problems of this size, the call allocates nothing on the heap, except for
  // exact meshes and MuJoCo's own arena.
  Status Solve(std::span<const double> q_in, Result& result);
  // Solves for the qpos of `data`, after SetMocap with its mocap poses and with the equality
  // constraints that are active in it; both stay set. `data` must belong to the scene's model and
  // is only read. Also throws Error if `data` is null.
  Status Solve(const mjData* data, Result& result);
  // Solves for q_in with `free_hint` as a hint for this call alone, beside the one of SetHint.
  Result Solve(const std::vector<double>& q_in,
               const std::optional<std::vector<double>>& free_hint = std::nullopt);

  // True if the verifier finds q (nq entries) free. Nothing else is computed. Throws as Solve does.
  bool IsFree(std::span<const double> q);

  // Sets a configuration (nq entries) that is known or hoped to be free, for all later solves; an
  // empty one removes it. It becomes one of the starts, with frozen joints taken from q_in. If that
  // start is free, whatever a solve returns is free. Throws Error as for a bad q_in.
  void SetHint(std::span<const double> q_free);

  // Limits what each later solve may cost, in place of Options::time_limit. Throws Error for
  // negative numbers or NaN.
  void SetBudget(const Budget& budget);

  // Sets the poses of the mocap bodies for all later solves, in place of those of Options: position
  // [m] and quaternion (w, x, y, z), 3 and 4 values per mocap body, in order of mocap id. An empty
  // vector leaves them as in the model. What the solver remembers of earlier frames stays. Throws
  // Error for wrong sizes or values.
  void SetMocap(const std::vector<double>& pos, const std::vector<double>& quat);

  // Lets `observer` watch the iterations of all later solves; an empty one ends that. Answers do
  // not change. Descents on the convex hulls of exact meshes, which only make a start, are not
  // told.
  void SetObserver(Observer observer);

  // Forgets every earlier solve, which matters with Options::trajectory. Hint, budget, mocap
  // poses and active equality constraints stay.
  void Reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Solves the rows of `q` (n × nq values, row by row) with one solver on each of `threads` threads;
// `threads` is at least 1, and a trajectory is solved by one. `done` gets each row's number and
// result, in order of rows, from one thread at a time. If it returns false the batch ends; if it
// throws, the batch ends and throws the same. At most 128 rows per thread are solved ahead of the
// next one in order. Throws Error as Solver does; that of a bad row says its number, and no row is
// solved then.
MJCF_PDG_API void SolveBatch(const Scene& scene, const Options& options, std::span<const double> q,
                             int threads,
                             const std::function<bool(std::size_t, const Result&)>& done);

// What the verifier says of a configuration.
struct Verdict {
  bool free = false;
  bool certified = false;          // every kept pair has a signed distance (no SDF)
  double min_distance = 0.0;       // as in Result, but cut off 1 m beyond the clearance [m]
  double limit_excess = 0.0;       // largest violation of a joint limit [rad or m]
  double equality_residual = 0.0;  // largest violation of a held equality constraint [m or rad]
  double tendon_excess = 0.0;      // as in Result
  int pushed_pairs = 0;            // as in Result
  // Pairs that are nearer than the tolerance or than required, deepest first.
  std::vector<Contact> contacts;
  std::string reason;  // what is not free, in words; empty if all is free
};

// Decides whether q is free: joint limits hold within kLimitTolerance, equality constraints and
// tendon limits that are held within kEqualityTolerance, and every kept pair keeps
// its required distance within `tolerance`. That is the clearance or, if it is larger, the margin
// of SceneOptions::keep_margins (0 for pairs that no movable joint can separate), less the overlap
// that the model or `options.rest` allows. A pair is decided by a certificate: a plane that
// separates the two geoms, or points that show that they are too near; of a height field, by such a
// plane for each prism below a triangle of its surface. FCL decides for meshes that collide as
// their triangles; for SDFs mj_collision and their own functions, sampled, which proves nothing
// (`certified`). No code is shared with the solver's own queries. `q_in`
// is the configuration whose contacts `options.rest` refers to; null: no contact rests. Throws
// Error for a bad q or option.
MJCF_PDG_API Verdict Verify(const Scene& scene, const std::vector<double>& q,
                            const Options& options = {}, const std::vector<double>* q_in = nullptr);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_PDG_H_
