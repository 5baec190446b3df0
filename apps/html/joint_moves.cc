#include "apps/html/joint_moves.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kJoints = 12;  // listed

// σ of one term in each frame.
struct Term {
  std::string name;
  std::vector<double> sigma;

  double Largest() const { return *std::max_element(sigma.begin(), sigma.end()); }
};

// Pages show four digits; more would only fill the file.
double Rounded(double value) {
  if (value == 0.0) return 0.0;
  const double scale = std::pow(10.0, 5.0 - std::ceil(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

// How far joint j is from its place in q_in [rad or m].
double Moved(const mjModel& m, int j, const std::vector<double>& q_in,
             const std::vector<double>& q) {
  const int at = m.jnt_qposadr[j];
  const int type = m.jnt_type[j];
  if (type == mjJNT_HINGE || type == mjJNT_SLIDE) return q[at] - q_in[at];
  if (type == mjJNT_FREE)
    return std::hypot(q[at] - q_in[at], q[at + 1] - q_in[at + 1], q[at + 2] - q_in[at + 2]);
  double dot = 0.0;
  for (int k = 0; k < 4; ++k) dot += q[at + k] * q_in[at + k];
  return 2.0 * std::acos(std::min(1.0, std::abs(dot)));
}

// The terms that are anywhere more than nothing, the largest first.
std::vector<Term> Terms(const Scene& scene, Metric metric, const std::vector<PageFrame>& frames) {
  ObjectNorm norm(scene, metric, frames.front().q);
  std::vector<Term> terms;
  for (const PageFrame& frame : frames) {
    const std::vector<NormPart> parts = norm.Parts(frame.q);
    terms.resize(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      terms[k].name = parts[k].name;
      terms[k].sigma.push_back(parts[k].sigma);
    }
  }
  std::erase_if(terms, [](const Term& term) { return !(term.Largest() > 0.0); });
  std::stable_sort(terms.begin(), terms.end(),
                   [](const Term& a, const Term& b) { return a.Largest() > b.Largest(); });
  if (terms.size() > kJoints) terms.resize(kJoints);
  return terms;
}

}  // namespace

Json PageJoints(const Scene& scene, Metric metric, const std::vector<PageFrame>& frames) {
  const mjModel& m = *scene.model();
  std::map<std::string, int> ids;
  if (metric == Metric::kSequential) {  // the terms of the other are bodies
    for (int j = 0; j < m.njnt; ++j) ids[scene.JointName(j)] = j;
  }
  Json list = Json::array();
  for (const Term& term : Terms(scene, metric, frames)) {
    Json joint = {{"name", term.name}, {"unit", ""}, {"sigma", Json::array()}};
    for (const double sigma : term.sigma) joint["sigma"].push_back(Rounded(sigma));
    const auto found = ids.find(term.name);
    if (found != ids.end()) {
      const int type = m.jnt_type[found->second];
      const bool turns = type == mjJNT_HINGE || type == mjJNT_BALL;
      joint["unit"] = turns ? "°" : "mm";
      for (const PageFrame& frame : frames) {
        const double moved = Moved(m, found->second, frames.front().q, frame.q);
        joint["moved"].push_back(Rounded(moved * (turns ? 180.0 / M_PI : 1e3)));
      }
    }
    list.push_back(std::move(joint));
  }
  return list;
}

}  // namespace mjcf_pdg::app
