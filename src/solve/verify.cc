#include "mjcf_pdg/pdg.h"
#include "solve/options.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

Verdict Verify(const Scene& scene, const std::vector<double>& q, const Options& options,
               const std::vector<double>* q_in) {
  scene.CheckConfiguration(q);
  if (q_in) scene.CheckConfiguration(*q_in);
  CheckOptions(options, *scene.model());
  Verifier verifier(scene.verifier_model(), options);
  verifier.SetMocap(options.mocap_pos, options.mocap_quat);
  return verifier.Check(q, q_in ? std::span<const double>(*q_in) : std::span<const double>());
}

}  // namespace mjcf_pdg
