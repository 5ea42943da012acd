// Memory for a whole map.
#pragma once

#include <algorithm>
#include <cstddef>
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

// In large pages, where the system has them: to provide the small ones of a map of 2000 x 2000 cells takes a third as
// long as the field.
template <typename Number>
std::unique_ptr<Number[], Freed> allocate(std::size_t count) {
  constexpr std::size_t kLargePage = std::size_t{1} << 21;
  constexpr std::size_t kAligned = std::max(alignof(Number), alignof(std::max_align_t));
  const std::size_t wanted = std::max<std::size_t>(count, 1) * sizeof(Number);
  const bool large = wanted > 2 * kLargePage;
  const std::size_t unit = large ? kLargePage : kAligned, bytes = (wanted + unit - 1) / unit * unit;
  void *memory = std::aligned_alloc(unit, bytes);
  if (memory == nullptr) throw std::bad_alloc();
#if defined(__linux__)
  if (large) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
  return std::unique_ptr<Number[], Freed>(static_cast<Number *>(memory));
}

}  // namespace trundle
