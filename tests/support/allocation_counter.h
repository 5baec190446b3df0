// Counts heap allocations of the calling thread: operator new, malloc and their kin, whoever in the
// process calls them, MuJoCo and Eigen included.
//
// Every program that links this file counts. It replaces the C library's functions (glibc only;
// with other C libraries nothing is counted, see Works), or uses the sanitizers' hooks if the
// program is built with sanitizers.
#ifndef MJCF_PDG_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
#define MJCF_PDG_TESTS_SUPPORT_ALLOCATION_COUNTER_H_

#include <cstdint>

namespace mjcf_pdg::test {

class AllocationCounter {
 public:
  AllocationCounter() : at_first_(Total()) {}

  // Allocations of this thread since construction.
  std::int64_t count() const { return Total() - at_first_; }

  // True if a test allocation is counted.
  static bool Works();

 private:
  static std::int64_t Total();

  std::int64_t at_first_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
