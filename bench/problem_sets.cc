#include "problem_sets.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::bench {
namespace {

constexpr int kTriesPerProblem = 200;  // random configurations drawn per problem, at most
// Largest offset, along each axis, of a thrown geom from its target, as a share of the sum of their
// bounding radii.
constexpr double kReach = 0.8;

struct DeleteData {
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using DataPtr = std::unique_ptr<mjData, DeleteData>;

// Random numbers. The standard fixes the output of the engine, but not that of distributions, so
// these are written out.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  int Index(int n) { return std::min(n - 1, static_cast<int>(Uniform(0.0, n))); }

  // Uniform over rotations (Shoemake 1992).
  void Quaternion(double* quat) {
    const double u = Uniform(0.0, 1.0), a = Uniform(0.0, 2 * mjPI), b = Uniform(0.0, 2 * mjPI);
    const double s = std::sqrt(1.0 - u), c = std::sqrt(u);
    quat[0] = c * std::cos(b);
    quat[1] = s * std::sin(a);
    quat[2] = s * std::cos(a);
    quat[3] = c * std::sin(b);
  }

  // About a random axis by a uniform angle of at most `max_angle`.
  void LimitedQuaternion(double max_angle, double* quat) {
    double axis[3];
    const double z = Uniform(-1.0, 1.0), phi = Uniform(0.0, 2 * mjPI);
    axis[0] = std::sqrt(1.0 - z * z) * std::cos(phi);
    axis[1] = std::sqrt(1.0 - z * z) * std::sin(phi);
    axis[2] = z;
    mju_axisAngle2Quat(quat, axis, Uniform(0.0, max_angle));
  }

 private:
  std::mt19937_64 engine_;
};

// True if MuJoCo's filters let the geom collide with something.
bool Collides(const mjModel& m, int geom) {
  if (m.geom_contype[geom] != 0 || m.geom_conaffinity[geom] != 0) return true;
  for (int k = 0; k < m.npair; ++k) {
    if (m.pair_geom1[k] == geom || m.pair_geom2[k] == geom) return true;
  }
  return false;
}

void DrawJoint(const mjModel& m, int joint, Draw& draw, double* q) {
  double* entry = q + m.jnt_qposadr[joint];
  const double* range = m.jnt_range + 2 * joint;
  const bool limited = m.jnt_limited[joint];
  switch (m.jnt_type[joint]) {
    case mjJNT_HINGE:
      *entry = limited ? draw.Uniform(range[0], range[1]) : draw.Uniform(-mjPI, mjPI);
      break;
    case mjJNT_SLIDE: {
      const double reach = 0.5 * m.stat.extent;
      *entry = limited ? draw.Uniform(range[0], range[1]) : *entry + draw.Uniform(-reach, reach);
      break;
    }
    case mjJNT_BALL:
      if (limited)
        draw.LimitedQuaternion(range[1], entry);
      else
        draw.Quaternion(entry);
      break;
    default:
      draw.Quaternion(entry + 3);
  }
}

// Moves the tree of the free joint so that one of its geoms is near a geom of another tree, both
// chosen at random. `d` must hold the pose of `q`.
void Throw(const mjModel& m, const mjData& d, int free_joint, Draw& draw, double* q) {
  const int tree = m.body_rootid[m.jnt_bodyid[free_joint]];
  std::vector<int> own, others;
  for (int g = 0; g < m.ngeom; ++g) {
    if (!Collides(m, g)) continue;
    (m.body_rootid[m.geom_bodyid[g]] == tree ? own : others).push_back(g);
  }
  if (own.empty() || others.empty()) return;
  const int hit = own[draw.Index(static_cast<int>(own.size()))];
  const int target = others[draw.Index(static_cast<int>(others.size()))];
  const double* from = d.geom_xpos + 3 * hit;
  double to[3];
  mju_copy3(to, d.geom_xpos + 3 * target);
  if (m.geom_type[target] == mjGEOM_PLANE) {
    // Along a plane the geom stays where it is; across it, it goes to within its radius.
    const double* frame = d.geom_xmat + 9 * target;
    const double normal[3] = {frame[2], frame[5], frame[8]};
    double off[3];
    mju_sub3(off, from, to);
    mju_addScl3(to, from, normal, -mju_dot3(off, normal));
    mju_addToScl3(to, normal, kReach * m.geom_rbound[hit] * draw.Uniform(-1.0, 1.0));
  } else {
    const double reach = kReach * (m.geom_rbound[hit] + m.geom_rbound[target]);
    for (double& x : to) x += reach * draw.Uniform(-1.0, 1.0);
  }
  double* base = q + m.jnt_qposadr[free_joint];
  for (int i = 0; i < 3; ++i) base[i] += to[i] - from[i];
}

std::vector<double> DrawConfiguration(const Scene& scene, mjData& d, Draw& draw) {
  const mjModel& m = *scene.model();
  std::vector<double> q = scene.DefaultQpos();
  for (int j = 0; j < m.njnt; ++j) DrawJoint(m, j, draw, q.data());
  for (int j = 0; j < m.njnt; ++j) {
    if (m.jnt_type[j] != mjJNT_FREE) continue;
    mju_copy(d.qpos, q.data(), m.nq);
    mj_kinematics(&m, &d);
    Throw(m, d, j, draw, q.data());
  }
  return q;
}

// A model's file name with its folder, because file names repeat.
std::string ShortName(const std::string& model_path) {
  const std::filesystem::path path(model_path);
  const std::string folder = path.parent_path().filename().string();
  return folder.empty() ? path.stem().string() : folder + "/" + path.stem().string();
}

BenchProblem ParseProblem(const nlohmann::json& line) {
  BenchProblem problem;
  problem.id = line.value("id", "");
  const char* name = line.contains("qpos_in") ? "qpos_in" : "qpos";  // of a solve, or of a problem
  problem.q_in = line.at(name).get<std::vector<double>>();
  if (line.contains("best") && line.at("best").is_number()) {
    problem.best_known = line.at("best").get<double>();
  }
  return problem;
}

}  // namespace

