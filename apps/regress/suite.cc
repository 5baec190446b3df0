#include "apps/regress/suite.h"

#include <glob.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

// A value of the suite, and where it stands for messages: "suite.json: cases[2].model".
struct Place {
  const Json& value;
  std::string name;

  [[noreturn]] void Refuse(const std::string& why) const { throw Error(name + ": " + why); }

  std::string Text() const {
    if (!value.is_string() || value.get_ref<const std::string&>().empty()) Refuse("is no text");
    return value.get<std::string>();
  }
  double Number(double low, double high) const {
    const bool in_range =
        value.is_number() && value.get<double>() >= low && value.get<double>() <= high;
    if (!in_range) Refuse("is no number in its range");
    return value.get<double>();
  }
  std::uint64_t Whole() const {
    if (!value.is_number_unsigned()) Refuse("is no whole number");
    return value.get<std::uint64_t>();
  }
  bool Flag() const {
    if (!value.is_boolean()) Refuse("is neither true nor false");
    return value.get<bool>();
  }
  std::vector<Place> List() const {
    if (!value.is_array() || value.empty()) Refuse("is no list, or an empty one");
    std::vector<Place> places;
    for (std::size_t k = 0; k < value.size(); ++k) {
      places.push_back({value[k], name + "[" + std::to_string(k) + "]"});
    }
    return places;
  }
  // Hands each member to its reader; refuses those that have none.
  using Readers = std::map<std::string, std::function<void(const Place&)>>;
  void Members(const Readers& readers) const {
    if (!value.is_object()) Refuse("is no object {...}");
    for (const auto& [key, member] : value.items()) {
      const auto reader = readers.find(key);
      if (reader == readers.end()) {
        std::string known;
        for (const auto& [other, unused] : readers) known += (known.empty() ? "" : ", ") + other;
        Refuse("has no '" + key + "' (there are: " + known + ")");
      }
      reader->second({member, name + "." + key});
    }
  }
};

template <typename T>
T Choice(const Place& place, const std::map<std::string, T>& choices) {
  const auto found = choices.find(place.Text());
  if (found != choices.end()) return found->second;
  std::string names;
  for (const auto& [name, value] : choices) names += (names.empty() ? "" : "|") + name;
  place.Refuse("is none of " + names);
}

void NumberOrModel(const Place& place, double most, double& number, bool& model) {
  model = place.value.is_string();
  if (model) {
    Choice<bool>(place, {{"model", true}});
  } else {
    number = place.Number(0.0, most);
  }
}

std::vector<std::string> Texts(const Place& place) {
  std::vector<std::string> texts;
  for (const Place& text : place.List()) texts.push_back(text.Text());
  return texts;
}

NamePair ReadPair(const Place& place) {
  const std::vector<std::string> names = Texts(place);
  if (names.size() != 2) place.Refuse("is not a list of two geoms or bodies");
  return {names[0], names[1]};
}

void ReadOptions(const Place& place, SceneOptions& scene, Options& options) {
  constexpr double kMost = 1000.0;  // as Options allows [m]
  place.Members({
      {"effort",
       [&](const Place& p) {
         options.effort = Choice<Effort>(
             p, {{"fast", Effort::kFast}, {"default", Effort::kDefault}, {"max", Effort::kMax}});
       }},
      {"method",
       [&](const Place& p) {
         options.method = Choice<Method>(p, {{"auto", Method::kAuto}, {"paper", Method::kPaper}});
       }},
      {"metric",
       [&](const Place& p) {
         options.metric = Choice<Metric>(
             p, {{"sequential", Metric::kSequential}, {"displacement", Metric::kDisplacement}});
       }},
      {"tolerance", [&](const Place& p) { options.tolerance = p.Number(1e-12, 1.0); }},
      {"clearance",
       [&](const Place& p) { NumberOrModel(p, kMost, options.clearance, scene.keep_margins); }},
      {"armature",
       [&](const Place& p) { NumberOrModel(p, 1e3, scene.armature, scene.model_armature); }},
      {"rest", [&](const Place& p) { options.rest = p.Number(0.0, kMost); }},
      {"seed", [&](const Place& p) { options.seed = p.Whole(); }},
      {"exact_mesh", [&](const Place& p) { scene.exact_mesh = p.Flag(); }},
      {"root", [&](const Place& p) { scene.root = p.Text(); }},
      {"movable", [&](const Place& p) { scene.movable = Texts(p); }},
      {"fixed", [&](const Place& p) { scene.fixed = Texts(p); }},
      {"exclude",
       [&](const Place& p) {
         scene.exclude.clear();
         for (const Place& pair : p.List()) scene.exclude.push_back(ReadPair(pair));
       }},
      {"ignore_permanent", [&](const Place& p) { scene.ignore_permanent = p.Flag(); }},
      {"equality",
       [&](const Place& p) {
         scene.equality = Choice<EqualityMode>(p, {{"hold", EqualityMode::kHold},
                                                   {"all", EqualityMode::kAll},
                                                   {"ignore", EqualityMode::kIgnore}});
       }},
      {"flags",
       [&](const Place& p) {
         scene.model_flags = Choice<bool>(p, {{"all", false}, {"model", true}});
       }},
      {"flex",
       [&](const Place& p) {
         scene.ignore_flexes = Choice<bool>(p, {{"refuse", false}, {"ignore", true}});
       }},
  });
}

