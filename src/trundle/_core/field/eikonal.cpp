// Cost to go in any direction over a small window: the solution of |∇u| = cost, first order and upwind.
//
// Fast marching (Tsitsiklis 1995, Sethian 1996) with buckets for an open list (Yatziv, Bartesaghi and Sapiro 2006).
// Cells within a bucket are taken in any order, and a cell whose value falls is taken again: the result is the one
// fixed point of the scheme, to `kEnough`, whatever the order. A cell is reached from its four neighbours alone, so that
// no value passes between two walls that touch at a corner.
#include "field/eikonal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace trundle {

static constexpr float kFar = std::numeric_limits<float>::infinity();
static constexpr float kEnough = 1e-4f;  // improvements smaller than this share of the least cost are none
static constexpr std::int64_t kNowhere = std::numeric_limits<std::int64_t>::max();
static constexpr int kMostBuckets = 4096;

namespace {

class Marcher {
 public:
  Marcher(const std::uint8_t *classes, const float *costs, std::int64_t rows, std::int64_t cols)
      : rows_(rows), wide_(cols + 2), cost_(static_cast<std::size_t>((rows + 2) * wide_), kFar) {
    float least = kFar, most = 0.0f;
    for (std::int64_t row = 0; row < rows; ++row)
      for (std::int64_t col = 0; col < cols; ++col) {
        const float cost = costs[classes[row * cols + col]];
        cost_[static_cast<std::size_t>((row + 1) * wide_ + col + 1)] = cost;
        if (cost < kFar) least = std::min(least, cost), most = std::max(most, cost);
      }
    value_.assign(cost_.size(), kFar);
    waits_in_.assign(cost_.size(), kNowhere);
    enough_ = kEnough * least;
    const float buckets = most > 0.0f ? 2.0f * most / least + 3.0f : 1.0f;
    width_ = buckets <= kMostBuckets ? 0.5f * least : most / (0.5f * kMostBuckets);
    buckets_.resize(static_cast<std::size_t>(std::min(buckets, static_cast<float>(kMostBuckets)) + 1.0f));
  }

  void seed(std::int64_t row, std::int64_t col, float value) {
    const std::int64_t cell = (row + 1) * wide_ + col + 1;
    if (cost_[static_cast<std::size_t>(cell)] < kFar) seeds_.push_back({value, cell});
  }

  // Up to where the front is `beyond` past a cell; everywhere, if it never gets there.
  void solve(std::int64_t row, std::int64_t col, float beyond) {
    std::sort(seeds_.begin(), seeds_.end());
    const auto until = static_cast<std::size_t>((row + 1) * wide_ + col + 1);
    std::size_t next = 0;
    std::int64_t at = 0;  // the bucket of the least values
    while (open_ > 0 || next < seeds_.size()) {
      if (static_cast<float>(at) * width_ > value_[until] + beyond) break;
      if (open_ == 0) at = bucket_of(seeds_[next].value);
      // Seeds enter as the front reaches them, so that the buckets hold all that is open at once.
      for (; next < seeds_.size() && bucket_of(seeds_[next].value) <= at; ++next) offer(seeds_[next].cell, seeds_[next].value, at);
      std::vector<std::int64_t> &bucket = buckets_[static_cast<std::size_t>(at) % buckets_.size()];
      if (bucket.empty()) {
        ++at;
        continue;
      }
      const std::int64_t cell = bucket.back();
      bucket.pop_back();
      --open_;
      if (waits_in_[static_cast<std::size_t>(cell)] != at) continue;  // it was taken from an earlier bucket
      waits_in_[static_cast<std::size_t>(cell)] = kNowhere;
      const float value = value_[static_cast<std::size_t>(cell)];
      for (const std::int64_t step : {-wide_, std::int64_t{-1}, std::int64_t{1}, wide_}) update(cell + step, value, at);
    }
  }

  void write(std::int64_t row, std::int64_t col, float beyond, float *out) const {
    const std::int64_t cols = wide_ - 2;
    const float most = value_[static_cast<std::size_t>((row + 1) * wide_ + col + 1)] + beyond;
    for (row = 0; row < rows_; ++row)
      for (col = 0; col < cols; ++col) {
        const float value = value_[static_cast<std::size_t>((row + 1) * wide_ + col + 1)];
        *out++ = value <= most ? value : kFar;
      }
  }

