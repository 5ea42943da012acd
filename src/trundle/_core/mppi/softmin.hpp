// Weights of samples by their costs: exp(−cost / temperature), with the temperature at which as many samples as are
// wanted take effect (effective sample size: Kong, Liu and Wong 1994). It is found by regula falsi, Illinois variant
// (Dowell and Jarratt 1971).
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "mppi/lanes.hpp"

namespace trundle::mppi {

class Softmin {
 public:
  void reserve(int samples) { gaps_.resize(static_cast<std::size_t>(samples)), weights_.resize(gaps_.size()); }

  // Weights of the samples whose cost is below kUnused; the others have weight 0. `aim` is the effective sample size.
  void weigh(float lowest, float aim) {
    double sum = 0.0;
    int used = 0;
    for (float &gap : gaps_) {
      if (gap < kUnused) gap -= lowest, sum += gap, ++used;
    }
    const float mean = used > 0 ? static_cast<float>(sum / used) : 0.0f;
    const float scale = mean > 1e-20f ? mean : 1.0f;
    float low = kColdest, high = kHottest, at = 0.0f;
    float below = total(scale, low) - aim, above = total(scale, high) - aim, off = above;
    for (int tries = 0, side = 0; tries < kTries && std::fabs(off) > kClose * aim; ++tries) {
      const bool halve = tries < kHalvings || !(below < 0.0f && above > 0.0f);
      at = halve ? 0.5f * (low + high) : (low * above - high * below) / (above - below);
      off = total(scale, at) - aim;
      if (off > 0.0f) {
        high = at, above = off;
        if (side == 1) below *= 0.5f;
        side = 1;
      } else {
        low = at, below = off;
        if (side == -1) above *= 0.5f;
        side = -1;
      }
    }
    temperature_ = scale * power(at);
    effective_ = off + aim;
    const float share = 1.0f / sum_;
    for (float &weight : weights_) weight *= share;
  }

  // The samples' costs, to be weighed; then what they are above the lowest.
  float *gaps() { return gaps_.data(); }
  const float *weights() const { return weights_.data(); }
  float temperature() const { return temperature_; }
  float effective() const { return effective_; }

  static constexpr float kUnused = 1e30f;

 private:
  using V = Floats<16>;
  using I = Ints<V>::Type;
  static constexpr int kHalvings = 3, kTries = 40;
  static constexpr float kClose = 1e-4f;
  static constexpr float kColdest = -14.0f, kHottest = 8.0f;  // powers of 2 of the mean gap

  // 2^x, of x ≤ 0: whole part into the exponent, Taylor's series of the rest. Below 2^−126 it is 0.
  static TRUNDLE_INLINE V power(V x) {
    const V clamped = largest(x, fill<V>(-126.0f));
    const I bits = whole(clamped);
    const V z = (clamped - floats<V>(bits)) * 0.69314718f;
    const V series = 1.0f + z * (1.0f + z * (1.0f / 2 + z * (1.0f / 6 + z * (1.0f / 24 + z * (1.0f / 120 +
                     z * (1.0f / 720 + z * (1.0f / 5040)))))));
    const I raised = (bits + 127) << 23;
    V scaled;
    std::memcpy(&scaled, &raised, sizeof scaled);
    return x > -126.0f ? series * scaled : V{};
  }

  // The same of one number of either sign.
  static float power(float exponent) {
    const V positive = fill<V>(exponent < 0.0f ? exponent : -exponent);
    const float small = power(positive)[0];
    return exponent < 0.0f ? small : 1.0f / small;
  }

  // Effective sample size at a temperature, whose weights are kept.
  float total(float scale, float exponent) {
    const float rate = -1.44269504f / (scale * power(exponent));
    V sum{}, squares{};
    for (std::size_t i = 0; i < gaps_.size(); i += kLaneCount<V>) {
      const V weights = power(loaded<V>(gaps_.data() + i) * rate);
      std::memcpy(weights_.data() + i, &weights, sizeof weights);
      sum = sum + weights;
      squares = squares + weights * weights;
    }
    sum_ = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    return sum_ * sum_ / ((squares[0] + squares[1]) + (squares[2] + squares[3]));
  }

  std::vector<float> gaps_, weights_;
  float temperature_ = 0.0f, effective_ = 0.0f, sum_ = 0.0f;
};

}  // namespace trundle::mppi
