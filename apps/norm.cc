// mjcf-pdg norm: the object norm σ between two configurations, and each joint's part of it.
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/console/text.h"
#include "apps/input/configurations.h"
#include "apps/input/plugins.h"
#include "apps/options.h"
#include "apps/output/joint_moved.h"
#include "apps/output/output_files.h"
#include "apps/output/report.h"
#include "mjcf_pdg/object_norm.h"

namespace mjcf_pdg::app {
namespace {

struct NormArguments {
  SceneArguments scene;
  Metric metric = Options{}.metric;
  EndsArguments ends;
  std::string json;
};

// With how far each joint moved, where the terms of σ are joints.
std::string NormJson(const Scene& scene, const NormArguments& arguments, const Ends& ends,
                     double sigma, const std::vector<NormPart>& parts) {
  const std::map<std::string, int> joints = JointsOfTerms(scene, arguments.metric);
  nlohmann::ordered_json json = {{"sigma", sigma}, {"rms", std::sqrt(sigma)}};
  json["parts"] = nlohmann::ordered_json::array();
  for (const NormPart& part : parts) {
    json["parts"].push_back({{"name", part.name}, {"sigma", part.sigma}});
    const auto joint = joints.find(part.name);
    if (joint == joints.end()) continue;
    json["parts"].back()["moved"] = JointMoved(scene, joint->second, ends.from, ends.to);
  }
  return JsonLine(json);
}

std::string NormTable(double sigma, const std::vector<NormPart>& parts) {
  Table table({"part", "sigma m^2", "share %"});
  for (const NormPart& part : parts) {
    const double share = sigma > 0.0 ? 100.0 * part.sigma / sigma : 0.0;
    table.AddRow({part.name, Short(part.sigma), Short(share)});
  }
  return table.ToString() + "sigma " + Short(sigma) + " m^2, rms " + Short(std::sqrt(sigma) * 1e3) +
         " mm\n";
}

int RunNorm(const NormArguments& arguments) {
  // Its warnings are of what collides, which σ does not ask.
  const Scene scene = Scene::FromFile(arguments.scene.model, arguments.scene.options);
  const Ends ends = ReadEnds(scene, arguments.ends);
  OutputFiles outputs;
  outputs.Add("--json", arguments.json, {arguments.scene.model});
  ObjectNorm norm(scene, arguments.metric, ends.from);
  const double sigma = norm.Sigma(ends.to);
  const std::vector<NormPart> parts = norm.Parts(ends.to);
  if (!arguments.json.empty())
    outputs.Stage(arguments.json, NormJson(scene, arguments, ends, sigma, parts));
  outputs.Commit();
  if (!outputs.uses_stdout()) WriteStdout(NormTable(sigma, parts));
  return kExitFree;
}

}  // namespace

Verb AddNormVerb(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("norm", "Object norm between two configurations, per joint");
  auto arguments = std::make_shared<NormArguments>();
  AddModel(*command, arguments->scene);
  AddPlugins(*command);
  for (CLI::Option* end : AddEnds(*command, arguments->ends)) end->required();
  AddRoot(*command, arguments->scene);
  AddArmature(*command, arguments->scene);
  AddMetric(*command, arguments->metric);
  AddMovable(*command, arguments->scene);
  AddJson(*command, arguments->json);
  return {command, [arguments] { return RunNorm(*arguments); }};
}

}  // namespace mjcf_pdg::app
