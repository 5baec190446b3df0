// The starts and steps that Options::without can leave out.
#ifndef MJCF_PDG_SRC_COMPONENTS_H_
#define MJCF_PDG_SRC_COMPONENTS_H_

#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

// Throws Error for a name in options.without that options.method does not have.
void CheckComponents(const Options& options);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COMPONENTS_H_
