#include "components.h"

#include <algorithm>
#include <string>
#include <vector>

#include "free_configuration.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg {

std::vector<std::string> Components(Method method) {
  if (method == Method::kPaper) {
    std::vector<std::string> names = FreeConfigurationSelection::Names();
    names.insert(names.end(), {"corrections", "reverse_projection"});
    return names;
  }
  return {"direct",         "mirror",           "noise",     "hop",       "constrained_translation",
          "pair_by_pair",   "anywhere",         "user_pose", "polish",    "early_exit",
          "witness_memory", "motion_coherence", "damping",   "warm_start"};
}

void CheckComponents(const Options& options) {
  const std::vector<std::string> known = Components(options.method);
  for (const std::string& name : options.without) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string message = "cannot leave out '" + name + "': the method has";
    for (std::size_t k = 0; k < known.size(); ++k) message += (k ? ", " : " ") + known[k];
    throw Error(message);
  }
}

}  // namespace mjcf_pdg
