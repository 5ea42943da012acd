// Whether a robot's footprint is free along an arc, a straight line or a turn in place, and what the cells under it
// cost.
//
// A pose in a cell of 253 and more is not free, since the inscribed circle touches there. A pose in a tile around which
// no cell is blocked as far as the circumscribed circle reaches is free; tiles are examined when they are first asked
// for. Between the two, the oriented outline is tested: roughly first, then exactly. It is padded by at least half of
// what a corner moves between two poses, so that nothing slips through between them. Where only the padding touches
// something and need not be free, the sweep of an inner outline decides.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "costmap/footprint_stencils.hpp"
#include "costmap/footprint_sweep.hpp"
#include "costmap/lazy_bits.hpp"
#include "shared/zeroed_table.hpp"

namespace trundle {

struct PlanarPose {
  double x, y, yaw;
};

// `length` [m] driven, negative backwards, while the yaw changes by `turn` [rad] at an even rate.
struct Segment {
  double length, turn;

  PlanarPose from(const PlanarPose &pose) const { return from(pose, std::cos(pose.yaw), std::sin(pose.yaw)); }

  PlanarPose from(const PlanarPose &pose, double cos, double sin) const {
    double along = length, across = 0.5 * length * turn;  // of a short turn; the error is below 1e-12 of the length
    if (std::fabs(turn) > 1e-6) {
      along = length * std::sin(turn) / turn;
      across = length * (1.0 - std::cos(turn)) / turn;
    }
    return {pose.x + cos * along - sin * across, pose.y + sin * along + cos * across, pose.yaw + turn};
  }
};

class PoseChecker {
 public:
  static constexpr std::uint8_t kInscribed = 253;

  // `step` is how far a point of the outline moves at most between two poses that are tested [m]. `inner` is the
  // outline of as many corners that has to be free, where that need not be all of `outline`.
  void begin(const std::uint8_t *costs, std::int64_t rows, std::int64_t cols, double resolution, const double *outline,
             std::size_t corners, double step, const double *inner = nullptr) {
    costs_ = {costs, rows, cols}, resolution_ = resolution, outline_ = outline, corners_ = corners, step_ = step;
    frame_ = {0.0, 0.0, 0.0, 1.0, 0.0, resolution};
    inner_ = inner;
    if (inner != nullptr) sweep_.begin(costs_, frame_, inner, corners);
    radius_ = 0.0;
    for (std::size_t i = 0; i < corners; ++i) {
      radius_ = std::max(radius_, std::hypot(outline[2 * i], outline[2 * i + 1]));
    }
    // A footprint that reaches beyond any map fits nowhere, and its exact size does not matter.
    const double most = static_cast<double>(std::max(rows, cols)) + 1.0;
    reach_ = static_cast<std::int64_t>(std::min(std::ceil(radius_ / resolution), most));
    tile_cols_ = (cols + kTile - 1) / kTile;
    const auto tiles = static_cast<std::size_t>(((rows + kTile - 1) / kTile) * tile_cols_);
    tiles_.fit(tiles);
    stamp_ += 2;
    if (stamp_ == 0) tiles_.clear(), stamp_ = 2;  // after 2^31 queries
    bits_.begin(costs, rows, cols);
    stencils_.begin(outline, corners, resolution);
    exact_ = 0;
  }

  double radius() const { return radius_; }
  std::uint64_t exact_checks() const { return exact_; }
  std::size_t bytes() const { return tiles_.bytes() + bits_.bytes() + stencils_.bytes(); }

  // Cost of the cell under a point, 255 outside the map.
  std::uint8_t cost_at(double x, double y) const {
    const double col = x / resolution_, row = y / resolution_;
    const auto rows = static_cast<double>(costs_.rows), cols = static_cast<double>(costs_.cols);
    if (!(col >= 0.0 && row >= 0.0 && col < cols && row < rows)) return 255;
    return costs_.data[static_cast<std::ptrdiff_t>(row) * costs_.cols + static_cast<std::ptrdiff_t>(col)];
  }

