// What main.cc and the verbs (subcommands) share: exit codes, how a verb is registered, and all of
// them together.
#ifndef MJCF_PDG_APPS_CLI_H_
#define MJCF_PDG_APPS_CLI_H_

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <vector>

namespace mjcf_pdg::app {

inline constexpr int kExitFree = 0;      // every configuration or motion asked about is free
inline constexpr int kExitFailure = 1;   // any other failure
inline constexpr int kExitBadInput = 2;  // usage or mjcf_pdg::Error; nothing was written
inline constexpr int kExitNotFree = 3;   // finished, but some configuration or motion is not free
inline constexpr int kExitSignal = 128;  // ... and the signal's number: interrupted

struct Verb {
  CLI::App* command = nullptr;  // owned by the program it was added to
  std::function<int()> run;     // returns the exit code; bad input throws mjcf_pdg::Error
};

// Each adds its verb with its options to the program.
Verb AddSolveVerb(CLI::App& program);
Verb AddNormVerb(CLI::App& program);
Verb AddCheckVerb(CLI::App& program);
Verb AddImportVerb(CLI::App& program);
Verb AddRegressVerb(CLI::App& program);
Verb AddAuditVerb(CLI::App& program);
Verb AddPlanVerb(CLI::App& program);  // in builds with OMPL
Verb AddReplayVerb(CLI::App& program);
Verb AddViewVerb(CLI::App& program);  // in builds with GLFW and Dear ImGui

// The whole command line: what main.cc parses and what the manual pages are written from.
struct Program {
  std::unique_ptr<CLI::App> app;
  std::vector<Verb> verbs;
};
Program MakeProgram();

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CLI_H_
