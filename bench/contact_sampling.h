// The method that the paper compares itself with in Table II: random sampling on the contact space.
//
// Source: Zhang, Kim, Varadhan, Manocha: Generalized penetration depth computation (2007), as Tang
// & Kim describe it (Sec. 1, 6.1): "a contact-space sampling ... relies on random sampling on
// contact space to optimize the object norm", from the same free configuration. Here: poses drawn
// in the ball of the object norm that the best answer spans about q_in; a free one is projected
// towards q_in, a colliding one is approached from the best answer. Every contact configuration is
// certified by our CCD; the one of least σ is kept.
#ifndef MJCF_PDG_BENCH_CONTACT_SAMPLING_H_
#define MJCF_PDG_BENCH_CONTACT_SAMPLING_H_

#include <cstdint>
#include <limits>

#include "problem/workspace.h"

namespace mjcf_pdg::bench {

struct SamplingResult {
  bool free = false;
  VectorXd q;
  double sigma = std::numeric_limits<double>::infinity();  // [m²]
  int samples = 0;
};

// Samples for `seconds` of processor time. The problem's selection finds the first free pose.
SamplingResult SampleContactSpace(Workspace& work, double seconds, std::uint64_t seed);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_CONTACT_SAMPLING_H_
