// A lower bound on the cost from anywhere on a map to the goal, found on a coarse grid of blocks of 4 × 4 cells.
//
// A block weighs as much as the least of its open cells, so that paths over blocks hardly ever cost more than those
// over their cells; it is closed where it has no open cell. The wavefront begins at the goal and is directed to the
// start: tiles are ranked by cost plus the least that a straight line on to the start costs (A*: Hart, Nilsson and
// Raphael 1968). It stops as soon as the cost that was asked for is known, and goes on from there for the next one.
#pragma once

#include <cstring>

#include "cost/line_cost.hpp"
#include "cost/wavefront.hpp"

namespace trundle {

// The weights of a map's cells by their costs, as wavefronts read them.
struct CostMap {
  const std::uint8_t *costs;
  std::int64_t rows, cols;
  float quarter[256];  // of the weight, by cost; infinity where a cell is blocked
  float least;         // weight of an open cell
  bool rising;         // whether weights rise, or stay, with costs
};

class BlockCosts {
  using Field = Wavefront<float>;
  static constexpr std::int64_t kBlock = 4;  // cells along it

  // Ranks tiles by the least that paths through them cost.
  auto rank() const {
    const float per_block = map_->least * kBlock;
    const auto x = static_cast<float>(start_.x / kBlock), y = static_cast<float>(start_.y / kBlock);
    return [per_block, x, y](std::int64_t row, std::int64_t col, float cost) {
      const float below = static_cast<float>(row) - y, left = static_cast<float>(col) - x;
      const float up = std::max({0.0f, below, -below - Field::kSide});
      const float right = std::max({0.0f, left, -left - Field::kSide});
      return cost + std::sqrt(up * up + right * right) * per_block;
    };
  }

  // Writes quarters of the weights of tiles of blocks, for a length of one block.
  auto load() const {
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
        for (std::int64_t c = -1; c <= 1; ++c) to_goal_.make_ready(block(point.y) + r, block(point.x) + c, load());
      }
    }
    around(goal, [&](std::int64_t r, std::int64_t c, float cost) { to_goal_.seed(r, c, cost, rank()); });
  }

  // Cost of the cheapest path on the coarse grid, infinity where there is none.
  float estimate() {
    float least = Field::kFar;
    around(start_, [&](std::int64_t row, std::int64_t col, float cost) {
      least = std::min(least, cost + to_goal_.cost(row, col));
    });
    return least;
  }

  // Finds that. Returns found, or why `limits` stopped it.
  SearchStatus find_estimate(const SearchLimits &limits) {
    return to_goal_.propagate(load(), rank(), [&](float least) { return least >= estimate(); }, limits);
  }

  // Finds the costs from all blocks that paths of cost `bound` may lead through.
  SearchStatus find_within(float bound, const SearchLimits &limits) {
    return to_goal_.propagate(load(), rank(), [&](float least) { return least > bound; }, limits);
  }

  // The least cost from the tile of 8 × 8 cells from (row, col) on; infinity where it was not reached.
  float from_tile(std::int64_t row, std::int64_t col) {
    constexpr float kAside = 0.71f;  // a path through a block passes within half a diagonal of its middle
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

  // The weights of a row of eight blocks inside the map, by the least byte of each: weights rise with costs.
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

  // Visits the blocks around a point, with the cost of the straight line to their middles.
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
