// What a case of fuzzing begins with, and the judge's word on what comes out.
#ifndef MJCF_PDG_TESTS_FUZZ_PROBLEM_H_
#define MJCF_PDG_TESTS_FUZZ_PROBLEM_H_

#include <optional>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "tests/fuzz/random_scene.h"

namespace mjcf_pdg::test {

// A scene and a configuration of it.
struct Problem {
  RandomScene drawn;
  std::optional<Scene> scene;  // none: it does not compile, or is refused
  std::vector<double> q;
  Options options;  // tolerance and seed are drawn, too

  explicit Problem(Random& rng);
  std::string Words() const;
};

// What the judge says against "q is free"; empty: nothing.
std::string Refute(const Problem& problem, const std::vector<double>& q);

bool Finite(const std::vector<double>& values);
bool Finite(const std::vector<Contact>& contacts);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_FUZZ_PROBLEM_H_
