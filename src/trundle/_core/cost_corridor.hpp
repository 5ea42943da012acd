// Where on a map the cheapest way between two points may be, found on a coarse grid of blocks of cells.
//
// A block weighs what the least of its open cells weighs, so that ways over blocks hardly ever cost more than those over
// their cells, and is closed where it has none. A front from the goal to the start, and one back that stays where the sum
// of both is near the cheapest, give for every block what a way through it costs. The corridor is the blocks for which
// that is at most some bound.
#pragma once

#include <cstring>

#include "fan_field.hpp"
#include "line_cost.hpp"

namespace trundle {

// The weights of a map's cells by their costs, as the fronts read them.
struct CostMap {
  const std::uint8_t *costs;
  std::int64_t rows, cols;
  float weight[256];  // by cost; infinity where a cell is blocked
  float least, dearest;
};

class CostCorridor {
  using Field = FanField<float>;

  static auto admit_all() {
    return [](std::int64_t, float) { return true; };
  }

  // Weights of squares of blocks.
  auto fill_blocks() const {
    return [this](std::int64_t row, std::int64_t col, Field::Cell *cells, std::int64_t stride) {
      for (std::int64_t r = row; r < row + Field::kSquare; ++r, cells += stride) {
        for (std::int64_t c = 0; c < Field::kSquare; ++c) {
          const bool inside = r >= 0 && r < rows_ && col + c >= 0 && col + c < cols_;
          cells[c] = {Field::kFar, inside ? block_weight(r, col + c) : Field::kFar};
        }
      }
    };
  }

 public:
  void begin(const CostMap &map, int factor, lines::Point start, lines::Point goal) {
    map_ = &map, factor_ = factor, start_ = start, goal_ = goal;
    rows_ = (map.rows + factor - 1) / factor, cols_ = (map.cols + factor - 1) / factor;
    const float scale = static_cast<float>(factor);
    to_goal_.begin(rows_, cols_, map.least * scale, map.dearest * scale);
    seed(to_goal_, goal, fill_blocks());
    nearest_ = Field::kFar;
  }

  // What the cheapest way costs on the coarse grid, infinity where there is none.
  float estimate() const { return nearest_; }
  std::uint64_t settled() const { return to_goal_.settled() + to_start_.settled(); }
  std::size_t bytes() const { return to_goal_.bytes() + to_start_.bytes(); }

  // Find what the cheapest way costs. Anything but found says that patience ended.
  SearchStatus reach(const Patience &patience) {
    to_goal_.make_ready(block(start_.y), block(start_.x), fill_blocks());
    const SearchStatus status = to_goal_.spread(
        fill_blocks(), admit_all(), [&](float cost) { return cost >= (nearest_ = cost_at_start()); }, patience);
    nearest_ = cost_at_start();
    return status;
  }

  // Mark the blocks on ways that cost no more than `bound`.
  SearchStatus widen(float bound, const Patience &patience) {
    const SearchStatus status =
        to_goal_.spread(fill_blocks(), admit_all(), [&](float cost) { return cost > bound; }, patience);
    if (status != SearchStatus::kFound) return status;
    const auto fill = [this](std::int64_t row, std::int64_t col, Field::Cell *cells, std::int64_t stride) {
      for (std::int64_t r = 0; r < Field::kSquare; ++r) {
        for (std::int64_t c = 0; c < Field::kSquare; ++c) {
          const bool ready = to_goal_.is_ready(row + r, col + c);
          cells[r * stride + c] = {Field::kFar, ready ? to_goal_.weight(to_goal_.at(row + r, col + c)) : Field::kFar};
        }
      }
    };
    bound_ = bound;
    const float scale = static_cast<float>(factor_);
    to_start_.begin(rows_, cols_, map_->least * scale, map_->dearest * scale);
    seed(to_start_, start_, fill);
    const auto admit = [&](std::int64_t at, float cost) { return is_near(at, cost); };
    return to_start_.spread(fill, admit, [](float) { return false; }, patience);
  }

  // Whether a block belongs to it; blocks outside the grid do not.
  bool contains(std::int64_t block_row, std::int64_t block_col) {
    if (is_beside(block_row, block_col, start_) || is_beside(block_row, block_col, goal_)) return true;
    return to_start_.is_ready(block_row, block_col) &&
           is_near(to_start_.at(block_row, block_col), to_start_.cost(to_start_.at(block_row, block_col)));
  }

 private:
  static constexpr float kAside = 0.71f;  // of a block's weight

  // A way that goes through a block passes within half a diagonal of its middle.
  bool is_near(std::int64_t at, float cost_from_start) {
    return cost_from_start + to_goal_.cost(at) <= bound_ + kAside * to_goal_.weight(at);
  }

  bool is_beside(std::int64_t block_row, std::int64_t block_col, lines::Point point) const {
    return std::abs(block_row - block(point.y)) <= 1 && std::abs(block_col - block(point.x)) <= 1;
  }

  std::int64_t block(double value) const { return static_cast<std::int64_t>(value) / factor_; }

  // For a length of one block.
  float block_weight(std::int64_t block_row, std::int64_t block_col) const {
    const std::int64_t bottom = block_row * factor_, left = block_col * factor_;
    const std::int64_t top = std::min(bottom + factor_, map_->rows), right = std::min(left + factor_, map_->cols);
    float least = Field::kFar;
    for (std::int64_t row = bottom; row < top; ++row) {
      const std::uint8_t *costs = map_->costs + row * map_->cols;
      for (std::int64_t col = left; col < right; ++col) least = std::min(least, map_->weight[costs[col]]);
    }
    return static_cast<float>(factor_) * least;
  }

  // Straight to the middles of the blocks around a point.
  template <typename Visit>
  void around(Field &field, lines::Point point, const Visit &visit) {
    const std::int64_t row = block(point.y), col = block(point.x);
    const float own = field.weight(field.at(row, col));
    for (std::int64_t r = row - 1; r <= row + 1; ++r) {
      for (std::int64_t c = col - 1; c <= col + 1; ++c) {
        const float weight = field.weight(field.at(r, c));
        if (!(weight < Field::kFar)) continue;
        const double dx = (static_cast<double>(c) + 0.5) * factor_ - point.x,
                     dy = (static_cast<double>(r) + 0.5) * factor_ - point.y;
        visit(r, c, static_cast<float>(std::sqrt(dx * dx + dy * dy)) * 0.5f * (weight + own) /
                        static_cast<float>(factor_));
      }
    }
  }

  template <typename Fill>
  void seed(Field &field, lines::Point point, const Fill &fill) {
    field.make_ready(block(point.y), block(point.x), fill);
    around(field, point, [&](std::int64_t r, std::int64_t c, float cost) { field.seed(r, c, cost); });
  }

  float cost_at_start() {
    float least = Field::kFar;
    around(to_goal_, start_, [&](std::int64_t r, std::int64_t c, float cost) {
      least = std::min(least, cost + to_goal_.cost(to_goal_.at(r, c)));
    });
    return least;
  }

  const CostMap *map_ = nullptr;
  int factor_ = 1;
  lines::Point start_{}, goal_{};
  std::int64_t rows_ = 0, cols_ = 0;
  float nearest_ = 0.0f, bound_ = 0.0f;
  Field to_goal_, to_start_;
};

}  // namespace trundle
