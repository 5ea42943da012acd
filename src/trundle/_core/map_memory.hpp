// Memory for a whole map.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace trundle {

struct Freed {
  void operator()(void *memory) const noexcept { std::free(memory); }
};

// In large pages, where the system has them to give: the small ones of a map of 2000 x 2000 cells take it as long to
// find as a third of the field.
template <typename Number>
std::unique_ptr<Number[], Freed> allocate(std::size_t count) {
  constexpr std::size_t kLargePage = std::size_t{1} << 21;
  const std::size_t pages = (std::max<std::size_t>(count, 1) * sizeof(Number) + kLargePage - 1) / kLargePage;
  const std::size_t bytes = pages * kLargePage;
  void *memory = bytes > 2 * kLargePage ? std::aligned_alloc(kLargePage, bytes) : std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
#if defined(__linux__)
  if (bytes > 2 * kLargePage) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
  return std::unique_ptr<Number[], Freed>(static_cast<Number *>(memory));
}

}  // namespace trundle
