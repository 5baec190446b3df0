// Manual pages, for man(1), of the commands as --help knows them.
#ifndef MJCF_PDG_APPS_MANUAL_MANUAL_PAGE_H_
#define MJCF_PDG_APPS_MANUAL_MANUAL_PAGE_H_

#include <CLI/CLI.hpp>
#include <string>

#include "apps/cli.h"

namespace mjcf_pdg::app {

// The page of the program itself, or of one of its verbs, in the man(7) language. The options with
// their units, defaults and words are read from `command`, so that the page says what --help says.
std::string ManualPage(const Program& program, const CLI::App& command);

// The name of that page: mjcf-pdg or mjcf-pdg-VERB.
std::string ManualName(const Program& program, const CLI::App& command);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_MANUAL_MANUAL_PAGE_H_
