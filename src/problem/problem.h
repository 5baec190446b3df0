// One penetration-depth problem: what every stage of a solve shares.
#ifndef MJCF_PDG_SRC_PROBLEM_PROBLEM_H_
#define MJCF_PDG_SRC_PROBLEM_PROBLEM_H_

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

#include "collide/contacts.h"
#include "mjcf_pdg/types.h"
#include "norm/norm_evaluator.h"

namespace mjcf_pdg {

// All lengths of the solver follow from the user's tolerance.
struct Tolerances {
  explicit Tolerances(double tolerance)
      : user(tolerance), aim(tolerance - std::max(0.2 * tolerance, 0.6e-6)) {
    aim = std::max(aim, 0.0);
    accept = 0.5 * (user + aim);
  }
  double user;    // overlap that counts as free [m]
  double aim;     // overlap the local optimization aims at: inside, MuJoCo's distances jitter [m]
  double accept;  // overlap it accepts [m]
};

struct Problem {
  Problem(const SceneTables& scene_tables, const Options& user_options)
      : tables(scene_tables),
        options(user_options),
        tolerances(user_options.tolerance),
        norm(scene_tables, user_options.metric),
        finder(scene_tables, user_options.clearance) {}

  const SceneTables& tables;
  const Options& options;
  Tolerances tolerances;
  NormEvaluator norm;  // reference q_in
  ContactFinder finder;
  MocapPoses mocap;
  VectorXd q_in;                   // normalized
  VectorXd required;               // per kept pair: smallest distance that counts as free [m]
  double size = 1.0;               // a typical geom radius: the scene's size [m]
  int input_distances = 0;         // pair distances that a query without margin takes at q_in
  double sigma_lower_bound = 0.0;  // of every free configuration, see lower_bound.h [m²]
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

  // No pair that can move is nearer than required, by the solver's own distances. One query.
  bool Free(const VectorXd& q) {
    finder.Pose(q);
    const std::vector<NearPair>& near = finder.Find(options.clearance, Depths::kSkipped);
    return std::none_of(near.begin(), near.end(),
                        [this](const NearPair& n) { return Overlaps(n, tolerances.accept); });
  }
  // Pairs nearer than required at q_in. One query.
  std::vector<NearPair> OverlapsAtInput() {
    std::vector<NearPair> overlaps;
    const std::int64_t before = finder.distances();
    finder.Pose(q_in);
    for (const NearPair& near : finder.Find(options.clearance + options.tolerance)) {
      // What cannot be mended counts only if it cannot be accepted either.
      const double accepted = tables.pairs[near.pair].moves ? 0.0 : options.tolerance;
      if (near.distance < required[near.pair] - accepted) overlaps.push_back(near);
    }
    input_distances = static_cast<int>(finder.distances() - before);
    return overlaps;
  }

  // The pair can move and is nearer than required by more than `accepted` [m].
  bool Overlaps(const NearPair& near, double accepted) const {
    return tables.pairs[near.pair].moves && near.distance < required[near.pair] - accepted;
  }

  // False for what Options::without names.
  bool Uses(const char* component) const {
    const auto& without = options.without;
    return std::find(without.begin(), without.end(), component) == without.end();
  }

  // The outer guard on time; without a limit the clock is never read.
  bool Expired() const {
    return deadline != std::chrono::steady_clock::time_point::max() &&
           std::chrono::steady_clock::now() > deadline;
  }
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_PROBLEM_H_
