// regress --discover: a suite of the models below a folder.
#ifndef MJCF_PDG_APPS_REGRESS_DISCOVER_H_
#define MJCF_PDG_APPS_REGRESS_DISCOVER_H_

#include <string>
#include <vector>

#include "apps/regress/suite.h"

namespace mjcf_pdg::app {

// All models below a folder that load, with their keyframes; DIR/pdg.json is its file, and models
// that stand there already stay, whether they load or not. `skipped` gets one line for each other
// file that may be a model but cannot be loaded, and for each folder that cannot be read. Throws
// Error if the folder itself cannot be read or has no model, or if there is a DIR/pdg.json already
// which says more than which models there are: that would be lost.
Suite DiscoverSuite(const std::string& folder, std::vector<std::string>& skipped);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_REGRESS_DISCOVER_H_
