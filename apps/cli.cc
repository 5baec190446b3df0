#include "apps/cli.h"

namespace mjcf_pdg::app {

Program MakeProgram() {
  Program program;
  program.app = std::make_unique<CLI::App>(
      "Nearest collision-free configuration of a MuJoCo model, under the object norm (PDg).",
      "mjcf-pdg");
  CLI::App& app = *program.app;
  app.require_subcommand(1);
  program.verbs = {AddSolveVerb(app),   AddNormVerb(app),   AddCheckVerb(app), AddAuditVerb(app),
                   AddRegressVerb(app), AddImportVerb(app), AddReplayVerb(app)};
#ifdef MJCF_PDG_HAVE_PLAN
  program.verbs.push_back(AddPlanVerb(app));
#endif
#ifdef MJCF_PDG_HAVE_VIEW
  program.verbs.push_back(AddViewVerb(app));
#endif
  constexpr char kVersion[] = "mjcf-pdg " MJCF_PDG_VERSION;
  app.set_version_flag("--version", kVersion);
  for (Verb& verb : program.verbs) verb.command->set_version_flag("--version", kVersion);
  app.footer(
      "Exit codes: 0 all free or made free, 2 bad input, 3 some configuration is not free, 1 "
      "other.");
  return program;
}

}  // namespace mjcf_pdg::app
