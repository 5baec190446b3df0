#include "verify/findings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/names.h"

namespace mjcf_pdg::verify {
namespace {

constexpr std::size_t kNamed = 4;  // most findings that a reason names; it counts the rest

std::string GeomLabel(const mjModel& m, int geom) { return "geom " + QuotedNameOrPlace(m, geom); }

std::string Number(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3g %s", value, unit);
  return text;
}

std::string Millimetres(double length) { return Number(1e3 * length, "mm"); }

std::string Describe(const mjModel& m, const Finding& finding) {
  const auto [geom1, geom2] = finding.contact.geom;
  const double distance = finding.contact.distance;
  std::string text = GeomLabel(m, geom1) + " and " + GeomLabel(m, geom2);
  if (distance < 0.0) {
    text += " overlap by " + Millimetres(-distance);
    if (finding.required < 0.0) text += " (" + Millimetres(-finding.required) + " allowed)";
  } else {
    text +=
        " are " + Millimetres(distance) + " apart (" + Millimetres(finding.required) + " required)";
  }
  if (finding.unproven)
    text += " as far as can be told: neither a plane nor a common point shows it";
  if (finding.frozen) text += " and no movable joint can part them";
  return text;
}

std::string Describe(const mjModel& m, const LimitExcess& limit) {
  return "joint " + QuotedNameOrId(m, mjOBJ_JOINT, limit.joint) + " is " +
         Number(limit.excess, m.jnt_type[limit.joint] == mjJNT_SLIDE ? "m" : "rad") +
         " outside its range";
}

std::string Describe(const mjModel& m, const EqualityExcess& excess) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", excess.residual);
  return "equality constraint " + QuotedNameOrId(m, mjOBJ_EQUALITY, excess.equality) +
         " is violated by " + text;
}

std::string Describe(const mjModel& m, const TendonExcess& excess) {
  char text[96];
  std::snprintf(text, sizeof text, " has length %.4g, outside its range %.4g ... %.4g by %.3g",
                excess.length, m.tendon_range[2 * excess.tendon],
                m.tendon_range[2 * excess.tendon + 1], excess.excess);
  return "tendon " + QuotedNameOrId(m, mjOBJ_TENDON, excess.tendon) + text;
}

}  // namespace

void Findings::Clear() {
  pairs.clear();
  limits.clear();
  equalities.clear();
  tendons.clear();
  arena_full = false;
}

void SetPlace(const Eigen::Vector3d& n_W, const Eigen::Vector3d& p1_W, const Eigen::Vector3d& p2_W,
              Contact& contact) {
  Eigen::Map<Eigen::Vector3d>(contact.normal_W.data()) = n_W;
  Eigen::Map<Eigen::Vector3d>(contact.position_W.data()) = 0.5 * (p1_W + p2_W);
}

void SetFromContact(const mjContact& source, Contact& contact) {
  const double sign = source.geom[0] == contact.geom[0] ? 1.0 : -1.0;
  for (int k = 0; k < 3; ++k) {
    contact.normal_W[k] = sign * source.frame[k];
    contact.position_W[k] = source.pos[k];
  }
  contact.distance = source.dist;
}

void WriteVerdict(const mjModel& m, Words words, Findings& findings, Verdict& verdict) {
  std::vector<Finding>& pairs = findings.pairs;
  verdict.contacts.clear();
  verdict.reason.clear();
  std::sort(pairs.begin(), pairs.end(), [](const Finding& a, const Finding& b) {
    return a.contact.distance < b.contact.distance;
  });
  for (const Finding& finding : pairs) verdict.contacts.push_back(finding.contact);
  std::size_t count = 0;
  const auto add = [&](auto&& describe) {
    if (count++ >= kNamed || words == Words::kSkipped) return;
    verdict.reason += (verdict.reason.empty() ? "" : "; ") + describe();
  };
  if (findings.arena_full) {
    add([] { return std::string("MuJoCo's memory for contacts is full: not verified"); });
  }
  for (const bool frozen : {true, false}) {  // pairs that no joint can separate come first
    for (const Finding& finding : pairs) {
      if (finding.violates && finding.frozen == frozen) add([&] { return Describe(m, finding); });
    }
  }
  for (const LimitExcess& limit : findings.limits) add([&] { return Describe(m, limit); });
  for (const EqualityExcess& excess : findings.equalities) add([&] { return Describe(m, excess); });
  for (const TendonExcess& excess : findings.tendons) add([&] { return Describe(m, excess); });
  if (count > kNamed && words == Words::kWritten) {
    verdict.reason += "; and " + std::to_string(count - kNamed) + " more";
  }
  verdict.free = count == 0;
}

}  // namespace mjcf_pdg::verify
