// MuJoCo's plugins. A plugin library registers its plugins with MuJoCo for the whole process when
// it is loaded, and stays. So the program loads them, not the library (mjcf_pdg/pdg.h), which
// changes nothing that its user's other code could notice: who embeds it calls
// mj_loadPluginLibrary, and Python's mujoco loads MuJoCo's own when it is imported.
#ifndef MJCF_PDG_APPS_INPUT_PLUGINS_H_
#define MJCF_PDG_APPS_INPUT_PLUGINS_H_

#include <CLI/CLI.hpp>

namespace mjcf_pdg::app {

// Adds --plugin-dir, for a command that loads models. When the command line has been parsed, the
// plugin libraries (*.so) of those folders are loaded by name, and then MuJoCo's own, which lie
// beside libmujoco: those of the same file name are not loaded twice. That takes 0.2 ms, whether
// the model names a plugin or not. Parsing throws Error for a folder without plugin libraries, for
// a library of it that cannot be loaded, and for one whose plugins have the names of others. One of
// MuJoCo's own that cannot be loaded is a warning: most models need none.
void AddPlugins(CLI::App& command);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_INPUT_PLUGINS_H_
