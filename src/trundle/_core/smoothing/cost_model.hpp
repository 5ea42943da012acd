// Pieces of a path, and what they cost.
//
// The line integral of the cells' weight is exact for straight lines: clipped at the cells' borders, with the higher
// weight on a border, as in `line_costs`. Arcs are measured along chords as close to them as those of the path
// returned. To choose among curves, samples half a cell apart are enough.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "cost/line_cost.hpp"
#include "hybrid/shots.hpp"

namespace trundle::smoothing {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

// A pose by its direction, so that a step from it needs the sine and cosine of its turn alone.
struct Heading {
  double x, y, cos, sin;

  static Heading of(const PlanarPose &pose) { return {pose.x, pose.y, std::cos(pose.yaw), std::sin(pose.yaw)}; }

  Heading reversed() const { return {x, y, -cos, -sin}; }

  Heading go(const Segment &s) const {
    if (s.turn == 0.0) return {x + cos * s.length, y + sin * s.length, cos, sin};
    const double turn_cos = std::cos(s.turn), turn_sin = std::sin(s.turn);
    double along = s.length, across = 0.5 * s.length * s.turn;
    if (std::fabs(s.turn) > 1e-6) along = s.length * turn_sin / s.turn, across = s.length * (1.0 - turn_cos) / s.turn;
    return on({along, across, turn_cos, turn_sin});
  }

  // A heading that is given relative to this one.
  Heading on(const Heading &step) const {
    return {x + cos * step.x - sin * step.y, y + sin * step.x + cos * step.y, cos * step.cos - sin * step.sin,
            sin * step.cos + cos * step.sin};
  }
};

struct Settings {
  MotionModel model;      // its radius and its costs
  double cost_weight;     // weight of a cell of cost 252, less that of a free cell, which is 1
  double curve_weight;    // of the square of the curvature, integrated along the path [m]
  double cost_tolerance;  // share by which the line integral of the cost may rise
};

// A line, an arc or a turn in place. Of a piece of the given path the robot drives the chord while its yaw turns.
struct Piece {
  PlanarPose from, to;
  Segment segment;
  std::int32_t leg = -1;  // of the given path, on which it lies; -1 where it is new

  bool is_kept() const { return leg >= 0; }
  bool is_turn() const { return segment.length == 0.0; }
  int direction() const { return (segment.length > 0.0) - (segment.length < 0.0); }

  PlanarPose at(double share) const {
    if (share >= 1.0) return to;
    const double turn = segment.turn * share;
    if (!is_kept()) return Segment{segment.length * share, turn}.from(from);
    return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y), from.yaw + turn};
  }

  Piece part(double first, double last) const {
    const double share = last - first;
    return {at(first), at(last), {segment.length * share, segment.turn * share}, leg};
  }
};

// What pieces cost: `line` is the integral of the cells' weight along them, `total` is what the smoother minimises.
struct PathCost {
  double line = 0.0, total = 0.0;
};

class CostModel {
 public:
  // `spacing` is that of poses along the tightest arcs.
  CostModel(const Settings &settings, const footprint::Costs &costs, const PoseChecker &checker, double resolution,
         double spacing)
      : settings_(settings), costs_(costs), checker_(checker), resolution_(resolution), spacing_(spacing) {
    for (int cost = 0; cost < 256; ++cost) path_weights_[cost] = 1.0 + settings.cost_weight * std::min(cost, 252) / 252.0;
    set_ceiling(PoseChecker::kInscribed - 1);
  }

  CostModel(const CostModel &) = delete;
  CostModel &operator=(const CostModel &) = delete;

  // New curves may lie in no cell that costs more.
  void set_ceiling(int highest) {
    const int most = std::min(highest, PoseChecker::kInscribed - 1);
    for (int cost = 0; cost < 256; ++cost) {
      new_weights_[cost] = cost <= most ? path_weights_[cost] : 0.0;
      sample_weights_[cost] = cost <= most ? path_weights_[cost] : kInfinite;
    }
  }

  const Settings &settings() const { return settings_; }

  // The highest cost of a cell under a piece of the given path, sampled every quarter of a cell.
  int highest(const Piece &piece) const {
    int most = checker_.cost_at(piece.to.x, piece.to.y);
    const double parts = std::ceil(4.0 * std::fabs(piece.segment.length) / resolution_);
    for (double i = 0.0; i < parts; ++i) {
      const PlanarPose pose = piece.at(i / parts);
      most = std::max<int>(most, checker_.cost_at(pose.x, pose.y));
    }
    return most;
  }

  // Factor of the cost of a metre driven; lengths backwards are negative.
  double driving_factor(double length) const { return length < 0.0 ? settings_.model.reverse_penalty : 1.0; }

  // Of a piece of the path.
  PathCost of(const Piece &piece) const {
    const double turn = std::fabs(piece.segment.turn), length = std::fabs(piece.segment.length);
    if (piece.is_turn()) return {0.0, planner_cost(piece).total + (piece.is_kept() ? kOutOfBounds : 0.0)};
    const double sum = planner_cost(piece).line;
    const bool out_of_bounds =
        piece.is_kept() && 2.0 * settings_.model.radius * std::sin(0.5 * std::min(turn, kPi)) > 1.001 * length;
    return {sum, driving_factor(piece.segment.length) * sum + bending(piece.segment) + (out_of_bounds ? kOutOfBounds : 0.0)};
  }

