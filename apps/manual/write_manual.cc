// Writes the manual pages into a folder: write_manual FOLDER. The build runs it; it is not
// installed.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

#include "apps/cli.h"
#include "apps/manual/manual_page.h"

namespace mjcf_pdg::app {
namespace {

void Write(const std::filesystem::path& folder, const Program& program, const CLI::App& command) {
  std::ofstream file;
  file.exceptions(std::ios::failbit | std::ios::badbit);
  file.open(folder / (ManualName(program, command) + ".1"), std::ios::binary);
  file << ManualPage(program, command);
  file.close();
}

}  // namespace
}  // namespace mjcf_pdg::app

int main(int argc, char** argv) {
  using namespace mjcf_pdg::app;
  if (argc != 2) return std::fprintf(stderr, "usage: write_manual FOLDER\n"), kExitBadInput;
  try {
    const Program program = MakeProgram();
    std::filesystem::create_directories(argv[1]);
    Write(argv[1], program, *program.app);
    for (const Verb& verb : program.verbs) Write(argv[1], program, *verb.command);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "write_manual: %s\n", e.what());
    return kExitFailure;
  }
  return kExitFree;
}
