// Symbols, options and results of mjcf-pdg.
//
//   q_in, q      configurations in MuJoCo's qpos layout, length nq; unit quaternions (w, x, y, z)
//   dq           a tangent vector, one entry per *movable* degree of freedom, length n <= nv;
//                MuJoCo's conventions (a ball's three are body-frame, a free joint's linear three
//                world-frame)
//   σ            the object norm between q_in and q [m²]; √σ [m] reads as a root-mean-square motion
//   r            residual of the norm, σ = ‖r‖²: the paper's X weighted by H, divided by √M [m]
//   X            the paper's variable: 2 sin(Δq/2) (hinge), Δq (slide), Q (ball), Eq. 26
//   Q            vector part of a relative unit quaternion, world axes
//   H, M         the norm's metric (Eq. 28) and the total mass that can move [kg]
//   C            contact matrix (m × n), rows nᵀ(J_2 - J_1), Eq. 22-23
//   λ            multipliers of the rows of C
//   p_W, n_W     a point [m] and a unit normal in world axes; n_W points from geom 1 to geom 2
//   d            signed distance of a pair of geoms [m], negative when they overlap
#ifndef MJCF_PDG_TYPES_H_
#define MJCF_PDG_TYPES_H_

#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "mjcf_pdg/export.h"

namespace mjcf_pdg {

// Bad input: a file, a name, a size, a value. The message is one line that says what and where.
class MJCF_PDG_API Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// How σ measures a change of configuration.
enum class Metric {
  kSequential,    // the paper's: joints change one after the other, base to terminal (Eq. 13-19)
  kDisplacement,  // the true mean squared displacement (1/M) ∫ ‖x(q) - x(q_in)‖² dm
};

// How the nearest free configuration is sought.
enum class Method {
  kAuto,   // a search over many starts: what measures best
  kPaper,  // the paper's sequence of steps (Sec. 5), from one free configuration
};

// How far a search goes before it trusts its best answer; the time is about that of as many poses
// with collision detection. bench/README.md has measurements.
enum class Effort {
  kFast,     // the first start that ends free: tens of poses, for control loops
  kDefault,  // until independent starts agree: hundreds
  kMax,      // until many do: thousands
};

// How a solve ended.
enum class Status {
  kAlreadyFree,  // q_in was free; q is q_in bit for bit
  kSolved,       // q is free, verified
  kUnsolved,     // q is the least penetrating configuration found; `reason` says why
};

// Why a result is unsolved, by code; Result::reason says it in words.
enum class Cause {
  kNone,         // it is not
  kBudget,       // the budget of queries or seconds ended the search before anything was free
  kPermanent,    // pairs overlap in every configuration that was tried, wherever the joints went
  kFrozen,       // pairs overlap that no movable joint can part
  kEquality,     // an equality constraint cannot be held
  kNotVerified,  // the search calls a configuration free that the verifier does not
  kNotFound,     // the search ended without a free configuration
};

// What one solve may cost; what comes first ends it. 0: no bound. With a bound on queries alone
// answers repeat; seconds are a guard against the clock. A search ends at most one collision query
// and one LCP after its budget. The query that verifies its answer comes on top, or, if it has
// none, those that tell how deep q_in and what is returned overlap, three at most.
struct Budget {
  int queries = 0;       // as Stats::collision_queries counts them
  double seconds = 0.0;  // [s]
};

// What a solve, a verdict or a checked motion is asked for. Out of range: Error where it is used.
struct Options {
  Metric metric = Metric::kSequential;
  double tolerance = 1e-6;  // overlap that still counts as free [m], 1e-12 to 1
  double clearance = 0.0;   // distance to keep between pairs that can move apart [m], 0 to 1000
  double rest = 0.0;        // contacts of q_in no deeper may keep their depth [m], 0 to 1000
  Method method = Method::kAuto;
  Effort effort = Effort::kDefault;
  // Calls of Solve are consecutive frames of one motion: a solver's earlier answers are starts of
  // later ones (motion coherence). Where free bodies of exact meshes are all that moves, a frame
  // that moved little may end there: five in a row at most, none with effort max.
  bool trajectory = false;
  std::uint64_t seed = 0;  // of the random starts: the same seed, the same answer
  // Starts and steps of the method to leave out, for experiments: names from Components (pdg.h).
  std::vector<std::string> without = {};
  // Poses of mocap bodies, which are obstacles: position [m] and quaternion (w, x, y, z), 3 and 4
  // per body in order of mocap id; empty: as in the model.
  std::vector<double> mocap_pos, mocap_quat;
  // Outer guard on one solve [s], > 0; iterations, not this, normally end it. A solver's first
  // budget (Solver::SetBudget).
  double time_limit = std::numeric_limits<double>::infinity();

  // What costs time and is not always wanted. The answer does not depend on these.
  bool report_contacts = false;    // Result::contacts_in and contacts
  bool report_lower_bound = true;  // Result::sigma_lower_bound where the search does without
  // Pairs that are apart are measured up to this far beyond `clearance` for Result::depth_in and
  // min_distance; by default only what freeness needs [m], 0 to 1000.
  double report_distances_to = 0.0;
};

// One pair of geoms that overlap or touch.
struct Contact {
  std::array<int, 2> geom = {-1, -1};     // ids in the user's model, in MuJoCo's order
  std::array<double, 3> normal_W = {};    // unit, from geom 1 to geom 2
  std::array<double, 3> position_W = {};  // midpoint of the two witness points [m]
  double distance = 0.0;                  // signed [m]
};

// What a solve took.
struct Stats {
  int iterations = 0;         // local steps of all starts; method paper: constrained optimizations
  int collision_queries = 0;  // one configuration against all kept pairs each, verifier included
  int starts = 0;             // free-configuration selections tried
  int lcp_sweeps = 0;         // active-set changes or Gauss-Seidel sweeps
  double seconds = 0.0;       // wall time of the solve with its final verification [s]
};

// What a solve found: an upper bound of PDg, which σ of q is, and a lower one.
struct Result {
  Status status = Status::kUnsolved;
  std::vector<double> q;           // nq; what is frozen is as in q_in
  double sigma = 0.0;              // σ(q_in, q), Eq. 19 or the other metric [m²]
  double sigma_lower_bound = 0.0;  // proven: no free configuration has a smaller σ [m²]
  // Smallest signed distances of kept pairs at q_in and at q, negative where they overlap, cut off
  // at the clearance and Options::report_distances_to [m]. Height fields and SDFs, which have no
  // distances, count where they touch. Where neither contacts nor distances are to be reported,
  // depth_in is the search's own measure, and what is free is not measured: the required distance.
  double depth_in = 0.0;
  double min_distance = 0.0;
  double limit_excess_in = 0.0;  // largest violation of a joint limit by q_in [rad or m]
  bool certified = false;      // freeness rests on signed distances alone (no SDF, no height field)
  std::string start;           // name of the start that won (Components in pdg.h); "none": q_in
  std::string reason;          // why not solved, in words; empty otherwise
  Cause cause = Cause::kNone;  // ... and by code
  // With Options::report_contacts. Deepest first: at q_in the Verdict's, at q pairs nearer than
  // required, or than ten tolerances more.
  std::vector<Contact> contacts_in, contacts;
  Stats stats;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_TYPES_H_