 private:
  struct Seed {
    float value;
    std::int64_t cell;
    bool operator<(const Seed &other) const { return value != other.value ? value < other.value : cell < other.cell; }
  };

  std::int64_t bucket_of(float value) const { return static_cast<std::int64_t>(value / width_); }

  // A neighbour's value has fallen to `from`, which raises none and can lower what is above it.
  void update(std::int64_t cell, float from, std::int64_t at) {
    const auto i = static_cast<std::size_t>(cell);
    const float cost = cost_[i];
    if (!(value_[i] > from) || !(cost < kFar)) return;
    const float across = std::min(value_[i - 1], value_[i + 1]);
    const float along = std::min(value_[i - static_cast<std::size_t>(wide_)], value_[i + static_cast<std::size_t>(wide_)]);
    const float low = std::min(across, along), apart = std::max(across, along) - low;
    const float value =
        apart >= cost ? low + cost : low + 0.5f * (apart + std::sqrt(2.0f * cost * cost - apart * apart));
    offer(cell, value, at);
  }

  void offer(std::int64_t cell, float value, std::int64_t at) {
    const auto i = static_cast<std::size_t>(cell);
    if (!(value < value_[i] - enough_) && !(value_[i] == kFar && value < kFar)) return;
    value_[i] = value;
    const std::int64_t bucket = std::max(bucket_of(value), at);
    if (waits_in_[i] <= bucket) return;
    waits_in_[i] = bucket;
    ++open_;
    buckets_[static_cast<std::size_t>(bucket) % buckets_.size()].push_back(cell);
  }

  std::int64_t rows_, wide_;
  std::vector<float> cost_, value_;  // with a frame of walls
  std::vector<std::int64_t> waits_in_;  // the earliest bucket that holds a cell
  std::vector<std::vector<std::int64_t>> buckets_;
  std::vector<Seed> seeds_;
  std::size_t open_ = 0;
  float width_ = 1.0f, enough_ = 0.0f;
};

}  // namespace

nb::ndarray<nb::numpy, float> eikonal_field(In<std::uint8_t, 2> classes, In<float, 1> costs, In<std::int64_t, 2> seeds,
                                            In<double, 1> values, std::int64_t row, std::int64_t col, double beyond) {
  const auto rows = static_cast<std::int64_t>(classes.shape(0)), cols = static_cast<std::int64_t>(classes.shape(1));
  if (costs.shape(0) != 256) throw nb::value_error("costs need shape (256,): one for each class");
  if (seeds.shape(1) != 2) throw nb::value_error("seeds need shape (N, 2): row, col");
  if (seeds.shape(0) != values.shape(0)) throw nb::value_error("each seed needs a value");
  float least = kFar, most = 0.0f;
  for (std::size_t k = 0; k < 256; ++k) {
    if (!(costs(k) > 0.0f)) throw nb::value_error("costs must be positive, infinite for walls");
    if (costs(k) < kFar) least = std::min(least, costs(k)), most = std::max(most, costs(k));
  }
  if (most > 0.0f && !(most <= 1e4f * least)) throw nb::value_error("the largest cost must be at most 10,000 times the least");
  for (std::size_t k = 0; k < seeds.shape(0); ++k) {
    if (seeds(k, 0) < 0 || seeds(k, 0) >= rows || seeds(k, 1) < 0 || seeds(k, 1) >= cols)
      throw nb::index_error("a seed lies outside the grid");
    if (!(values(k) >= 0.0 && values(k) <= 1e6 * least)) throw nb::value_error("values of seeds must be from 0 to 1e6 of the least cost");
  }
  if (row < 0 || row >= rows || col < 0 || col >= cols) throw nb::index_error("the cell lies outside the grid");
  if (!(beyond >= 0.0)) throw nb::value_error("beyond must be 0 or more");
  std::vector<float> out(static_cast<std::size_t>(rows * cols));
  {
    nb::gil_scoped_release release;
    Marcher marcher(classes.data(), costs.data(), rows, cols);
    for (std::size_t k = 0; k < seeds.shape(0); ++k) marcher.seed(seeds(k, 0), seeds(k, 1), static_cast<float>(values(k)));
    const auto past = static_cast<float>(beyond);
    marcher.solve(row, col, past);
    marcher.write(row, col, past, out.data());
  }
  return to_numpy(std::move(out), {static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)});
}

}  // namespace trundle
