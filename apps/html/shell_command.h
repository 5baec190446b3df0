// Command lines that a report shows, to make what it shows again.
#ifndef MJCF_PDG_APPS_HTML_SHELL_COMMAND_H_
#define MJCF_PDG_APPS_HTML_SHELL_COMMAND_H_

#include <string>
#include <vector>

#include "apps/input/configurations.h"

namespace mjcf_pdg::app {

// "mjcf-pdg WORD ...", each word as a POSIX shell reads it.
std::string ShellCommand(const std::vector<std::string>& words);

// How one row of a command is made again: its words (the verb, the model), then its options.
struct RowCommand {
  std::vector<std::string> words, options;

  // With the numbers of the row at full precision, or, as only a keyframe brings poses of mocap
  // bodies, with its key. `output` writes to standard output: --json has all that a report shows,
  // but for the iterations, which --trace has.
  std::string Of(const Configuration& row, const std::string& output = "--json") const;
};

// Makes the joints of a report again, once ends are added.
std::string NormCommand(const std::string& model, const std::vector<std::string>& options);

// nq numbers at full precision, as --qpos takes them.
std::string QposWords(const std::vector<double>& q);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_SHELL_COMMAND_H_
