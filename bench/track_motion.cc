#include "track_motion.h"

#include <algorithm>
#include <cmath>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::bench {
namespace {

struct SpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};

Q Home(const mjModel& m) {
  const mjtNum* q = m.nkey > 0 ? m.key_qpos : m.qpos0;
  return {q, q + m.nq};
}

// Uniform between two numbers.
double Between(Random& random, double low, double high) {
  return low + random.Uniform() * (high - low);
}

}  // namespace

void AddMotionArguments(CLI::App& app, MotionArguments& a) {
  app.add_option("models", a.models, "MJCF files (default: our own three)");
  app.add_option("--ticks", a.ticks, "Commands at 1 kHz");
  app.add_option("--obstacles", a.obstacles, "Obstacles around the robot");
  app.add_option("--amplitude", a.amplitude, "Of the sinusoids, share of a joint's range");
  app.add_option("--seed", a.seed, "Of obstacles and commands");
}

Commands::Commands(const mjModel& m, const MotionArguments& a, Random& random) : home_(Home(m)) {
  for (int j = 0; j < m.njnt; ++j) {
    if (m.jnt_type[j] != mjJNT_HINGE && m.jnt_type[j] != mjJNT_SLIDE) continue;
    const bool limited = m.jnt_limited[j];
    const double low = limited ? m.jnt_range[2 * j] : -1.5;
    const double high = limited ? m.jnt_range[2 * j + 1] : 1.5;
    const double reach = a.amplitude * std::min(high - low, M_PI);
    const double middle =
        std::clamp(home_[m.jnt_qposadr[j]], low + reach, std::max(low + reach, high - reach));
    waves_.push_back({m.jnt_qposadr[j], middle, reach, Between(random, 0.1, 0.4),
                      Between(random, 0.0, 2.0 * M_PI)});
  }
}

Q Commands::At(double t) const {
  Q q = home_;
  for (const Wave& w : waves_) {
    q[w.qadr] = w.middle + w.amplitude * std::sin(2.0 * M_PI * w.frequency * t + w.phase);
  }
  return q;
}

ModelPtr WithObstacles(const std::string& path, const MotionArguments& a, Random& random) {
  char error[1000] = "";
  const std::unique_ptr<mjSpec, SpecDeleter> spec(
      mj_parseXML(path.c_str(), nullptr, error, sizeof error));
  if (!spec) throw Error(path + ": " + error);
  ModelPtr model(mj_compile(spec.get(), nullptr), mj_deleteModel);
  if (!model) throw Error(path + ": " + mjs_getError(spec.get()));
  const DataPtr d(mj_makeData(model.get()), mj_deleteData);
  const Commands commands(*model, a, random);
  double radius = 0.0;  // of a typical geom that moves
  std::vector<int> moving;
  for (int g = 0; g < model->ngeom; ++g) {
    const bool collides = model->geom_contype[g] || model->geom_conaffinity[g];
    if (!collides || model->body_weldid[model->geom_bodyid[g]] == 0) continue;
    moving.push_back(g);
    radius += model->geom_rbound[g];
  }
  if (moving.empty()) throw Error(path + ": no geom moves");
  radius *= 0.5 / static_cast<double>(moving.size());
  for (int made = 0, tries = 0; made < a.obstacles && tries < 100 * a.obstacles; ++tries) {
    const Q q = commands.At(Between(random, 0.0, 10.0));
    std::copy(q.begin(), q.end(), d->qpos);
    mj_kinematics(model.get(), d.get());
    const int g = moving[static_cast<std::size_t>(random.Uniform() * 0.999 *
                                                  static_cast<double>(moving.size()))];
    double place[3], apart = 1e9;
    for (int k = 0; k < 3; ++k) {
      place[k] = d->geom_xpos[3 * g + k] + Between(random, -1.0, 1.0) * model->geom_rbound[g];
    }
    const Q home = commands.At(0.0);
    std::copy(home.begin(), home.end(), d->qpos);
    mj_kinematics(model.get(), d.get());
    for (const int other : moving) {
      const double* at = d->geom_xpos + 3 * other;
      const double distance = std::hypot(at[0] - place[0], at[1] - place[1], at[2] - place[2]);
      apart = std::min(apart, distance - model->geom_rbound[other] - 2.0 * radius);
    }
    if (apart < 0.0) continue;
    mjsGeom* geom = mjs_addGeom(mjs_findBody(spec.get(), "world"), nullptr);
    const mjtGeom types[] = {mjGEOM_SPHERE, mjGEOM_BOX, mjGEOM_CAPSULE};
    geom->type = types[made % 3];
    geom->contype = geom->conaffinity = 1;
    for (int k = 0; k < 3; ++k) {
      geom->pos[k] = place[k];
      geom->size[k] = radius * (geom->type == mjGEOM_SPHERE ? 1.0 : Between(random, 0.5, 1.0));
    }
    ++made;
  }
  model.reset(mj_compile(spec.get(), nullptr));
  if (!model) throw Error(path + ": " + mjs_getError(spec.get()));
  return model;
}

}  // namespace mjcf_pdg::bench
