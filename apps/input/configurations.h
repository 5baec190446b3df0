// The configurations that a verb is asked about: keyframes, numbers on the command line, or a file.
#ifndef MJCF_PDG_APPS_INPUT_CONFIGURATIONS_H_
#define MJCF_PDG_APPS_INPUT_CONFIGURATIONS_H_

#include <CLI/CLI.hpp>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/input/qpos_file.h"
#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::app {

struct WhichArguments {
  std::vector<std::string> keys;  // names or indices
  std::vector<std::string> qpos;  // each the nq numbers of a configuration
  std::string file;               // "-" is stdin
};

struct Configuration {
  std::string label;  // never empty: the keyframe's name, "key3", "qpos0", "row7"
  std::string name;   // the keyframe's name; empty: no keyframe, or one without a name
  int key = -1;       // index of the keyframe; -1: not from a keyframe
  std::vector<double> q;
  // The keyframe's poses of the mocap bodies, as in Options; empty: as in the model.
  std::vector<double> mocap_pos, mocap_quat;
};

// Adds the options --key, --qpos and --qpos-file, of which one kind may be given.
void AddWhich(CLI::App& command, WhichArguments& arguments);

// The configurations that were asked for, one after the other, at least one. Those of the command
// line are checked at once, those of a file as they come: Error names the keyframe, the flag, or
// the file and line.
class RowSource {
 public:
  // Keeps a reference to the scene.
  RowSource(const Scene& scene, const WhichArguments& arguments);

  // False after the last one.
  bool Next(Configuration& row);
  // How many there are, as far as that is known before they are read (see QposFile::size).
  std::optional<std::size_t> size() const;

 private:
  const Scene& scene_;
  std::vector<Configuration> listed_;
  std::unique_ptr<QposFile> file_;
  std::string origin_;
  std::size_t next_ = 0;
};

// The configuration that a flag names: a keyframe's name, its index (if nq > 1), or nq numbers.
// Throws Error, which names the flag, if it is none of these.
Configuration ReadConfiguration(const Scene& scene, const std::string& text,
                                const std::string& flag);

// The two ends of a change of configuration, as text.
struct EndsArguments {
  std::string from, to;  // nq numbers each
};

struct Ends {
  std::vector<double> from, to;  // nq values each
};

// Adds --from and --to. Returns both options, so that the caller can make them required or tie them
// to another one.
std::vector<CLI::Option*> AddEnds(CLI::App& command, EndsArguments& arguments);

// Parses both ends. Throws Error, which names the flag, unless both are valid.
Ends ReadEnds(const Scene& scene, const EndsArguments& arguments);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_INPUT_CONFIGURATIONS_H_
