#include "tests/support/allocation_counter.h"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace mjcf_pdg::test {
namespace {

thread_local std::int64_t total = 0;

}  // namespace

std::int64_t AllocationCounter::Total() { return total; }

bool AllocationCounter::Works() {
  // The compiler knows that malloc itself counts nothing, and would not look again.
  void* (*volatile take)(std::size_t) = std::malloc;
  const AllocationCounter counter;
  std::free(take(1));
  return counter.count() > 0;
}

}  // namespace mjcf_pdg::test

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

// The sanitizers replace malloc themselves; they call the hooks that are installed here.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                             std::size_t),
                                                         void (*free_hook)(const volatile void*));

namespace {

const int installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++mjcf_pdg::test::total; },
    [](const volatile void*) {});

}  // namespace

#elif defined(__GLIBC__)

// If a program defines malloc, all its libraries call that one (libc.info, "Replacing malloc").
extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) {
  ++mjcf_pdg::test::total;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  ++mjcf_pdg::test::total;
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  ++mjcf_pdg::test::total;
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  ++mjcf_pdg::test::total;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = memalign(alignment, size);
  return *out ? 0 : ENOMEM;
}

void free(void* block) { __libc_free(block); }

}  // extern "C"

#endif
