#include "answers.h"

#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "arrays.h"

namespace mjcf_pdg::python {
namespace {

const char* NameOf(MotionOutcome outcome) {
  switch (outcome) {
    case MotionOutcome::kFree:
      return "free";
    case MotionOutcome::kContact:
      return "contact";
    case MotionOutcome::kStartInCollision:
      return "start_in_collision";
    case MotionOutcome::kLimit:
      return "limit";
    case MotionOutcome::kBudget:
      break;
  }
  return "budget";
}

nb::object Vector(const std::array<double, 3>& v) {
  return Array(std::vector<double>(v.begin(), v.end()));
}

nb::list ToList(const Scene& scene, const std::vector<Contact>& contacts) {
  nb::list list;
  for (const Contact& contact : contacts) {
    nb::dict one;
    one["geom1"] = GeomOf(scene, contact.geom[0]);
    one["geom2"] = GeomOf(scene, contact.geom[1]);
    one["normal"] = Vector(contact.normal_W);
    one["position"] = Vector(contact.position_W);
    one["distance"] = contact.distance;
    list.append(one);
  }
  return list;
}

}  // namespace

const char* NameOf(Status status) {
  switch (status) {
    case Status::kAlreadyFree:
      return "already_free";
    case Status::kSolved:
      return "solved";
    case Status::kUnsolved:
      break;
  }
  return "unsolved";
}

const char* NameOf(Cause cause) {
  switch (cause) {
    case Cause::kNone:
      return "";
    case Cause::kBudget:
      return "budget";
    case Cause::kPermanent:
      return "permanent";
    case Cause::kFrozen:
      return "frozen";
    case Cause::kEquality:
      return "equality";
    case Cause::kNotVerified:
      return "not_verified";
    case Cause::kNotFound:
      break;
  }
  return "not_found";
}

bool IsProven(const Result& result) {
  constexpr double kProvenRatio = 1.01;
  return result.status != Status::kUnsolved &&
         result.sigma <= kProvenRatio * result.sigma_lower_bound;
}

nb::object GeomOf(const Scene& scene, int geom) {
  const char* const name = mj_id2name(scene.model(), mjOBJ_GEOM, geom);
  return name && *name ? nb::object(Text(name)) : nb::object(nb::int_(geom));
}

nb::dict ToDict(const Scene& scene, std::vector<double> q_in, const Result& result) {
  nb::dict d;
  d["status"] = NameOf(result.status);
  d["q_in"] = Array(std::move(q_in));
  d["q"] = Array(result.q);
  d["sigma"] = result.sigma;
  d["rms"] = std::sqrt(result.sigma);
  d["sigma_lower_bound"] = result.sigma_lower_bound;
  d["depth_in"] = result.depth_in;
  d["min_distance"] = result.min_distance;
  d["limit_excess_in"] = result.limit_excess_in;
  d["equality_residual_in"] = result.equality_residual_in;
  d["equality_residual"] = result.equality_residual;
  d["tendon_excess_in"] = result.tendon_excess_in;
  d["tendon_excess"] = result.tendon_excess;
  d["contacts_kept"] = result.contacts_kept;
  d["pushed_pairs"] = result.pushed_pairs;
  d["switched"] = result.switched;
  d["under_way"] = result.under_way;
  d["certified"] = result.certified;
  d["proven"] = IsProven(result);
  d["start"] = Text(result.start);
  d["cause"] = NameOf(result.cause);
  d["reason"] = Text(result.reason);
  d["iterations"] = result.stats.iterations;
  d["queries"] = result.stats.collision_queries;
  d["seconds"] = result.stats.seconds;
  d["contacts_in"] = ToList(scene, result.contacts_in);
  d["contacts"] = ToList(scene, result.contacts);
  return d;
}

nb::dict ToDict(const Scene& scene, const Verdict& verdict) {
  nb::dict d;
  d["free"] = verdict.free;
  d["certified"] = verdict.certified;
  d["min_distance"] = verdict.min_distance;
  d["limit_excess"] = verdict.limit_excess;
  d["equality_residual"] = verdict.equality_residual;
  d["tendon_excess"] = verdict.tendon_excess;
  d["pushed_pairs"] = verdict.pushed_pairs;
  d["contacts"] = ToList(scene, verdict.contacts);
  d["reason"] = Text(verdict.reason);
  return d;
}

nb::dict ToDict(const Scene& scene, const Motion& motion) {
  nb::list pairs;
  for (const std::array<int, 2>& pair : motion.pairs) {
    pairs.append(nb::make_tuple(GeomOf(scene, pair[0]), GeomOf(scene, pair[1])));
  }
  nb::dict d;
  d["outcome"] = NameOf(motion.outcome);
  d["t"] = motion.t;
  d["q"] = Array(motion.q);
  d["certified"] = motion.certified;
  d["pairs"] = pairs;
  d["joint"] = motion.joint < 0 ? nb::none() : nb::object(Text(scene.JointName(motion.joint)));
  d["poses"] = motion.poses;
  d["distance_queries"] = motion.distance_queries;
  return d;
}

}  // namespace mjcf_pdg::python