SuiteRows ReadRows(const Place& place) {
  SuiteRows rows;
  if (place.value.is_string()) {
    rows.kind = Choice<SuiteRows::Kind>(
        place, {{"keyframes", SuiteRows::Kind::kKeyframes}, {"qpos0", SuiteRows::Kind::kQpos0}});
    return rows;
  }
  place.Members({
      {"file",
       [&](const Place& p) {
         rows.kind = SuiteRows::Kind::kFile;
         rows.file = p.Text();
       }},
      {"random",
       [&](const Place& p) {
         rows.kind = SuiteRows::Kind::kRandom;
         rows.count = p.Whole();
       }},
      {"seed", [&](const Place& p) { rows.seed = p.Whole(); }},
  });
  const bool one = place.value.contains("file") != place.value.contains("random");
  if (!one) place.Refuse("needs either 'file' or 'random'");
  return rows;
}

// Files that a pattern names, below `folder`, in the order of their names; a name without * ? [ is
// itself, whether there is such a file or not.
std::vector<std::string> Expand(const fs::path& folder, const std::string& pattern) {
  if (pattern.find_first_of("*?[") == std::string::npos) return {pattern};
  glob_t found = {};
  const std::string full = (folder / pattern).string();
  std::vector<std::string> names;
  if (::glob(full.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t k = 0; k < found.gl_pathc; ++k) {
      names.push_back(fs::path(found.gl_pathv[k]).lexically_relative(folder).generic_string());
    }
  }
  ::globfree(&found);
  return names;
}

// The models of a case share everything else.
void ReadCase(const Place& place, const SuiteCase& defaults, Suite& suite) {
  SuiteCase read = defaults;
  std::vector<std::string> models;
  place.Members({
      {"model",
       [&](const Place& p) {
         models = Expand(suite.folder, p.Text());
         if (models.empty()) p.Refuse("names no file");
       }},
      {"configurations",
       [&](const Place& p) {
         for (const Place& rows : p.List()) read.rows.push_back(ReadRows(rows));
       }},
      {"options", [&](const Place& p) { ReadOptions(p, read.scene, read.options); }},
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
  std::vector<std::string> models;
  for (const SuiteCase& one : suite.cases) models.push_back(one.model);
  std::sort(models.begin(), models.end());
  const auto twice = std::adjacent_find(models.begin(), models.end());
  if (twice != models.end()) throw Error(suite.path + ": " + *twice + " is in two cases");
}

bool LooksLikeModel(const fs::path& path) {
  if (path.extension() == ".mjb") return true;
  if (path.extension() != ".xml") return false;
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return text.find("<mujoco") != std::string::npos &&
         text.find("<mujocoinclude") == std::string::npos;
}

// Files below a folder that may be models, sorted. Folders that cannot be read are told in
// `skipped`; the uppermost is an Error.
std::vector<fs::path> ModelsBelow(const std::string& top, std::vector<std::string>& skipped) {
  std::vector<fs::path> folders = {top}, found;
  while (!folders.empty()) {
    const fs::path folder = folders.back();
    folders.pop_back();
    std::error_code ec;
    fs::directory_iterator it(folder, ec);
    for (; !ec && it != fs::directory_iterator(); it.increment(ec)) {
      std::error_code unknown;
      if (it->is_directory(unknown) && !it->is_symlink(unknown)) {
        folders.push_back(it->path());
      } else if (it->is_regular_file(unknown) && LooksLikeModel(it->path())) {
        found.push_back(it->path());
      }
    }
    if (ec && folder == top) throw Error("--discover: " + top + ": " + ec.message());
    if (ec) skipped.push_back(folder.string() + ": " + ec.message());
  }
  std::sort(found.begin(), found.end());
  return found;
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
  if (!fs::exists(path, ec)) throw Error(path + ": no such file");
  if (fs::is_directory(path, ec)) {
    throw Error(path + ": is a folder (--discover makes a suite of one)");
  }
  std::ifstream file(path);
  if (!file) throw Error(path + ": cannot be opened");
  Json json;
  try {
    json = Json::parse(file);
  } catch (const nlohmann::json::exception& e) {
    throw Error(path + ": " + e.what());
  }
  Suite suite;
  suite.path = path;
  suite.folder = FolderOf(path);
  SuiteCase defaults;
  std::unique_ptr<Place> cases;
  int version = 0;
  Place{json, path}.Members({
      {"version", [&](const Place& p) { version = static_cast<int>(p.Number(0, 1e9)); }},
      {"options", [&](const Place& p) { ReadOptions(p, defaults.scene, defaults.options); }},
      {"sigma_tolerance", [&](const Place& p) { suite.sigma_tolerance = p.Number(0.0, 1e6); }},
      {"queries_tolerance", [&](const Place& p) { suite.queries_tolerance = p.Number(0.0, 1e6); }},
      {"cases", [&](const Place& p) { cases = std::make_unique<Place>(p); }},
  });
  if (version != kVersion) throw Error(path + ": version is not " + std::to_string(kVersion));
  if (!cases) throw Error(path + ": has no 'cases'");
  for (const Place& place : cases->List()) ReadCase(place, defaults, suite);
  CheckModelsAreOnce(suite);
  return suite;
}

Suite DiscoverSuite(const std::string& folder, std::vector<std::string>& skipped) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec)) throw Error("--discover: " + folder + ": no such folder");
  Suite suite;
  suite.folder = folder;
  suite.path = (fs::path(folder) / "pdg.json").string();
  for (const fs::path& path : ModelsBelow(folder, skipped)) {
    SuiteCase made;
    made.model = path.lexically_relative(folder).generic_string();
    made.rows.push_back({});
    try {
      Scene::FromFile(path.string());
      suite.cases.push_back(made);
    } catch (const Error& e) {
      skipped.push_back(e.what());
    }
  }
  if (suite.cases.empty()) throw Error("--discover: " + folder + ": has no model that loads");
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
