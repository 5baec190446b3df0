#include "apps/html/joint_moves.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>

#include "apps/output/joint_moved.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kJoints = 12;  // listed
constexpr double kRounding = 1e-14;  // of the scene's extent: so far has nothing moved that did not

// σ of one term in each frame.
struct Term {
  std::string name;
  std::vector<double> sigma;

  double Largest() const { return *std::max_element(sigma.begin(), sigma.end()); }
};

// To the four digits that pages show: more would fill the file, and be rounded twice.
double Rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::strtod(text, nullptr);
}

// The terms that are anywhere more than rounding errors, the largest in frame `end` first.
std::vector<Term> Terms(const Scene& scene, Metric metric, const std::vector<PageFrame>& frames,
                        std::size_t end) {
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
  const double nothing = std::pow(kRounding * scene.model()->stat.extent, 2);
  std::erase_if(terms, [&](const Term& term) { return !(term.Largest() > nothing); });
  const auto order = [end](const Term& term) { return std::pair(term.sigma[end], term.Largest()); };
  std::stable_sort(terms.begin(), terms.end(),
                   [&](const Term& a, const Term& b) { return order(a) > order(b); });
  if (terms.size() > kJoints) terms.resize(kJoints);
  return terms;
}

}  // namespace

Json PageJoints(const Scene& scene, Metric metric, const std::vector<PageFrame>& frames,
                std::size_t end) {
  const std::map<std::string, int> ids = JointsOfTerms(scene, metric);
  Json list = Json::array();
  for (const Term& term : Terms(scene, metric, frames, end)) {
    Json joint = {{"name", term.name}, {"unit", ""}, {"sigma", Json::array()}};
    for (const double sigma : term.sigma) joint["sigma"].push_back(Rounded(sigma));
    const auto found = ids.find(term.name);
    if (found != ids.end()) {
      const int type = scene.model()->jnt_type[found->second];
      const bool turns = type == mjJNT_HINGE || type == mjJNT_BALL;
      joint["unit"] = turns ? "°" : "mm";
      for (const PageFrame& frame : frames) {
        const double moved = JointMoved(scene, found->second, frames.front().q, frame.q);
        joint["moved"].push_back(Rounded(moved * (turns ? 180.0 / M_PI : 1e3)));
      }
    }
    list.push_back(std::move(joint));
  }
  return list;
}

}  // namespace mjcf_pdg::app
