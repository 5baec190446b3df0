// Configuration lines of scenes, for tests of what moves how fast along them.
#ifndef MJCF_PDG_TESTS_CCD_LINE_H_
#define MJCF_PDG_TESTS_CCD_LINE_H_

#include <string>
#include <utility>
#include <vector>

#include "ccd/motion_bound.h"
#include "collide/contacts.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

// A configuration line of a scene, posed anywhere on it.
struct Line {
  explicit Line(Scene line_scene)
      : scene(std::move(line_scene)),
        tables(scene.tables()),
        finder(tables),
        bound(tables),
        dq(VectorXd::Zero(tables.n)) {}

  void Set(const VectorXd& start, const VectorXd& tangent) {
    q0 = start;
    dq = tangent;
    bound.SetPath(dq);
  }
  void Pose(double s) {
    VectorXd q;
    Integrate(tables, q0, s * dq, q);
    finder.Pose(q);
    bound.SetPose(finder.posed());
  }
  int BodyPairOf(int pair) const {
    for (int k = 0;; ++k) {
      if (pair < tables.body_pairs[k].end) return k;
    }
  }

  Scene scene;
  const SceneTables& tables;
  ContactFinder finder;
  MotionBound bound;
  VectorXd q0, dq;
};

inline std::vector<Scene> Scenes(Random& rng) {
  std::vector<Scene> scenes;
  for (const std::string& xml : {ArmXml(), BallChainXml(false), TwoTreesXml(), OffCentreXml()}) {
    scenes.push_back(Scene::FromString(xml));
  }
  for (int i = 0; i < 6; ++i) {
    RobotOptions options;
    options.free_base = i % 2 == 0;
    scenes.push_back(Scene::FromString(RandomRobotXml(rng, options)));
  }
  return scenes;
}

// Short corrections as well as whole turns.
inline VectorXd RandomTangent(const Line& line, Random& rng) {
  VectorXd dq = rng.Uniform(0.05, 2.0) * rng.Normals(line.tables.n);
  for (int i = 0; i < dq.size(); ++i) {
    if (rng.Chance(0.3)) dq[i] = 0.0;
  }
  return dq;
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_CCD_LINE_H_
