#include "apps/regress/discover.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <set>

#include "apps/input/text_file.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

// What cannot be opened may be one; loading it says why it cannot.
bool LooksLikeModel(const fs::path& path) {
  if (path.extension() == ".mjb") return true;
  if (path.extension() != ".xml") return false;
  if (!std::ifstream(path)) return true;
  const std::string text = ReadTextFile(path);
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

// The models of the suite that is there already, if any.
std::set<std::string> KnownModels(const std::string& path) {
  std::error_code ec;
  if (!fs::exists(path, ec)) return {};
  const Suite suite = ReadSuite(path);
  if (FormatSuite(suite) != ReadTextFile(path)) {
    throw Error("--discover: " + path +
                " says more than which models there are: name it as the suite, or remove it");
  }
  std::set<std::string> models;
  for (const SuiteCase& one : suite.cases) models.insert(one.model);
  return models;
}

// Why a model cannot be a case; empty: it can.
std::string Flaw(const fs::path& path, const std::string& model) {
  if (model != Utf8(model)) return path.string() + ": its name is no UTF-8";
  try {
    Scene::FromFile(path.string());
  } catch (const Error& e) {
    return e.what();
  } catch (const std::exception& e) {
    return path.string() + ": " + e.what();
  }
  return "";
}

}  // namespace

Suite DiscoverSuite(const std::string& folder, std::vector<std::string>& skipped) {
  std::error_code ec;
  const fs::file_status status = fs::status(folder, ec);
  if (!fs::is_directory(status)) {
    const std::string why = fs::status_known(status) ? "no such folder" : ec.message();
    throw Error("--discover: " + folder + ": " + why);
  }
  Suite suite;
  suite.folder = folder;
  suite.path = (fs::path(folder) / "pdg.json").string();
  const std::set<std::string> known = KnownModels(suite.path);
  for (const fs::path& path : ModelsBelow(folder, skipped)) {
    SuiteCase made;
    made.model = path.lexically_relative(folder).generic_string();
    made.rows.push_back({});
    const std::string flaw = Flaw(path, made.model);
    if (flaw.empty() || known.contains(made.model)) {
      suite.cases.push_back(made);
    } else {
      skipped.push_back(flaw);
    }
  }
  if (suite.cases.empty()) throw Error("--discover: " + folder + ": has no model that loads");
  return suite;
}

}  // namespace mjcf_pdg::app
