// What it costs at least to come from anywhere on a map to the goal, found on a coarse grid of blocks of 4 × 4 cells.
//
// A block weighs what the least of its open cells weighs, so that ways over blocks hardly ever cost more than those over
// their cells, and is closed where it has none. The front begins at the goal and turns to the start: blocks are ranked by
// what the way to them costs and what a straight line from them to the start at least costs (A*: Hart, Nilsson and
// Raphael, 1968). It stops when it knows what was asked for, and can go on from there.
#pragma once

#include <cstring>

#include "cost/line_cost.hpp"
#include "cost/wavefront.hpp"

namespace trundle {

// The weights of a map's cells by their costs, as the fronts read them.
struct CostMap {
  const std::uint8_t *costs;
  std::int64_t rows, cols;
  float quarter[256];  // of the weight, by cost; infinity where a cell is blocked
  float least;         // weight
  bool rising;         // whether no cost weighs less than a smaller one
};

class BlockCosts {
  using Field = FrontField<float>;
  static constexpr std::int64_t kBlock = 4;  // cells along it

  // Squares by what the ways through them cost at least.
  auto order() const {
    const float per_block = map_->least * kBlock;
    const auto x = static_cast<float>(start_.x / kBlock), y = static_cast<float>(start_.y / kBlock);
    return [per_block, x, y](std::int64_t row, std::int64_t col, float cost) {
      const float below = static_cast<float>(row) - y, left = static_cast<float>(col) - x;
      const float up = std::max({0.0f, below, -below - Field::kSide});
      const float right = std::max({0.0f, left, -left - Field::kSide});
      return cost + std::sqrt(up * up + right * right) * per_block;
    };
  }

  // Quarters of the weights of squares of blocks, for a length of one block.
  auto fill() const {
    return [this](std::int64_t row, std::int64_t col, float *quarters) {
      const std::int64_t bottom = row * kBlock, left = col * kBlock, side = Field::kSide * kBlock;
      if (map_->rising && bottom >= 0 && left >= 0 && bottom + side <= map_->rows && left + side <= map_->cols) {
        for (std::int64_t r = 0; r < Field::kSide; ++r) {
          least_of_row(map_->costs + (bottom + r * kBlock) * map_->cols + left, quarters + r * Field::kSide);
        }
        return;
      }
      for (std::int64_t r = row; r < row + Field::kSide; ++r) {
        for (std::int64_t c = col; c < col + Field::kSide; ++c) *quarters++ = least_of_block(r, c);
      }
    };
  }

 public:

  void begin(const CostMap &map, lines::Point start, lines::Point goal) {
    map_ = &map, start_ = start;
    rows_ = (map.rows + kBlock - 1) / kBlock, cols_ = (map.cols + kBlock - 1) / kBlock;
    to_goal_.begin(rows_, cols_, map.least * kBlock);
    for (const lines::Point point : {start, goal}) {
      for (std::int64_t r = -1; r <= 1; ++r) {
        for (std::int64_t c = -1; c <= 1; ++c) to_goal_.make_ready(block(point.y) + r, block(point.x) + c, fill());
      }
    }
    around(goal, [&](std::int64_t r, std::int64_t c, float cost) { to_goal_.seed(r, c, cost, order()); });
  }

  // What the cheapest way costs on the coarse grid, infinity where there is none.
  float estimate() {
    float least = Field::kFar;
    around(start_, [&](std::int64_t row, std::int64_t col, float cost) {
      least = std::min(least, cost + to_goal_.cost(row, col));
    });
    return least;
  }

  // Find that. Anything but found says that patience ended.
  SearchStatus reach(const Patience &patience) {
    return to_goal_.spread(fill(), order(), [&](float rank) { return rank >= estimate(); }, patience);
  }

  // Find the costs from all blocks that ways of `bound` may go through.
  SearchStatus reach(float bound, const Patience &patience) {
    return to_goal_.spread(fill(), order(), [&](float rank) { return rank > bound; }, patience);
  }

  // What it costs at least from the 8 × 8 cells from (row, col) on; infinity where that was not reached.
  float from_square(std::int64_t row, std::int64_t col) {
    constexpr float kAside = 0.71f;  // a way through a block passes within half a diagonal of its middle
    float least = Field::kFar;
    for (std::int64_t r = row / kBlock; r < std::min(row / kBlock + 2, rows_); ++r) {
      for (std::int64_t c = col / kBlock; c < std::min(col / kBlock + 2, cols_); ++c) {
        if (!to_goal_.is_ready(r, c)) continue;
        least = std::min(least, std::max(0.0f, to_goal_.cost(r, c) - kAside * to_goal_.weight(r, c)));
      }
    }
    return least;
  }

  std::uint64_t settled() const { return to_goal_.settled(); }
  std::size_t bytes() const { return to_goal_.bytes(); }

 private:
  static std::int64_t block(double value) { return static_cast<std::int64_t>(value) / kBlock; }

  // The same for a row of eight blocks inside the map, by bytes: a lesser cost weighs no more.
  void least_of_row(const std::uint8_t *costs, float *quarters) const {
    typedef std::uint8_t Bytes __attribute__((vector_size(16)));
    typedef std::uint32_t Words __attribute__((vector_size(16)));
    static_assert(kBlock == sizeof(std::uint32_t), "a block is as wide as a word");
    for (int half = 0; half < 2; ++half, costs += sizeof(Bytes), quarters += 4) {
      Bytes row, low;
      std::memcpy(&low, costs, sizeof low);
      for (std::int64_t k = 1; k < kBlock; ++k) {
        std::memcpy(&row, costs + k * map_->cols, sizeof row);
        low = row < low ? row : low;
      }
      for (const std::uint32_t shift : {16u, 8u}) {
        const auto moved = reinterpret_cast<Bytes>(reinterpret_cast<Words>(low) >> shift);
        low = moved < low ? moved : low;
      }
      const Words words = reinterpret_cast<Words>(low) & 255u;
      for (int k = 0; k < 4; ++k) quarters[k] = kBlock * map_->quarter[words[k]];
    }
  }

  float least_of_block(std::int64_t row, std::int64_t col) const {
    if (row < 0 || col < 0) return Field::kFar;
    const std::int64_t bottom = row * kBlock, left = col * kBlock;
    float least = Field::kFar;
    for (std::int64_t r = bottom; r < std::min(bottom + kBlock, map_->rows); ++r) {
      for (std::int64_t c = left; c < std::min(left + kBlock, map_->cols); ++c) {
        least = std::min(least, map_->quarter[map_->costs[r * map_->cols + c]]);
      }
    }
    return kBlock * least;
  }

  // Straight to the middles of the blocks around a point.
  template <typename Visit>
  void around(lines::Point point, const Visit &visit) {
    const std::int64_t row = block(point.y), col = block(point.x);
    const float own = to_goal_.weight(row, col);
    for (std::int64_t r = row - 1; r <= row + 1; ++r) {
      for (std::int64_t c = col - 1; c <= col + 1; ++c) {
        const float weight = to_goal_.weight(r, c);
        if (!(weight < Field::kFar)) continue;
        const double dx = (static_cast<double>(c) + 0.5) * kBlock - point.x,
                     dy = (static_cast<double>(r) + 0.5) * kBlock - point.y;
        visit(r, c, static_cast<float>(std::sqrt(dx * dx + dy * dy)) * 0.5f * (weight + own) / kBlock);
      }
    }
  }

  const CostMap *map_ = nullptr;
  lines::Point start_{};
  std::int64_t rows_ = 0, cols_ = 0;
  Field to_goal_;
};

}  // namespace trundle
