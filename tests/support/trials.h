// How many trials a test makes.
#ifndef MJCF_PDG_TESTS_SUPPORT_TRIALS_H_
#define MJCF_PDG_TESTS_SUPPORT_TRIALS_H_

namespace mjcf_pdg::test {

// Under sanitizers, where code takes ten times as long, a quarter: what they look for is in every
// trial, and CI has an hour for the whole suite.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr int kFewer = 4;
#else
inline constexpr int kFewer = 1;
#endif

constexpr int Trials(int n) { return n / kFewer; }

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_TRIALS_H_
