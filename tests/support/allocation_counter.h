// Counts what this thread takes from the heap: operator new, malloc and their kin, by whoever in
// the process asks, MuJoCo and Eigen included.
//
// The counting is in place in every program that links this file. It hooks the C library's
// functions (of glibc; other C libraries count nothing, see works()), or the sanitizers' where the
// program is built with them.
#ifndef MJCF_PDG_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
#define MJCF_PDG_TESTS_SUPPORT_ALLOCATION_COUNTER_H_

#include <cstdint>

namespace mjcf_pdg::test {

class AllocationCounter {
 public:
  AllocationCounter() : at_first_(Total()) {}

  // Since construction, by this thread.
  std::int64_t count() const { return Total() - at_first_; }

  // A test allocation is seen.
  static bool Works();

 private:
  static std::int64_t Total();

  std::int64_t at_first_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_ALLOCATION_COUNTER_H_
