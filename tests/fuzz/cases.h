// Cases for fuzzing, each made from its seed alone: what the library is given, and what must hold.
#ifndef MJCF_PDG_TESTS_FUZZ_CASES_H_
#define MJCF_PDG_TESTS_FUZZ_CASES_H_

#include <cstdint>
#include <string>

namespace mjcf_pdg::test {

// What became of a case.
struct CaseOutcome {
  std::string kind;   // "refused", or what was found: "free", "solved", "unsolved", "read", ...
  std::string wrong;  // what does not hold, with the seed's input; empty: all holds
};

// A random scene and a configuration: verdict, IsFree, norm and bound are finite and agree with
// each other, and what is called free is so by the judge.
CaseOutcome VerdictCase(std::uint64_t seed);

// ... that is solved, with a budget of queries: what comes out is finite, free by the judge if it
// says so, and no nearer than the lower bound.
CaseOutcome SolvingCase(std::uint64_t seed);

// ... from which a path to another is planned, by any planner: no tree grows without end, and the
// judge finds nothing against places on the path.
CaseOutcome PlanningCase(std::uint64_t seed);

// MJCF, .npy, .csv, .jsonl or a mesh file with bytes that are changed, left out or repeated: it is
// read as finite numbers or refused by an Error.
CaseOutcome BytesCase(std::uint64_t seed);

// Turns MuJoCo's errors into exceptions, as the program does, and drops its warnings, while it
// lives.
class QuietMujoco {
 public:
  QuietMujoco();
  ~QuietMujoco();
  QuietMujoco(const QuietMujoco&) = delete;
  QuietMujoco& operator=(const QuietMujoco&) = delete;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_FUZZ_CASES_H_
