#include "figure11.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "oracle_tally.h"
#include "planar_optimum.h"

namespace mjcf_pdg::bench {
namespace {

constexpr char kFolder[] = MJCF_PDG_MODEL_DIR "/rigid";

void Replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw Error("spoon_box.xml has no " + from);
  text.replace(at, from.size(), to);
}

// The scene of the spoon and the box, with two slides and a hinge at the spoon's centre of mass in
// place of its free joint.
Scene PlanarScene() {
  const std::string path = std::string(kFolder) + "/spoon_box.xml";
  const Scene free = Scene::FromFile(path);
  const int body = mj_name2id(free.model(), mjOBJ_BODY, "spoon");
  const double* com = free.model()->body_ipos + 3 * body;
  char joints[300];
  std::snprintf(joints, sizeof joints,
                "<joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 0 1'/>"
                "<joint type='hinge' axis='0 1 0' pos='%.17g %.17g %.17g'/>",
                com[0], com[1], com[2]);
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string xml = text.str();
  Replace(xml, "meshdir=\"assets\"", std::string("meshdir=\"") + kFolder + "/assets\"");
  Replace(xml, "<freejoint name=\"spoon\" />", joints);
  const std::size_t keys = xml.find("<keyframe>"), end = xml.find("</keyframe>");
  xml.erase(keys, end - keys);
  Replace(xml, "</keyframe>", "");
  SceneOptions options;
  options.exact_mesh = true;
  return Scene::FromString(xml, options);
}

// The errors of one effort against brute force.
struct Sums {
  double all = 0.0, worse = 0.0, worst = 0.0;  // sum, sum where ours is worse, largest of these
  int beaten = 0, better = 0, unsolved = 0;    // frames: ours is worse; ours is lower; no answer

  void Add(const Result& ours, double sigma) {
    if (ours.status != Status::kSolved) {
      ++unsolved;
      return;
    }
    const double error = RelativeError(ours.sigma, sigma);
    all += error;
    if (ours.sigma > sigma) {
      ++beaten;
      worse += error;
      worst = std::max(worst, error);
    } else {
      ++better;
    }
  }
  void Print(const char* effort, int frames) const {
    std::printf(
        "  %-8s %d frames, %d unsolved; mean error %.5f (paper 0.0165); ours is worse in %d: mean "
        "%.5f, at most %.5f; lower in %d\n",
        effort, frames, unsolved, all / frames, beaten, beaten ? worse / beaten : 0.0, worst,
        better);
  }
};

}  // namespace

double RelativeError(double sigma1, double sigma2) {
  return std::abs(sigma1 - sigma2) / std::max(sigma1, sigma2);
}

void PrintFigure11(double tolerance, int count) {
  const Scene scene = PlanarScene();
  OracleTally oracle(scene, tolerance);
  Options options;
  options.tolerance = tolerance;
  Solver normal(scene, options);
  options.effort = Effort::kFast;
  Solver fast(scene, options);
  Workspace work(scene.tables(), options);
  std::printf("Fig. 11: spoon into box, brute force over one rotation and two translations\n");
  std::printf("  %5s %6s %12s %12s %12s %10s %10s %10s\n", "x", "tilt", "brute force", "default",
              "fast", "error", "fast", "its own");
  Sums sums, sums_fast;
  int frames = 0;
  for (int k = 0; k < count; ++k) {
    const double t = k / (count - 1.0);
    const std::vector<double> q = {-0.05 + 0.1 * t, 0.052 - 0.01 * t, 0.7 * std::sin(5.0 * t)};
    const Result ours = normal.Solve(q), quick = fast.Solve(q);
    oracle.Ask(ours);
    oracle.Ask(quick);
    if (ours.status == Status::kAlreadyFree) continue;
    work.Begin(ToEigen(q));
    const PlanarOptimum optimum = BruteForcePlanar(work);
    ++frames;
    sums.Add(ours, optimum.sigma);
    sums_fast.Add(quick, optimum.sigma);
    std::printf("  %5.2f %6.2f %12.5e %12.5e %12.5e %10.5f%s %9.5f%s %9.4f\n", q[0], q[2],
                optimum.sigma, ours.sigma, quick.sigma, RelativeError(ours.sigma, optimum.sigma),
                ours.sigma < optimum.sigma ? "*" : " ", RelativeError(quick.sigma, optimum.sigma),
                quick.sigma < optimum.sigma ? "*" : " ", optimum.error);
    std::fflush(stdout);
  }
  std::printf("  (* ours is lower; %d more frames were free)\n", count - frames);
  sums.Print("default", frames);
  sums_fast.Print("fast", frames);
  oracle.Print();
}

}  // namespace mjcf_pdg::bench
