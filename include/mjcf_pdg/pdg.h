// The front door: generalized penetration depth PDg of a configuration.
//
//   mjcf_pdg::Scene scene = mjcf_pdg::Scene::FromFile("robot.xml");
//   mjcf_pdg::Solver solver(scene);
//   mjcf_pdg::Result result = solver.Solve(q_in);   // result.q is free if result.status says so
#ifndef MJCF_PDG_PDG_H_
#define MJCF_PDG_PDG_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mjcf_pdg/object_norm.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

// What Options::without can name: the method's starts, then its other steps.
std::vector<std::string> Components(Method method);

// One per thread; has MuJoCo data of its own and never writes to the user's model. Solve allocates:
// its result, and small arrays as it goes.
class Solver {
 public:
  // Throws Error if an option is out of range, Options::without has an unknown name, or the scene
  // an active equality constraint.
  explicit Solver(const Scene& scene, const Options& options = {});
  ~Solver();
  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;

  // The free configuration nearest to q_in (nq). A hard case never throws: see Result::status.
  // `free_hint`, a configuration known or hoped to be free, becomes one of the starts.
  // Throws Error for a bad q_in (size, NaN, zero quaternion).
  Result Solve(const std::vector<double>& q_in,
               const std::optional<std::vector<double>>& free_hint = std::nullopt);

  // Where the mocap bodies are from now on, instead of Options' poses: 3 and 4 values per body;
  // empty: as in the model. What the solver remembers of earlier frames stays. Throws Error for
  // wrong sizes or values.
  void SetMocap(const std::vector<double>& pos, const std::vector<double>& quat);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct Verdict {
  bool free = false;
  bool certified = false;         // every kept pair has a signed distance (no SDF, no height field)
  double min_distance = 0.0;      // as in Result [m]
  double limit_excess = 0.0;      // largest violation of a joint limit [rad or m]
  std::vector<Contact> contacts;  // pairs nearer than `tolerance` or than required, deepest first
  std::string reason;             // what is not free, in words; empty when free
};

// Whether q is free (overlaps of at most `tolerance` beyond what the model or `options.rest` allows,
// joint limits hold to 1e-6), decided by certificates: for each pair a plane that parts the two, or
// else points that show that they overlap. Meshes that collide as triangles are asked of FCL,
// height fields and SDFs of mj_collision. Shares nothing with the solver's own queries. `q_in` is
// the configuration `rest` refers to. Throws Error for a bad q or option.
Verdict Verify(const Scene& scene, const std::vector<double>& q, const Options& options = {},
               const std::vector<double>* q_in = nullptr);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_PDG_H_
