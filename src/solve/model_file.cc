#include "solve/model_file.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

namespace fs = std::filesystem;

constexpr int kErrorSize = 2000;
constexpr char kPackage[] = "package:", kFile[] = "file:";

std::string OneLine(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

// MuJoCo's words, or what helps where a file is no model or a plugin is not known.
std::string Explained(const std::string& words) {
  if (words.find("could not find decoder") != std::string::npos) {
    return "not a model: a file ending in .xml (MJCF), .urdf or .mjb is expected";
  }
  if (words.find("plugin ") == std::string::npos || words.find(" not found") == std::string::npos) {
    return words;
  }
  std::string known;
  for (int slot = 0; slot < mjp_pluginCount(); ++slot) {
    known += (slot == 0 ? "" : ", ") + std::string(mjp_getPluginAtSlot(slot)->name);
  }
  return words + "; plugins that are loaded: " + (known.empty() ? "none" : known) +
         " (more by --plugin-dir, in C++ by mj_loadPluginLibrary)";
}

// What follows the scheme and its slashes, of which one stays if `absolute`; empty if `name` does
// not begin with the scheme.
std::string AfterScheme(const std::string& name, const std::string& scheme, bool absolute) {
  if (name.rfind(scheme, 0) != 0) return "";
  const std::size_t begin = name.find_first_not_of('/', scheme.size());
  return begin == std::string::npos ? "" : (absolute ? "/" : "") + name.substr(begin);
}

// Folders in which the folder of a package may be.
std::vector<fs::path> PackageRoots(const std::string& model) {
  std::vector<fs::path> roots;
  std::error_code ec;
  for (fs::path folder = fs::absolute(model, ec).parent_path();; folder = folder.parent_path()) {
    roots.push_back(folder);
    if (folder == folder.parent_path()) break;
  }
  for (const auto& [variable, below] :
       {std::pair{"ROS_PACKAGE_PATH", ""}, {"AMENT_PREFIX_PATH", "share"}}) {
    const char* value = std::getenv(variable);
    std::istringstream list(value ? value : "");
    for (std::string entry; std::getline(list, entry, ':');) {
      if (!entry.empty()) roots.push_back(fs::path(entry) / below);
    }
  }
  return roots;
}

std::string FindInPackage(const std::string& name, const std::string& model) {
  std::error_code ec;
  for (const fs::path& root : PackageRoots(model)) {
    const fs::path file = (root / name).lexically_normal();
    if (fs::is_regular_file(file, ec)) return file.string();
  }
  const std::string package = name.substr(0, name.find('/'));
  throw Error("mesh 'package://" + name + "' is not found: no such file in a folder '" + package +
              "' beside the model or above it, nor by ROS_PACKAGE_PATH or AMENT_PREFIX_PATH");
}

void ResolvePackages(const std::string& path, mjSpec* spec) {
  for (mjsElement* e = mjs_firstElement(spec, mjOBJ_MESH); e; e = mjs_nextElement(spec, e)) {
    mjString* file = mjs_asMesh(e)->file;
    const std::string name = mjs_getString(file);
    const std::string in_package = AfterScheme(name, kPackage, false);
    const std::string absolute = AfterScheme(name, kFile, true);
    if (!in_package.empty()) mjs_setString(file, FindInPackage(in_package, path).c_str());
    if (!absolute.empty()) mjs_setString(file, absolute.c_str());
  }
}

struct ModelDeleter {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};

}  // namespace

SpecPtr ParseModelFile(const std::string& path) {
  std::string error(kErrorSize, '\0');
  SpecPtr spec(mj_parse(path.c_str(), nullptr, nullptr, error.data(), kErrorSize));
  if (!spec) throw Error(Explained(OneLine(error.c_str())));
  ResolvePackages(path, spec.get());
  return spec;
}

SpecPtr ParseModelText(const std::string& xml) {
  std::string error(kErrorSize, '\0');
  SpecPtr spec(mj_parseXMLString(xml.c_str(), nullptr, error.data(), kErrorSize));
  if (!spec) throw Error(Explained(OneLine(error.c_str())));
  return spec;
}

std::shared_ptr<const mjModel> CompileModel(mjSpec* spec) {
  mjModel* model = mj_compile(spec, nullptr);
  if (!model) throw Error(OneLine(mjs_getError(spec)));
  return {model, ModelDeleter{}};
}

std::shared_ptr<const mjModel> LoadModelFile(const std::string& path) {
  if (fs::path(path).extension() != ".mjb") return CompileModel(ParseModelFile(path).get());
  mjModel* loaded = mj_loadModel(path.c_str(), nullptr);
  if (!loaded) {
    throw Error(std::string("not a binary model of MuJoCo ") + mj_versionString() +
                ", which reads those of its own version alone: pass the XML that it is made of");
  }
  std::shared_ptr<const mjModel> model(loaded, ModelDeleter{});
  // It has only the places in which plugins were registered where it was compiled: others may be
  // there now.
  if (model->nplugin > 0) {
    throw Error(
        "a binary model does not say which plugins it uses: pass the XML that it is made of");
  }
  return model;
}

}  // namespace mjcf_pdg
