// What a control loop takes from the heap once it is warm: nothing. Counted from outside, in a
// program that links the installed package. allocations TICKS MODEL...; exit 1 if anything is
// taken.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "tests/support/allocation_counter.h"

namespace {

using Configuration = std::vector<double>;
using mjcf_pdg::test::AllocationCounter;

constexpr int kCycled = 20;        // configurations of a lap
constexpr int kWarmUp = 200;       // new ones before the count begins
constexpr int kMostDraws = 20000;  // for one that is free, or one that is not

// Random configurations about qpos0: joints uniform over their ranges (a radian or 0.1 m without
// limits), free bodies moved by up to 0.2 m and turned.
class Draws {
 public:
  explicit Draws(const mjcf_pdg::Scene& scene) : model_(*scene.model()), asked_(scene) {}

  // False if there is none among many.
  bool Next(bool free, Configuration& q) {
    for (int k = 0; k < kMostDraws; ++k) {
      Draw(q);
      if (asked_.IsFree(q) == free) return true;
    }
    return false;
  }

 private:
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  void Turn(double* quaternion) {
    for (int k = 0; k < 4; ++k) quaternion[k] += 0.5 * std::normal_distribution<double>()(random_);
    mju_normalize4(quaternion);
  }

  void Draw(Configuration& q) {
    constexpr double kTurn = 1.0, kSlide = 0.1, kThrow = 0.2;
    q.assign(model_.qpos0, model_.qpos0 + model_.nq);
    for (int j = 0; j < model_.njnt; ++j) {
      double* value = q.data() + model_.jnt_qposadr[j];
      const int type = model_.jnt_type[j];
      const double* range = model_.jnt_range + 2 * j;
      const double reach = type == mjJNT_SLIDE ? kSlide : kTurn;
      if (type == mjJNT_FREE) {
        for (int k = 0; k < 3; ++k) value[k] += Uniform(-kThrow, kThrow);
        Turn(value + 3);
      } else if (type == mjJNT_BALL) {
        Turn(value);
      } else {
        *value =
            model_.jnt_limited[j] ? Uniform(range[0], range[1]) : *value + Uniform(-reach, reach);
      }
    }
  }

  const mjModel& model_;
  mjcf_pdg::Solver asked_;
  std::mt19937_64 random_{7};
};

// A warm solver that is counted.
class Counted {
 public:
  Counted(const mjcf_pdg::Scene& scene, const mjcf_pdg::Options& options)
      : solver_(scene, options) {}

  void Warm(const Configuration& q) {
    solver_.Solve(q, result_);
    solver_.IsFree(q);
  }

  void Tick(const Configuration& q) {
    const auto begin = std::chrono::steady_clock::now();
    const AllocationCounter solving;
    const mjcf_pdg::Status status = solver_.Solve(q, result_);
    solve_ += solving.count();
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const AllocationCounter asking;
    solver_.IsFree(q);
    is_free_ += asking.count();
    unsolved_ += status == mjcf_pdg::Status::kUnsolved;
    ++ticks_;
  }

  // True if there were ticks and nothing was taken.
  bool Print(const char* what) const {
    std::printf("  %-16s %5d ticks: Solve %lld, IsFree %lld allocations (%d unsolved, %.2f ms)\n",
                what, ticks_, static_cast<long long>(solve_), static_cast<long long>(is_free_),
                unsolved_, 1e3 * seconds_ / std::max(ticks_, 1));
    std::fflush(stdout);
    return ticks_ > 0 && solve_ + is_free_ == 0;
  }

 private:
  mjcf_pdg::Solver solver_;
  mjcf_pdg::Result result_;
  long long solve_ = 0, is_free_ = 0;
  int ticks_ = 0, unsolved_ = 0;
  double seconds_ = 0.0;
};

// The same few configurations again and again.
bool CountLaps(const mjcf_pdg::Scene& scene, const mjcf_pdg::Options& options, bool free,
               int ticks) {
  Draws draws(scene);
  std::vector<Configuration> lap;
  for (Configuration q; lap.size() < kCycled && draws.Next(free, q);) lap.push_back(q);
  Counted counted(scene, options);
  for (const Configuration& q : lap) counted.Warm(q);
  for (int k = 0; k < ticks && !lap.empty(); ++k) counted.Tick(lap[k % lap.size()]);
  return counted.Print(free ? "free, cycled" : "colliding, cycled");
}

// A configuration never seen before, each tick.
bool CountNew(const mjcf_pdg::Scene& scene, const mjcf_pdg::Options& options, int ticks) {
  Draws draws(scene);
  Counted counted(scene, options);
  Configuration q;
  for (int k = 0; k < kWarmUp && draws.Next(false, q); ++k) counted.Warm(q);
  for (int k = 0; k < ticks && draws.Next(false, q); ++k) counted.Tick(q);
  return counted.Print("colliding, new");
}

bool Count(const std::string& path, int ticks) {
  const auto scene = mjcf_pdg::Scene::FromFile(path);
  bool none = true;
  for (const auto effort : {mjcf_pdg::Effort::kFast, mjcf_pdg::Effort::kDefault}) {
    std::printf("%s, effort %s\n", path.c_str(),
                effort == mjcf_pdg::Effort::kFast ? "fast" : "default");
    mjcf_pdg::Options options;
    options.effort = effort;
    none &= CountLaps(scene, options, true, ticks);
    none &= CountLaps(scene, options, false, ticks);
    none &= CountNew(scene, options, ticks);
  }
  return none;
}

}  // namespace

int main(int argc, char** argv) {
  const int ticks = argc > 1 ? std::atoi(argv[1]) : 0;
  if (ticks <= 0 || argc < 3 || !AllocationCounter::Works()) {
    std::fprintf(stderr, "allocations TICKS MODEL...\n");
    return 2;
  }
  bool none = true;
  for (int k = 2; k < argc; ++k) none &= Count(argv[k], ticks);
  return none ? 0 : 1;
}
