#include "apps/regress/suite.h"

#include <glob.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>

#include "apps/regress/json_place.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::uint64_t kAnySeed = std::numeric_limits<std::uint64_t>::max();
constexpr double kMostLength = 1000.0;            // as Options allows [m]
constexpr std::uint64_t kMostRandom = 1'000'000;  // rows, all of which a run holds in memory

void NumberOrModel(const JsonPlace& place, double most, double& number, bool& model) {
  model = place.value.is_string();
  if (model) {
    place.Choice<bool>({{"model", true}});
    number = 0.0;  // what the suite says for all cases is replaced
  } else {
    number = place.Number(0.0, most);
  }
}

std::vector<std::string> Texts(const JsonPlace& place) {
  std::vector<std::string> texts;
  for (const JsonPlace& text : place.List()) texts.push_back(text.Text());
  return texts;
}

NamePair ReadPair(const JsonPlace& place) {
  const std::vector<std::string> names = Texts(place);
  if (names.size() != 2) place.Refuse("is not a list of two geoms or bodies");
  return {names[0], names[1]};
}

AllowedOverlap ReadAllowed(const JsonPlace& place) {
  const std::vector<JsonPlace> parts = place.List();
  if (parts.size() != 3) place.Refuse("is not a list of two geoms or bodies and a depth");
  return {{parts[0].Text(), parts[1].Text()}, parts[2].Number(0.0, kMostLength)};
}

void ReadOptions(const JsonPlace& place, SuiteCase& one) {
  SceneOptions& scene = one.scene;
  Options& options = one.options;
  place.Members({
      {"effort", [&](const JsonPlace& p) { options.effort = p.Choice(kEfforts); }},
      {"method", [&](const JsonPlace& p) { options.method = p.Choice(kMethods); }},
      {"metric", [&](const JsonPlace& p) { options.metric = p.Choice(kMetrics); }},
      {"tolerance", [&](const JsonPlace& p) { options.tolerance = p.Number(1e-12, 1.0); }},
      {"clearance",
       [&](const JsonPlace& p) {
         NumberOrModel(p, kMostLength, options.clearance, scene.keep_margins);
       }},
      {"armature",
       [&](const JsonPlace& p) { NumberOrModel(p, 1e3, scene.armature, scene.model_armature); }},
      {"rest", [&](const JsonPlace& p) { options.rest = p.Number(0.0, kMostLength); }},
      {"seed", [&](const JsonPlace& p) { options.seed = p.Whole(0, kAnySeed); }},
      {"exact_mesh", [&](const JsonPlace& p) { scene.exact_mesh = p.Flag(); }},
      {"root", [&](const JsonPlace& p) { scene.root = p.Text(); }},
      {"movable", [&](const JsonPlace& p) { scene.movable = Texts(p); }},
      {"fixed", [&](const JsonPlace& p) { scene.fixed = Texts(p); }},
      {"exclude",
       [&](const JsonPlace& p) {
         scene.exclude.clear();
         for (const JsonPlace& pair : p.List()) scene.exclude.push_back(ReadPair(pair));
       }},
      {"allow",
       [&](const JsonPlace& p) {
         scene.allow.clear();
         for (const JsonPlace& overlap : p.List()) scene.allow.push_back(ReadAllowed(overlap));
       }},
      {"ignore_permanent", [&](const JsonPlace& p) { scene.ignore_permanent = p.Flag(); }},
      {"equality", [&](const JsonPlace& p) { scene.equality = p.Choice(kEqualityModes); }},
      {"tendon_limits",
       [&](const JsonPlace& p) { scene.hold_tendon_limits = p.Choice(kTendonLimits); }},
      {"flags", [&](const JsonPlace& p) { scene.model_flags = p.Choice(kFlags); }},
      {"flex", [&](const JsonPlace& p) { scene.ignore_flexes = p.Choice(kFlexes); }},
  });
  one.given.update(place.value);
}

// An entry of `configurations`. Golden results know its rows by their names, which two entries must
// not share.
SuiteRows ReadRows(const JsonPlace& place) {
  SuiteRows rows;
  using Kind = SuiteRows::Kind;
  if (place.value.is_string()) {
    rows.kind = place.Choice<Kind>({{"keyframes", Kind::kKeyframes}, {"qpos0", Kind::kQpos0}});
    return rows;
  }
  place.Members({
      {"file",
       [&](const JsonPlace& p) {
         rows.kind = Kind::kFile;
         rows.file = p.Text();
       }},
      {"random",
       [&](const JsonPlace& p) {
         rows.kind = Kind::kRandom;
         rows.count = p.Whole(1, kMostRandom);
       }},
      {"seed", [&](const JsonPlace& p) { rows.seed = p.Whole(0, kAnySeed); }},
  });
  const bool one = place.value.contains("file") != place.value.contains("random");
  if (!one) place.Refuse("needs either 'file' or 'random'");
  if (rows.kind == Kind::kFile && place.value.contains("seed")) {
    place.Refuse("has a 'seed', which goes with 'random'");
  }
  return rows;
}

