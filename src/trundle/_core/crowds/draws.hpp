// Random numbers as NumPy's `default_rng` draws them, so that a seed gives a crowd the same places here and there.
//
// The generator is PCG XSL RR 128/64 (O'Neill 2014); whole numbers are drawn without division (Lemire 2019).
#pragma once

#include <cstdint>

namespace trundle::crowds {

class Draws {
 public:
  Draws() = default;
  // `words`: the state of 128 bits and the stream, the high half of each first.
  explicit Draws(const std::uint64_t *words) {
    stream_ = ((Wide{words[2]} << 64 | words[3]) << 1) | 1u;
    advance();
    state_ += Wide{words[0]} << 64 | words[1];
    advance();
  }

  // From `low` up to `high`, which is left out.
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }

  // 0 to count − 1.
  std::uint32_t whole(std::uint32_t count) {
    if (count < 2) return 0;
    std::uint64_t product = std::uint64_t{half()} * count;
    if (static_cast<std::uint32_t>(product) < count) {
      const std::uint32_t least = (0u - count) % count;
      while (static_cast<std::uint32_t>(product) < least) product = std::uint64_t{half()} * count;
    }
    return static_cast<std::uint32_t>(product >> 32);
  }

 private:
  __extension__ using Wide = unsigned __int128;

  void advance() {
    constexpr Wide factor = Wide{0x2360ed051fc65da4ull} << 64 | 0x4385df649fccf645ull;
    state_ = state_ * factor + stream_;
  }

  std::uint64_t next() {
    advance();
    const auto high = static_cast<std::uint64_t>(state_ >> 64);
    const std::uint64_t mixed = high ^ static_cast<std::uint64_t>(state_);
    const unsigned turn = static_cast<unsigned>(high >> 58);
    return mixed >> turn | mixed << (-turn & 63u);
  }

  // 32 bits; the upper ones of a number serve the next call.
  std::uint32_t half() {
    if (has_half_) {
      has_half_ = false;
      return kept_;
    }
    const std::uint64_t whole = next();
    has_half_ = true;
    kept_ = static_cast<std::uint32_t>(whole >> 32);
    return static_cast<std::uint32_t>(whole);
  }

  Wide state_ = 0, stream_ = 1;
  std::uint32_t kept_ = 0;
  bool has_half_ = false;
};

}  // namespace trundle::crowds
