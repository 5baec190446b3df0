#include "apps/input/plugins.h"

#include <dlfcn.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/console/mujoco_log.h"
#include "apps/console/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

// The shared libraries in a folder, by name; none if it cannot be read.
std::vector<fs::path> LibrariesIn(const fs::path& folder) {
  std::vector<fs::path> libraries;
  std::error_code ec;
  for (fs::directory_iterator entry(folder, ec), end; !ec && entry != end; entry.increment(ec)) {
    if (entry->path().extension() == ".so") libraries.push_back(fs::absolute(entry->path()));
  }
  std::sort(libraries.begin(), libraries.end());
  return libraries;
}

// Loads a plugin library, which registers its plugins while dlopen runs. Returns what went wrong.
// (mj_loadPluginLibrary does the same, but ends in MuJoCo's error handler.)
std::string Load(const fs::path& library) {
  std::string failure;
  std::vector<std::string> errors = MujocoErrorsDuring([&] {
    if (!dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL)) failure = dlerror();
  });
  if (failure.empty() && !errors.empty()) failure = library.string() + ": " + errors.front();
  return failure;
}

// The folder with MuJoCo's own plugins: as in the wheel and our packages, or as in the release.
fs::path MujocoPluginFolder() {
  Dl_info info;
  if (!dladdr(reinterpret_cast<const void*>(&mj_version), &info) || !info.dli_fname) return {};
  std::error_code ec;
  const fs::path folder = fs::canonical(info.dli_fname, ec).parent_path();
  const fs::path release = folder.parent_path() / "bin/mujoco_plugin";
  return fs::is_directory(folder / "plugin", ec) ? folder / "plugin" : release;
}

void LoadPlugins(const std::vector<std::string>& folders) {
  std::set<fs::path> loaded;  // file names
  for (const std::string& folder : folders) {
    const std::vector<fs::path> libraries = LibrariesIn(folder);
    if (libraries.empty()) {
      throw Error("--plugin-dir: " + folder +
                  ": no such folder, or no plugin library (*.so) in it");
    }
    for (const fs::path& library : libraries) {
      const std::string failure = Load(library);
      if (!failure.empty()) throw Error("--plugin-dir: " + failure);
      loaded.insert(library.filename());
    }
  }
  for (const fs::path& library : LibrariesIn(MujocoPluginFolder())) {
    if (loaded.contains(library.filename())) continue;
    const std::string failure = Load(library);
    if (!failure.empty()) WriteWarning("a plugin library of MuJoCo is not loaded: " + failure);
  }
}

}  // namespace

void AddPlugins(CLI::App& command) {
  auto folders = std::make_shared<std::vector<std::string>>();
  command
      .add_option("--plugin-dir", *folders,
                  "load the MuJoCo plugins of this folder, too (MuJoCo's own always are); "
                  "repeatable")
      ->type_name("DIR")
      ->allow_extra_args(false);
  command.final_callback([folders] { LoadPlugins(*folders); });
}

}  // namespace mjcf_pdg::app
