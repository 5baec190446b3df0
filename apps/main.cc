// The program mjcf-pdg: hands the command line to a verb, and every failure to one line on stderr.
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/console/mujoco_log.h"
#include "apps/console/text.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {
namespace {

int Fail(const std::string& message, int exit_code) {
  std::fprintf(stderr, "mjcf-pdg: error: %s\n", OneLine(message).c_str());
  return exit_code;
}

// Throws Error unless the first argument is a verb or an option. CLI11's own message for an unknown
// verb does not say which verbs there are.
void CheckVerb(const std::vector<Verb>& verbs, int argc, char** argv) {
  if (argc > 1 && argv[1][0] == '-') return;
  std::string names;
  for (const Verb& verb : verbs) {
    const std::string name = verb.command->get_name();
    if (argc > 1 && name == argv[1]) return;
    names += (names.empty() ? "" : ", ") + name;
  }
  if (argc < 2) throw Error("a verb is needed (verbs: " + names + "); see mjcf-pdg --help");
  throw Error("no verb '" + std::string(argv[1]) + "' (verbs: " + names + ")");
}

int Dispatch(int argc, char** argv) {
  Program program = MakeProgram();
  CheckVerb(program.verbs, argc, argv);
  try {
    program.app->parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    program.app->exit(request);
    return std::fflush(stdout) == 0 ? kExitFree : Fail("cannot write to stdout", kExitFailure);
  }
  for (Verb& verb : program.verbs) {
    if (!verb.command->parsed()) continue;
    const int exit_code = verb.run();
    for (const std::string& warning : TakeMujocoWarnings()) {
      WriteWarning(warning);
    }
    return exit_code;
  }
  throw Error("a verb is needed; see mjcf-pdg --help");
}

int Run(int argc, char** argv) {
  // Without this, writing to a closed pipe would end the program silently instead of with an error
  // line and exit code 1.
  std::signal(SIGPIPE, SIG_IGN);
  InstallMujocoLog();
  try {
    return Dispatch(argc, argv);
  } catch (const Error& e) {
    return Fail(e.what(), kExitBadInput);
  } catch (const CLI::Error& e) {
    return Fail(e.what(), kExitBadInput);
  } catch (const std::bad_alloc&) {
    return Fail("out of memory", kExitFailure);
  } catch (const std::exception& e) {
    return Fail(e.what(), kExitFailure);
  } catch (...) {
    return Fail("unknown error", kExitFailure);
  }
}

}  // namespace
}  // namespace mjcf_pdg::app

int main(int argc, char** argv) { return mjcf_pdg::app::Run(argc, argv); }
