// Which configurations a verb is asked about: keyframes, numbers on the command line, a file.
#ifndef MJCF_PDG_APPS_CONFIGURATIONS_H_
#define MJCF_PDG_APPS_CONFIGURATIONS_H_

#include <CLI/CLI.hpp>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/qpos_file.h"
#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::app {

struct WhichArguments {
  std::vector<std::string> keys;  // names or indices
  std::vector<std::string> qpos;  // one configuration each
  std::string file;               // "-" is stdin
};

struct Configuration {
  std::string label;  // never empty: the keyframe's name, "key3", "qpos0", "row7"
  std::string name;   // of the keyframe, if it has one
  int key = -1;       // index of the keyframe; -1: not from a keyframe
  std::vector<double> q;
  // Where the keyframe puts the mocap bodies; empty: as in the model.
  std::vector<double> mocap_pos, mocap_quat;
};

void AddWhich(CLI::App& command, WhichArguments& arguments);  // --key, --qpos, --qpos-file

// The configurations that were asked for, one after the other, at least one. Those of the command
// line are checked at once, those of a file as they come: Error names the keyframe, the flag, or
// the file and line.
class RowSource {
 public:
  // Keeps a reference to the scene.
  RowSource(const Scene& scene, const WhichArguments& arguments);

  // False after the last one.
  bool Next(Configuration& row);
  // How many there are, where that is known before they are read.
  std::optional<std::size_t> size() const;

 private:
  const Scene& scene_;
  std::vector<Configuration> listed_;
  std::unique_ptr<QposFile> file_;
  std::string origin_;
  std::size_t next_ = 0;
};

// From one configuration to another.
struct EndsArguments {
  std::string from, to;  // nq numbers each
};

struct Ends {
  std::vector<double> from, to;
};

// --from, --to: both options, to make them required or to tie them to another.
std::vector<CLI::Option*> AddEnds(CLI::App& command, EndsArguments& arguments);

// Both valid (else Error names the flag).
Ends ReadEnds(const Scene& scene, const EndsArguments& arguments);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CONFIGURATIONS_H_
