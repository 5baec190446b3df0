#include "verify/verify_findings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/names.h"
#include "model/kinematics.h"

namespace mjcf_pdg {
namespace {

constexpr std::size_t kNamed = 4;  // findings named in a reason

std::string GeomLabel(const mjModel& m, int geom) {
  const std::string name = QuotedNameOrId(m, mjOBJ_GEOM, geom);
  if (name[0] != '#') return "geom " + name;
  return "geom " + name + " (body " + QuotedNameOrId(m, mjOBJ_BODY, m.geom_bodyid[geom]) + ")";
}

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
  if (finding.frozen) text += " and no movable joint can part them";
  return text;
}

}  // namespace

void FillFromContact(const mjContact& source, Contact& contact) {
  const double sign = source.geom[0] == contact.geom[0] ? 1.0 : -1.0;
  for (int k = 0; k < 3; ++k) {
    contact.normal_W[k] = sign * source.frame[k];
    contact.position_W[k] = source.pos[k];
  }
  contact.distance = source.dist;
}

void FillFromWitnesses(const mjData& d, double distance, const double fromto[6], Contact& contact) {
  const Vector3d p1 = AsVector(fromto), p2 = AsVector(fromto + 3);
  Vector3d n = (p2 - p1) * (distance < 0.0 ? -1.0 : 1.0);
  if (n.norm() < kNoDirection) {
    n = AsVector(d.geom_xpos + 3 * contact.geom[1]) - AsVector(d.geom_xpos + 3 * contact.geom[0]);
  }
  if (!(n.norm() > 0.0)) n = Vector3d::UnitZ();
  Eigen::Map<Vector3d>(contact.normal_W.data()) = n.normalized();
  Eigen::Map<Vector3d>(contact.position_W.data()) = 0.5 * (p1 + p2);
  contact.distance = distance;
}

std::string DescribeExcess(const mjModel& m, int joint, double excess) {
  return "joint " + QuotedNameOrId(m, mjOBJ_JOINT, joint) + " is " +
         Number(excess, m.jnt_type[joint] == mjJNT_SLIDE ? "m" : "rad") + " outside its range";
}

void WriteVerdict(const mjModel& m, bool arena_full, std::vector<Finding>& findings,
                  const std::vector<std::string>& limit_reasons, Verdict& verdict) {
  std::sort(findings.begin(), findings.end(), [](const Finding& a, const Finding& b) {
    return a.contact.distance < b.contact.distance;
  });
  for (const Finding& finding : findings) verdict.contacts.push_back(finding.contact);
  // In the reason, what cannot be helped comes first.
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.frozen > b.frozen; });
  std::size_t count = 0;
  auto add = [&](const std::string& text) {
    if (count++ < kNamed) verdict.reason += (verdict.reason.empty() ? "" : "; ") + text;
  };
  if (arena_full) add("MuJoCo's memory for contacts is full: not verified");
  for (const Finding& finding : findings) {
    if (finding.violates) add(count < kNamed ? Describe(m, finding) : std::string());
  }
  for (const std::string& text : limit_reasons) add(text);
  if (count > kNamed) verdict.reason += "; and " + std::to_string(count - kNamed) + " more";
  verdict.free = count == 0;
}

}  // namespace mjcf_pdg