  // Whether the robot fits at all poses of a segment but its first; `sum` grows by the length of the segment, or its
  // turn times `per_radian`, times `weights[cost]`. Stops early where the sum passes `limit`.
  bool fits(const PlanarPose &pose, const Segment &segment, const float *weights, double per_radian, double limit,
            double &sum) {
    const double moved = std::fabs(segment.length) + radius_ * std::fabs(segment.turn);
    const double parts = std::clamp(std::ceil(moved / step_ - 1e-9), 1.0, 1e9);
    const Segment part{segment.length / parts, segment.turn / parts};
    const double share = segment.length != 0.0 ? std::fabs(part.length) : per_radian * std::fabs(part.turn);
    // The chord of each part turns by the same angle from one to the next.
    const PlanarPose chord = part.from({0.0, 0.0, 0.0}, 1.0, 0.0);
    const double turn_cos = std::cos(part.turn), turn_sin = std::sin(part.turn);
    double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw), x = pose.x, y = pose.y;
    // The padding at each pose covers half a part on both sides; at the first one there may be less.
    if (inner_ != nullptr && is_blocked(pose, pose, part, 0.0, parts)) return false;
    for (int i = 1; i <= static_cast<int>(parts); ++i) {
      x += cos * chord.x - sin * chord.y;
      y += sin * chord.x + cos * chord.y;
      const double next_cos = cos * turn_cos - sin * turn_sin;
      sin = sin * turn_cos + cos * turn_sin;
      cos = next_cos;
      const std::uint8_t cost = cost_at(x, y);
      if (cost >= kInscribed) return false;
      sum += share * static_cast<double>(weights[cost]);
      if (sum > limit) return false;
      if (is_blocked(pose, {x, y, pose.yaw + part.turn * i}, part, i, parts)) return false;
    }
    return true;
  }

  // Whether all of `outline` touches something at a pose, anywhere.
  bool collides_at(double x, double y, double yaw) {
    const double col = x / resolution_, row = y / resolution_;
    const bool on_map = col >= 0.0 && row >= 0.0 && col < static_cast<double>(costs_.cols) &&
                        row < static_cast<double>(costs_.rows);
    if (on_map && (is_clear(x, y) || is_surely_free(x, y, yaw))) return false;
    return collides({x, y, yaw}, outline_);
  }

  // Whether what has to be free touches something at a pose.
  bool touches(double x, double y, double yaw) { return collides({x, y, yaw}, inner_ != nullptr ? inner_ : outline_); }

 private:
  static constexpr std::int64_t kTile = 4;  // cells

  bool collides(const PlanarPose &at, const double *outline) {
    ++exact_;
    const double pose[3] = {at.x, at.y, at.yaw};
    return footprint::collides(costs_, frame_, outline, corners_, pose, polygon_, box_, spans_);
  }

  // Whether something is within half a part of the pose `at`, `done` of `parts` parts of a segment from `first`.
  bool is_blocked(const PlanarPose &first, const PlanarPose &at, const Segment &part, double done, double parts) {
    if (is_clear(at.x, at.y) || is_surely_free(at.x, at.y, at.yaw) || !collides(at, outline_)) return false;
    if (inner_ == nullptr) return true;
    const double from = std::max(0.0, done - 0.5), to = std::min(parts, done + 0.5);
    const PlanarPose a = Segment{part.length * from, part.turn * from}.from(first);
    const PlanarPose b = Segment{part.length * to, part.turn * to}.from(first);
    const double ends[2][3] = {{a.x, a.y, a.yaw}, {b.x, b.y, b.yaw}};
    // An arc leaves its chord by an eighth of its length times its turn.
    return sweep_.free_share(ends[0], ends[1], std::fabs(part.length * part.turn) / 8.0) < footprint::kInfinity;
  }

  // Whether no cell is blocked as far as the robot reaches from anywhere in the tile of a point inside the map.
  bool is_clear(double x, double y) {
    const auto row = static_cast<std::int64_t>(y / resolution_) / kTile;
    const auto col = static_cast<std::int64_t>(x / resolution_) / kTile;
    std::uint32_t &tile = tiles_[static_cast<std::size_t>(row * tile_cols_ + col)];
    if (tile != stamp_ && tile != stamp_ + 1) tile = stamp_ + (look_around(row * kTile, col * kTile) ? 1U : 0U);
    return tile == stamp_ + 1;
  }

  bool is_surely_free(double x, double y, double yaw) {
    return stencils_.is_free(x / resolution_, y / resolution_, yaw, costs_.rows, costs_.cols, bits_);
  }

  bool look_around(std::int64_t row, std::int64_t col) {
    const std::int64_t first_row = row - reach_, last_row = row + kTile + reach_ - 1;
    const std::int64_t first_col = col - reach_, last_col = col + kTile + reach_ - 1;
    if (first_row < 0 || first_col < 0 || last_row >= costs_.rows || last_col >= costs_.cols) return false;
    return !bits_.any_in(first_row, last_row, first_col, last_col);
  }

  footprint::Costs costs_{};
  footprint::Frame frame_{};
  const double *outline_ = nullptr, *inner_ = nullptr;
  std::size_t corners_ = 0;
  double resolution_ = 1.0, radius_ = 0.0, step_ = 1.0;
  std::int64_t reach_ = 0, tile_cols_ = 0;
  std::uint32_t stamp_ = 0;
  std::uint64_t exact_ = 0;
  ZeroedTable<std::uint32_t> tiles_;
  LazyBits bits_;
  FootprintStencils stencils_;
  std::vector<footprint::Point> polygon_;
  footprint::Box box_{};
  footprint::Spans spans_;
  footprint::Sweep sweep_;
};

}  // namespace trundle
