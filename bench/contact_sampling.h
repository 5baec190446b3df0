// The method that the paper compares itself with in Table II: random sampling on the contact space.
//
// Source: Zhang, Kim, Varadhan, Manocha: Generalized penetration depth computation (2007), as Tang
// & Kim describe it (Sec. 1, 6.1): "a contact-space sampling ... relies on random sampling on
// contact space to optimize the object norm", from the same free configuration. Here poses are
// drawn from the ball about q_in of the object norm whose radius is the best σ so far. A free pose
// is moved towards q_in, and from the best answer there is a motion towards a colliding one. Each
// motion is checked by our CCD, so that the contact configuration where it ends is certified, and
// the one with the least σ is kept.
#ifndef MJCF_PDG_BENCH_CONTACT_SAMPLING_H_
#define MJCF_PDG_BENCH_CONTACT_SAMPLING_H_

#include <cstdint>
#include <limits>

#include "problem/workspace.h"

namespace mjcf_pdg::bench {

struct SamplingResult {
  bool free = false;  // something free was found: `q`
  VectorXd q;
  double sigma = std::numeric_limits<double>::infinity();  // [m²]
  int samples = 0;                                         // motions that were checked
};

// Samples for `seconds` of processor time. The first free configuration is that of the paper's
// selection.
SamplingResult SampleContactSpace(Workspace& work, double seconds, std::uint64_t seed);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_CONTACT_SAMPLING_H_
