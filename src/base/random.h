// A small deterministic random number generator. A seed gives the same bits and uniform numbers on
// every machine; normal numbers depend on the C library's log and cos.
#ifndef MJCF_PDG_SRC_BASE_RANDOM_H_
#define MJCF_PDG_SRC_BASE_RANDOM_H_

#include <cmath>
#include <cstdint>

namespace mjcf_pdg {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  // The next 64 random bits, by SplitMix64 (Steele, Lea, Flood 2014).
  std::uint64_t Bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  // Uniformly distributed in the open interval (0, 1).
  double Uniform() { return (static_cast<double>(Bits() >> 11) + 0.5) * 0x1.0p-53; }

  // Normally distributed with mean 0 and variance 1 (Box-Muller).
  double Normal() {
    const double radius = std::sqrt(-2.0 * std::log(Uniform()));
    return radius * std::cos(6.283185307179586 * Uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_RANDOM_H_