std::vector<std::string> OwnModels() {
  const std::string folder = MJCF_PDG_MODEL_DIR;
  return {folder + "/puma/puma_car.xml", folder + "/hand/hand_bottle.xml",
          folder + "/figure/figure_bench.xml"};
}

ProblemSet Keyframes(const Scene& scene, const std::string& model_path) {
  ProblemSet set{ShortName(model_path) + " keyframes", model_path, {}};
  const std::vector<std::string> names = scene.KeyNames();
  for (std::size_t k = 0; k < names.size(); ++k) {
    BenchProblem problem;
    problem.id = names[k].empty() ? std::to_string(k) : names[k];
    problem.q_in = scene.KeyQpos(static_cast<int>(k));
    set.problems.push_back(std::move(problem));
  }
  return set;
}

ProblemSet RandomProblems(const Scene& scene, const std::string& model_path, int count,
                          std::uint64_t seed) {
  ProblemSet set{ShortName(model_path) + " random", model_path, {}};
  const DataPtr data(mj_makeData(scene.model()));
  Draw draw(seed);
  for (int k = 0; k < count * kTriesPerProblem; ++k) {
    if (static_cast<int>(set.problems.size()) == count) break;
    BenchProblem problem;
    problem.id = "random" + std::to_string(k);
    problem.q_in = DrawConfiguration(scene, *data, draw);
    if (Verify(scene, problem.q_in).min_distance < -kLeastDepth) {
      set.problems.push_back(std::move(problem));
    }
  }
  return set;
}

std::vector<ProblemSet> ReadProblems(const std::string& path, const std::string& root) {
  std::ifstream file(path);
  if (!file) throw Error("cannot read " + path);
  const std::string name = std::filesystem::path(path).stem().string();
  std::vector<ProblemSet> sets;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty()) continue;
    try {
      const nlohmann::json parsed = nlohmann::json::parse(line);
      const std::string model =
          (std::filesystem::path(root) / parsed.at("model").get<std::string>()).string();
      auto set = std::find_if(sets.begin(), sets.end(),
                              [&](const ProblemSet& s) { return s.model_path == model; });
      if (set == sets.end()) {
        sets.push_back({name + " " + ShortName(model), model, {}});
        set = sets.end() - 1;
      }
      set->problems.push_back(ParseProblem(parsed));
    } catch (const nlohmann::json::exception& error) {
      throw Error(path + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  return sets;
}

}  // namespace mjcf_pdg::bench
