// The options that several verbs share, each defined once: flag, unit, range, default and help.
#ifndef MJCF_PDG_APPS_OPTIONS_H_
#define MJCF_PDG_APPS_OPTIONS_H_

#include <CLI/CLI.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {

struct SceneArguments {
  std::string model;  // path of the model
  SceneOptions options;
};

// The numbers that a flag accepts: from `low` to `high`.
struct NumberRange {
  double low = 0.0;
  bool above_low = false;  // `low` itself is not accepted
  double high = std::numeric_limits<double>::max();
};

struct NumberFlag {
  const char* flag;
  const char* unit;  // shown by --help
  const char* help;
  NumberRange range;
};

// Adds a flag with a number, which sets `target` if it is given. The value that `target` has now is
// the default that --help shows. Parsing the command line throws Error for a value that is no
// number or out of range. `target` must outlive the parsing.
CLI::Option* AddNumber(CLI::App& command, const NumberFlag& flag, double& target);
CLI::Option* AddInteger(CLI::App& command, const NumberFlag& flag, unsigned long long& target);

// Adds a flag with a file name. Parsing throws Error for an empty one.
CLI::Option* AddPath(CLI::App& command, const std::string& flag, const std::string& help,
                     std::string& target);
// --animation FILE.gif
void AddAnimation(CLI::App& command, const std::string& help, std::string& target);

// Loads the scene that was asked for and writes its warnings to stderr. Throws Error as Scene does.
Scene LoadScene(const SceneArguments& arguments);

void AddModel(CLI::App& command, SceneArguments& arguments);          // MODEL
void AddModels(CLI::App& command, std::vector<std::string>& models);  // MODEL...
void AddMovable(CLI::App& command, SceneArguments& arguments);        // --movable
void AddRoot(CLI::App& command, SceneArguments& arguments);           // --root
void AddArmature(CLI::App& command, SceneArguments& arguments);       // --armature
// --exclude, --allow, --ignore-permanent
void AddPairs(CLI::App& command, SceneArguments& arguments);
void AddExactMesh(CLI::App& command, SceneArguments& arguments);  // --exact-mesh
// What of the model counts: --equality, --tendon-limits, --flags, --flex
void AddModelRules(CLI::App& command, SceneArguments& arguments);
// --clearance M|model
void AddClearance(CLI::App& command, SceneArguments& arguments, Options& options);
void AddMetric(CLI::App& command, Metric& metric);       // --metric
void AddMethod(CLI::App& command, Method& method);       // --method
void AddEffort(CLI::App& command, Effort& effort);       // --effort
void AddTolerance(CLI::App& command, Options& options);  // --tolerance
void AddRest(CLI::App& command, Options& options);       // --rest
void AddJson(CLI::App& command, std::string& path);      // --json
void AddHtml(CLI::App& command, std::string& path);      // --html

// What was given on a parsed command line that decides what comes out, as a command line: all but
// the model, which configurations, and what is written where. `without` are left out, too.
std::vector<std::string> GivenOptions(const CLI::App& command,
                                      const std::vector<std::string>& without = {});
bool IsNormOption(const std::string& name);  // "--root", ...: `norm` takes it, too
// Those of GivenOptions that it takes.
std::vector<std::string> GivenNormOptions(const CLI::App& command);
// Name and value of each such option that was given or has a default.
std::vector<std::pair<std::string, std::string>> OptionsInForce(const CLI::App& command);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_OPTIONS_H_
