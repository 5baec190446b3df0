// Symbols, options and results of mjcf-pdg.
//
//   q_in, q      configurations in MuJoCo's qpos layout, length nq; unit quaternions (w, x, y, z)
//   dq           a tangent vector, one entry per *movable* degree of freedom, length n <= nv;
//                MuJoCo's conventions (the three of a ball joint are in the body frame, the linear
//                three of a free joint in the world frame)
//   σ            the object norm between q_in and q [m²]; √σ [m] is a root-mean-square displacement
//   r            the norm as a vector [m], σ = ‖r‖²: the paper's X weighted by H, divided by √M
//   X            the paper's variable: 2 sin(Δq/2) (hinge), Δq (slide), Q (ball), Eq. 26
//   Q            vector part of the unit quaternion from q_in to q, in world axes
//   H, M         the norm's metric matrix (Eq. 28), in the code divided by M ([1] for translations,
//                [m²/rad²] for turns), and M, the total mass of what can move [kg]
//   C            contact matrix (m × n), rows nᵀ(J_2 - J_1), Eq. 22-23
//   λ            Lagrange multipliers of the rows of C
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

// How far a search goes before it trusts its best answer. The time of a solve is given in poses,
// each with one collision detection; bench/README.md has measurements.
enum class Effort {
  kFast,     // until a start ends free; tens of poses, for control loops
  kDefault,  // until independent starts agree on the best answer; hundreds of poses
  kMax,      // until many starts agree or it is proven; thousands of poses
};

// How a solve ended.
enum class Status {
  kAlreadyFree,  // q_in was free; q is q_in bit for bit
  kSolved,       // q is free, verified
  kUnsolved,     // q is the least penetrating configuration found; `reason` says why
};

// Why a result is unsolved, by code; Result::reason says it in words.
enum class Cause {
  kNone,         // the result is not unsolved
  kBudget,       // the budget of queries or seconds ended the search before anything was free
  kPermanent,    // pairs overlap in every configuration that was tried, wherever the joints went
  kFrozen,       // pairs overlap that no movable joint can separate
  kEquality,     // an equality constraint or a held tendon limit cannot be held
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

// How far a joint may be outside its range in a configuration that is free [rad or m].
inline constexpr double kLimitTolerance = 1e-6;
// Equality constraints and tendon limits hold if none is violated by more than this [m or rad].
inline constexpr double kEqualityTolerance = 1e-6;

// What a solve, a verdict or a checked motion is asked for. A value out of range is an Error of the
// function that gets the options.
struct Options {
  Metric metric = Metric::kSequential;
  double tolerance = 1e-6;  // overlap that still counts as free [m], 1e-12 to 1
  double clearance = 0.0;   // distance to keep between pairs that can move apart [m], 0 to 1000
  double rest = 0.0;        // contacts of q_in no deeper than this may stay so [m], 0 to 1000
  Method method = Method::kAuto;
  Effort effort = Effort::kDefault;
  // Solves are of consecutive frames of one motion: a solver's earlier answers become starts of
  // later ones (motion coherence). With exact meshes that only free joints move, five frames in a
  // row may end there without a search, but for Effort::kMax. Where no exact meshes are, SolveBatch
  // and the command line follow one optimum instead (mjcf_pdg/trajectory.h).
  bool trajectory = false;
  std::uint64_t seed = 0;  // of the random starts; the same seed gives the same answer
  // Starts and steps of the method that are left out, for experiments: names from Components
  // (pdg.h).
  std::vector<std::string> without = {};
  // Poses of the mocap bodies, which are obstacles: position [m] and quaternion (w, x, y, z), 3 and
  // 4 values per mocap body, in order of mocap id. Empty: as in the model.
  std::vector<double> mocap_pos = {}, mocap_quat = {};
  // Most seconds of one solve, > 0: a guard, since a search normally ends by itself.
  // Solver::SetBudget replaces it.
  double time_limit = std::numeric_limits<double>::infinity();

  // The following cost time and do not change the answer.
  bool report_contacts = false;    // fills Result::contacts_in and contacts
  bool report_lower_bound = true;  // fills sigma_lower_bound even if the search does not need it
  // How far beyond `clearance` distances are measured for Result::depth_in and min_distance [m], 0
  // to 1000. With 0 only what freeness needs is measured.
  double report_distances_to = 0.0;
};

// A pair of geoms that overlap, touch or are nearer than required.
struct Contact {
  std::array<int, 2> geom = {-1, -1};     // ids in the user's model, in MuJoCo's order
  std::array<double, 3> normal_W = {};    // unit vector, from geom 1 to geom 2
  std::array<double, 3> position_W = {};  // midpoint of the two witness points [m]
  double distance = 0.0;                  // signed, negative: an overlap [m]
};

// What a solve took.
struct Stats {
  int iterations = 0;         // local steps of all starts; method paper: constrained optimizations
  int collision_queries = 0;  // each: one configuration, all kept pairs; the verifier's included
  int starts = 0;             // free-configuration selections that were tried
  int lcp_sweeps = 0;         // active-set changes or Gauss-Seidel sweeps of all LCPs
  double seconds = 0.0;       // wall time of the solve with its final verification [s]
};

// What a solve found. If q is free, its σ is an upper bound of PDg; the lower bound is proven.
struct Result {
  Status status = Status::kUnsolved;
  std::vector<double> q;           // nq entries; those of frozen joints are as in q_in
  double sigma = 0.0;              // σ(q_in, q), Eq. 19 or the other metric [m²]
  double sigma_lower_bound = 0.0;  // proven: no free configuration has a smaller σ [m²]
  // The smallest signed distances of all kept pairs at q_in and at q [m], negative for overlaps,
  // cut off at the clearance plus Options::report_distances_to. SDFs, which have no distances,
  // count if they touch. If the options ask for neither contacts nor distances, depth_in of a
  // solved problem is the search's own measure, and a free configuration is not measured: its value
  // is the clearance less the tolerance.
  double depth_in = 0.0;
  double min_distance = 0.0;
  double limit_excess_in = 0.0;  // largest violation of a joint limit by q_in [rad or m]
  // The largest violations of a held equality constraint by q_in and by q [m or rad].
  double equality_residual_in = 0.0, equality_residual = 0.0;
  // How far tendons are outside their ranges at q_in and at q, if SceneOptions::hold_tendon_limits
  // [m; of a fixed tendon in units of its joints times their coefficients].
  double tendon_excess_in = 0.0, tendon_excess = 0.0;
  bool certified = false;      // that q is free rests on signed distances (no SDF)
  std::string start;           // the start that won (name from Components in pdg.h); "none": q_in
  std::string reason;          // why it is unsolved, in words; else empty
  Cause cause = Cause::kNone;  // why it is unsolved, by code
  // The contacts of the verifier's Verdicts at q_in and at q, deepest first, if
  // Options::report_contacts is set.
  std::vector<Contact> contacts_in, contacts;
  int contacts_kept = 0;  // of contacts_in, those whose geoms are still within 1 mm of each other
  // Pairs that are nearer at q than their margin in the model, so that MuJoCo still pushes on them,
  // if the options ask for contacts or distances. SceneOptions::keep_margins leaves none.
  int pushed_pairs = 0;
  bool switched = false;  // Tracker: the answer has left its optimum for another
  // Tracker: where steps are limited, this answer is one of several on the way to another optimum,
  // to a free command, or to its own optimum, behind which it lags; that which arrives counts, too.
  bool under_way = false;
  Stats stats;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_TYPES_H_
