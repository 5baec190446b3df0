#include "audit.h"

#include <mujoco/mujoco.h>

#include <csignal>
#include <string>

#include "answers.h"
#include "apps/audit/examine.h"
#include "apps/console/interrupt.h"
#include "arrays.h"
#include "library_call.h"
#include "model.h"

namespace mjcf_pdg::app {

// Asks Python, where the program asks its own signal handlers. The exception stays set in this
// thread until the audit has returned.
int Interrupted() {
  const nanobind::gil_scoped_acquire acquire;
  return PyErr_Occurred() || PyErr_CheckSignals() != 0 ? SIGINT : 0;
}

}  // namespace mjcf_pdg::app

namespace mjcf_pdg::python {
namespace {

nb::dict ToDict(const Scene& scene, const app::AuditedPair& pair) {
  nb::dict d;
  d["geom1"] = GeomOf(scene, pair.geom1);
  d["geom2"] = GeomOf(scene, pair.geom2);
  d["class"] = app::NameOf(pair.kind);
  d["share"] = pair.share;
  d["count"] = pair.count;
  d["depth"] = pair.deepest.distance;
  d["deepest_in"] = Text(pair.where.label);
  return d;
}

nb::dict ToDict(const app::AuditedKey& key) {
  nb::dict d;
  d["name"] = Text(key.of.label);
  d["depth"] = key.depth;
  d["limit_excess"] = key.limit_excess;
  d["equality_residual"] = key.equality_residual;
  d["force_over_weight"] = key.force_over_weight;
  return d;
}

nb::dict ToDict(const Scene& scene, const app::Audit& audit) {
  nb::list pairs, exclude, keyframes, warnings;
  for (const app::AuditedPair& pair : audit.pairs) pairs.append(ToDict(scene, pair));
  for (const auto& [body1, body2] : audit.exclude) {
    nb::list bodies;
    bodies.append(Text(body1));
    bodies.append(Text(body2));
    exclude.append(bodies);
  }
  for (const app::AuditedKey& key : audit.keys) keyframes.append(ToDict(key));
  for (const std::string& warning : audit.warnings) warnings.append(Text(warning));
  nb::dict d;
  d["model"] = Text(scene.model()->names);  // its own name comes first
  d["samples"] = audit.samples;
  d["pairs"] = pairs;
  d["never"] = audit.never;
  d["never_share_below"] = audit.never_share;
  d["exclude"] = exclude;
  d["keyframes"] = keyframes;
  d["warnings"] = warnings;
  return d;
}

}  // namespace

nb::dict AuditModel(nb::handle model, std::size_t samples, std::uint64_t seed, double tolerance,
                    bool exact_mesh) {
  if (samples < 1) throw Error("the number of samples must be at least 1");
  const Model scene = ReadModel(model, {.movable = {}, .root = "", .exact_mesh = exact_mesh});
  const app::AuditOptions options = {.samples = samples, .seed = seed, .tolerance = tolerance};
  const app::Audit audit = CallLibrary([&] { return app::Examine(scene.scene, options); });
  if (PyErr_Occurred()) throw nb::python_error();
  return ToDict(scene.scene, audit);
}

}  // namespace mjcf_pdg::python