std::vector<SuiteRows> ReadConfigurations(const JsonPlace& place) {
  std::vector<SuiteRows> all;
  for (const JsonPlace& entry : place.List()) {
    const SuiteRows rows = ReadRows(entry);
    const bool twice = std::any_of(all.begin(), all.end(), [&](const SuiteRows& other) {
      return other.kind == rows.kind && other.file == rows.file && other.seed == rows.seed;
    });
    if (twice) entry.Refuse("names the rows of an entry before it");
    all.push_back(rows);
  }
  return all;
}

// What glob asks about a folder that it cannot read: one that is not there is no reason to end.
int EndsGlob(const char*, int error) { return error != ENOENT && error != ENOTDIR; }

// Files that a pattern names, below the suite's folder, in the order of their names; a name without
// * ? [ is itself, whether there is such a file or not.
std::vector<std::string> Expand(const fs::path& folder, const JsonPlace& place) {
  const std::string pattern = place.Text();
  if (pattern.find_first_of("*?[") == std::string::npos) {
    return {fs::path(pattern).lexically_normal().generic_string()};
  }
  glob_t found = {};
  const std::string full = (folder / pattern).string();
  const int failed = ::glob(full.c_str(), 0, EndsGlob, &found);
  std::vector<std::string> names;
  for (std::size_t k = 0; failed == 0 && k < found.gl_pathc; ++k) {
    names.push_back(fs::path(found.gl_pathv[k]).lexically_relative(folder).generic_string());
  }
  ::globfree(&found);
  // Models would be missing in silence.
  if (failed == GLOB_ABORTED) place.Refuse("a folder that it names cannot be read");
  if (names.empty()) place.Refuse("names no file");
  return names;
}

// The models of a case share everything else.
void ReadCase(const JsonPlace& place, const SuiteCase& defaults, Suite& suite) {
  SuiteCase read = defaults;
  std::vector<std::string> models;
  place.Members({
      {"model", [&](const JsonPlace& p) { models = Expand(suite.folder, p); }},
      {"configurations", [&](const JsonPlace& p) { read.rows = ReadConfigurations(p); }},
      {"options", [&](const JsonPlace& p) { ReadOptions(p, read); }},
  });
  if (models.empty()) place.Refuse("has no 'model'");
  if (read.rows.empty()) read.rows.push_back({});
  for (const std::string& model : models) {
    read.model = model;
    suite.cases.push_back(read);
  }
}

// Golden results are told apart by model: a model in two cases would mix theirs.
void CheckModelsAreOnce(const Suite& suite) {
  std::set<std::string> models;
  for (const SuiteCase& one : suite.cases) {
    if (!models.insert(one.model).second) {
      throw Error(suite.path + ": " + one.model + " is in two cases");
    }
  }
}

fs::path FolderOf(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

}  // namespace

std::string Suite::golden() const {
  return (fs::path(path).replace_extension(".golden.json")).string();
}

Suite ReadSuite(const std::string& path) {
  std::error_code ec;
  if (fs::is_directory(path, ec)) {
    throw Error(path + ": is a folder (--discover makes a suite of one)");
  }
  const Json json = ReadJsonFile(path);
  Suite suite;
  suite.path = path;
  suite.folder = FolderOf(path);
  SuiteCase defaults;
  std::unique_ptr<JsonPlace> cases;
  bool known = false;
  JsonPlace{json, path}.Members({
      {"version", [&](const JsonPlace& p) { known = p.value == kVersion; }},
      {"options", [&](const JsonPlace& p) { ReadOptions(p, defaults); }},
      {"sigma_tolerance", [&](const JsonPlace& p) { suite.sigma_tolerance = p.Number(0.0, 1e6); }},
      {"queries_tolerance",
       [&](const JsonPlace& p) { suite.queries_tolerance = p.Number(0.0, 1e6); }},
      {"cases", [&](const JsonPlace& p) { cases = std::make_unique<JsonPlace>(p); }},
  });
  if (!known) throw Error(path + ": version is not " + std::to_string(kVersion));
  if (!cases) throw Error(path + ": has no 'cases'");
  for (const JsonPlace& place : cases->List()) ReadCase(place, defaults, suite);
  CheckModelsAreOnce(suite);
  return suite;
}

std::string FormatSuite(const Suite& suite) {
  std::string text = "{\n  \"version\": " + std::to_string(kVersion) + ",\n  \"cases\": [\n";
  for (std::size_t k = 0; k < suite.cases.size(); ++k) {
    text += "    {\"model\": " + Json(suite.cases[k].model).dump() + "}" +
            (k + 1 < suite.cases.size() ? ",\n" : "\n");
  }
  return text + "  ]\n}\n";
}

}  // namespace mjcf_pdg::app