  // The line integral along a new segment, by samples; infinite where a sample is blocked, or the integral is above
  // `limit`. `at` moves to the end of the segment.
  double sampled_line(Heading &at, const Segment &segment, double limit) const {
    const double parts = std::clamp(std::ceil(2.0 * std::fabs(segment.length) / resolution_ - 1e-9), 1.0, 1e9);
    const double share = std::fabs(segment.length) / parts, most = limit / share, scale = 1.0 / resolution_;
    const auto rows = static_cast<std::size_t>(costs_.rows), cols = static_cast<std::size_t>(costs_.cols);
    const auto weight = [&](double x, double y) {
      // Numbers below 0 become large ones, but for those above -1, where no curve lies.
      const auto col = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(x));
      const auto row = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(y));
      return col < cols && row < rows ? sample_weights_[costs_.data[row * cols + col]] : kInfinite;
    };
    const Segment part{segment.length / parts, segment.turn / parts};
    Heading middle = at.go({0.5 * part.length, 0.5 * part.turn});
    middle.x *= scale, middle.y *= scale;
    double sum = 0.0;
    if (segment.turn == 0.0) {
      const double dx = at.cos * part.length * scale, dy = at.sin * part.length * scale;
      for (double i = 0.0; i < parts && sum <= most; ++i) sum += weight(middle.x + i * dx, middle.y + i * dy);
      at = at.go(segment);
    } else {
      // The chord of each part turns by the same angle from one to the next.
      Heading chord = Heading{0.0, 0.0, 1.0, 0.0}.go(part);
      chord.x *= scale, chord.y *= scale;
      for (double i = 0.0; i < parts && sum <= most; ++i) sum += weight(middle.x, middle.y), middle = middle.on(chord);
      at = at.go(segment);
    }
    return sum <= most ? share * sum : kInfinite;
  }

  // The line integral along a new segment, to the end of which `at` goes; infinite where it is blocked, or above
  // `limit`.
  double line(Heading &at, const Segment &segment, double limit) const { return along(new_weights_, at, segment, limit); }

  // The least that a new segment can cost.
  double lower_bound(const Segment &segment) const { return driving_factor(segment.length) * std::fabs(segment.length) + bending(segment); }

  // In the planners' unit: without the cost of bending.
  PathCost planner_cost(const Piece &piece) const {
    if (piece.is_turn()) {
      const double weight = path_weights_[checker_.cost_at(piece.from.x, piece.from.y)];
      return {0.0, settings_.model.turn_cost * std::fabs(piece.segment.turn) * weight};
    }
    double sum = 0.0;
    if (piece.is_kept()) {
      sum = line(path_weights_, piece.from.x, piece.from.y, piece.to.x, piece.to.y, kInfinite);
    } else {
      Heading at = Heading::of(piece.from);
      sum = along(path_weights_, at, piece.segment, kInfinite);
    }
    // Off the map every cell counts as the most expensive.
    if (sum == kInfinite) sum = std::fabs(piece.segment.length) * path_weights_[252];
    return {sum, driving_factor(piece.segment.length) * sum};
  }

 private:
  // Cost of a piece of the path that bends more than it may, so that it stays only where nothing else is possible [m].
  static constexpr double kOutOfBounds = 10.0;

  double bending(const Segment &s) const {
    return s.length == 0.0 ? 0.0 : settings_.curve_weight * s.turn * s.turn / std::fabs(s.length);
  }

  double line(const double *weights, double x, double y, double to_x, double to_y, double limit) const {
    const lines::WeightedGrid grid{costs_.data, weights, costs_.rows, costs_.cols};
    const double scale = 1.0 / resolution_;
    return resolution_ *
           lines::line_cost(grid, {x * scale, y * scale}, {to_x * scale, to_y * scale}, limit * scale, 1.0);
  }

  // `at` moves to the end of the segment.
  double along(const double *weights, Heading &at, const Segment &segment, double limit) const {
    double parts = 1.0;
    if (segment.turn != 0.0) {
      // Chords of wider arcs may be longer for the same distance from the arc.
      const double width = std::sqrt(std::fabs(segment.length / segment.turn) / settings_.model.radius);
      parts = std::clamp(std::ceil(std::fabs(segment.length) / (spacing_ * width) - 1e-9), 1.0, 1e9);
    }
    const Heading step = Heading{0.0, 0.0, 1.0, 0.0}.go({segment.length / parts, segment.turn / parts});
    double sum = 0.0;
    for (double i = 0.0; i < parts && sum <= limit; ++i) {
      const Heading next = at.on(step);
      sum += line(weights, at.x, at.y, next.x, next.y, limit - sum);
      at = next;
    }
    return sum <= limit ? sum : kInfinite;
  }

  const Settings settings_;
  const footprint::Costs costs_;
  const PoseChecker &checker_;
  const double resolution_, spacing_;
  double path_weights_[256], new_weights_[256], sample_weights_[256];  // by cost of a cell; 0 blocks, infinity in samples
};

}  // namespace trundle::smoothing
