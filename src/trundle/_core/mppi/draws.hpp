// Random numbers that depend on a seed and a place alone: hashed counters (splitmix64: Steele, Lea and Flood 2014),
// summed up to numbers that are nearly normal (Irwin-Hall). Whole numbers up to the last step, so the same everywhere.
#pragma once

#include <cstdint>

namespace trundle::mppi {

inline std::uint64_t hashed(std::uint64_t counter) {
  std::uint64_t z = counter * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

// The sum of twelve numbers of 16 bits: mean 0, variance 1, within ±6.
inline float normal(std::uint64_t seed, std::uint64_t index) {
  const std::uint64_t first = hashed(seed + 1) + 3 * index;
  std::int32_t sum = 0;
  for (std::uint64_t i = 0; i < 3; ++i) {
    for (std::uint64_t bits = hashed(first + i), k = 0; k < 4; ++k, bits >>= 16) {
      sum += static_cast<std::int32_t>(bits & 0xffff);
    }
  }
  return static_cast<float>(sum - 6 * 65535) * (1.0f / 65536.0f);
}

}  // namespace trundle::mppi
