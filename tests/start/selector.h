// A scene whose selections of starts (start/selection.h) are asked one by one.
#ifndef MJCF_PDG_TESTS_START_SELECTOR_H_
#define MJCF_PDG_TESTS_START_SELECTOR_H_

#include <algorithm>
#include <string>
#include <vector>

#include "start/selection.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

struct Selector {
  Selector(const std::string& xml, const VectorXd& q_in = {})
      : scene(Scene::FromString(xml)), work(scene.tables(), options) {
    work.Begin(q_in.size() > 0 ? q_in : ToEigen(scene.DefaultQpos()));
  }

  std::vector<VectorXd> Translations() {
    work.finder.Pose(work.problem().q_in);
    std::vector<NearPair> overlaps;
    for (const NearPair& near : work.finder.Find(0.0)) {
      if (near.distance < 0.0) overlaps.push_back(near);
    }
    EXPECT_FALSE(overlaps.empty());
    const auto found = starts.ConstrainedTranslation(overlaps, work.problem().q_in);
    return {found.begin(), found.end()};
  }
  VectorXd Mirrored(const VectorXd& q) {
    VectorXd start;
    starts.Mirrored(q, start);
    return start;
  }
  VectorXd Gaussian(const VectorXd& center, double sigma, double spread, mjcf_pdg::Random& noise) {
    VectorXd start;
    starts.Gaussian(center, sigma, spread, noise, start);
    return start;
  }
  VectorXd ContactHop(const VectorXd& best, double sigma, Hop hop, mjcf_pdg::Random& noise) {
    VectorXd start;
    starts.ContactHop(best, sigma, hop, noise, start);
    return start;
  }
  double Nearest(const VectorXd& q) {  // at most 10 m
    work.finder.Pose(q);
    double least = 10.0;
    for (const NearPair& near : work.finder.Find(10.0)) least = std::min(least, near.distance);
    return least;
  }

  Scene scene;
  Options options;
  Workspace work;
  StartSelection starts{work};
};

inline std::string World(const std::string& inside) {
  return "<mujoco><worldbody>" + inside + "</worldbody></mujoco>";
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_START_SELECTOR_H_
