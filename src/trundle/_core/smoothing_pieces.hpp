// A path in pieces, what they cost, and the stations along it between which it may be given another course.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "hybrid_shots.hpp"

namespace trundle::smoothing {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

// A pose by the direction it looks in, so that going on from it needs the sines of turns alone.
struct Heading {
  double x, y, cos, sin;

  static Heading of(const PlanarPose &pose) { return {pose.x, pose.y, std::cos(pose.yaw), std::sin(pose.yaw)}; }

  Heading go(const Stretch &s) const {
    if (s.turn == 0.0) return {x + cos * s.length, y + sin * s.length, cos, sin};
    const double turn_cos = std::cos(s.turn), turn_sin = std::sin(s.turn);
    double along = s.length, across = 0.5 * s.length * s.turn;
    if (std::fabs(s.turn) > 1e-6) along = s.length * turn_sin / s.turn, across = s.length * (1.0 - turn_cos) / s.turn;
    return {x + cos * along - sin * across, y + sin * along + cos * across, cos * turn_cos - sin * turn_sin,
            sin * turn_cos + cos * turn_sin};
  }
};

struct Settings {
  MotionModel model;      // of it the radius and the prices
  double cost_weight;     // how much dearer than a free cell one of cost 252 is, less 1
  double curve_weight;    // of the square of the curvature, integrated along the path [m]
  double cost_tolerance;  // share by which the line integral of the cost may rise
};

// A line, an arc or a turn in place. Of one that the path had before, the robot drives the chord while its yaw turns.
struct Piece {
  PlanarPose from, to;
  Stretch stretch;
  std::int32_t leg = -1;  // of the path as it came, on which it lies; -1 where it is new

  bool is_kept() const { return leg >= 0; }
  bool is_turn() const { return stretch.length == 0.0; }
  int direction() const { return (stretch.length > 0.0) - (stretch.length < 0.0); }

  PlanarPose at(double share) const {
    if (share >= 1.0) return to;
    const double turn = stretch.turn * share;
    if (!is_kept()) return Stretch{stretch.length * share, turn}.from(from);
    return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y), from.yaw + turn};
  }

  Piece part(double first, double last) const {
    const double share = last - first;
    return {at(first), at(last), {stretch.length * share, stretch.turn * share}, leg};
  }
};

// What pieces cost. `line` is the integral of the cells' weight along the way; `whole` what is made small.
struct Price {
  double line = 0.0, whole = 0.0;
};

class Prices {
 public:
  Prices(const Settings &settings, const PoseChecker &checker, double resolution)
      : settings_(settings), checker_(checker), step_(0.5 * resolution) {
    for (int cost = 0; cost < 256; ++cost) {
      kept_[cost] = static_cast<float>(1.0 + settings.cost_weight * std::min(cost, 252) / 252.0);
    }
    set_ceiling(PoseChecker::kInscribed - 1);
  }

  // What is new may lie in no cell that costs more.
  void set_ceiling(int highest) {
    for (int cost = 0; cost < 256; ++cost) {
      fresh_[cost] = cost <= std::min(highest, PoseChecker::kInscribed - 1) ? kept_[cost] : std::numeric_limits<float>::infinity();
    }
  }

  const Settings &settings() const { return settings_; }
  const float *fresh() const { return fresh_; }

  // The highest cost of a cell under a piece.
  int highest(const Piece &piece) const {
    int most = checker_.cost_at(piece.to.x, piece.to.y);
    if (piece.is_turn()) return most;
    walk(begin(piece), line_of(piece), [&](double x, double y) {
      most = std::max<int>(most, checker_.cost_at(x, y));
      return true;
    });
    return most;
  }

  // Of a piece that the path has.
  Price of(const Piece &piece) const {
    const MotionModel &model = settings_.model;
    const double turn = std::fabs(piece.stretch.turn), length = std::fabs(piece.stretch.length);
    if (piece.is_turn()) {
      const double price = model.turn_cost * turn * kept_[checker_.cost_at(piece.from.x, piece.from.y)];
      return {0.0, price + (piece.is_kept() ? kOutOfBounds : 0.0)};
    }
    const double sum = line(piece);
    const bool out_of_bounds = piece.is_kept() && 2.0 * model.radius * std::sin(0.5 * std::min(turn, kPi)) > 1.001 * length;
    return {sum, dearer(piece.stretch.length) * sum + bending(piece.stretch) +
                     (out_of_bounds ? kOutOfBounds : 0.0)};
  }

  // Of a new stretch; infinite where it is blocked, or its line integral is above `limit`.
  Price of(const Heading &from, const Stretch &stretch, double limit) const {
    const double sum = integral(from, stretch, fresh_, limit);
    return {sum, dearer(stretch.length) * sum + bending(stretch)};
  }

  // The least that a new stretch can cost.
  double least(const Stretch &stretch) const { return dearer(stretch.length) * std::fabs(stretch.length) + bending(stretch); }

  // In the planners' unit: without the price of bending.
  double plain(const Piece &piece) const {
    if (piece.is_turn()) {
      return settings_.model.turn_cost * std::fabs(piece.stretch.turn) * kept_[checker_.cost_at(piece.from.x, piece.from.y)];
    }
    return dearer(piece.stretch.length) * line(piece);
  }

  double line(const Piece &piece) const {
    if (piece.is_turn()) return 0.0;
    return integral(begin(piece), line_of(piece), kept_, kInfinite);
  }

 private:
  // Price of a piece of the path that bends more than it may, so that it stays only where nothing else is possible [m].
  static constexpr double kOutOfBounds = 10.0;

  double dearer(double length) const { return length < 0.0 ? settings_.model.reverse_penalty : 1.0; }
  double bending(const Stretch &s) const {
    return s.length == 0.0 ? 0.0 : settings_.curve_weight * s.turn * s.turn / std::fabs(s.length);
  }

  static Stretch line_of(const Piece &piece) {
    return piece.is_kept() ? Stretch{piece.stretch.length, 0.0} : piece.stretch;
  }
  static Heading begin(const Piece &piece) {
    if (!piece.is_kept()) return Heading::of(piece.from);
    const double length = piece.stretch.length;
    return {piece.from.x, piece.from.y, (piece.to.x - piece.from.x) / length, (piece.to.y - piece.from.y) / length};
  }

  double parts_of(const Stretch &stretch) const {
    return std::clamp(std::ceil(std::fabs(stretch.length) / step_ - 1e-9), 1.0, 1e9);
  }

  // Visits points in the middle of equal parts, as long as that says so.
  template <typename Visit>
  void walk(const Heading &from, const Stretch &stretch, Visit &&visit) const {
    const double parts = parts_of(stretch);
    const Stretch part{stretch.length / parts, stretch.turn / parts};
    Heading at = from.go({0.5 * part.length, 0.5 * part.turn});
    // The chord of each part turns by the same angle from one to the next.
    const Heading chord = Heading{0.0, 0.0, 1.0, 0.0}.go(part);
    for (int i = 0; i < static_cast<int>(parts) && visit(at.x, at.y); ++i) {
      at = {at.x + at.cos * chord.x - at.sin * chord.y, at.y + at.sin * chord.x + at.cos * chord.y,
            at.cos * chord.cos - at.sin * chord.sin, at.sin * chord.cos + at.cos * chord.sin};
    }
  }

  double integral(const Heading &from, const Stretch &stretch, const float *weights, double limit) const {
    const double share = std::fabs(stretch.length) / parts_of(stretch), most = limit / share;
    double sum = 0.0;
    walk(from, stretch, [&](double x, double y) {
      sum += static_cast<double>(weights[checker_.cost_at(x, y)]);
      return sum <= most;
    });
    return sum <= most ? share * sum : kInfinite;
  }

  const Settings settings_;
  const PoseChecker &checker_;
  double step_;
  float kept_[256], fresh_[256];
};

// A place on the path, before a piece of it, with sums from the start to there.
struct Station {
  PlanarPose pose;
  std::size_t piece;
  Price sum;            // of the pieces
  double bend;          // of the angles that they turn by
  int changes;          // of direction
  int forward, back;    // pieces
  bool fixed;           // an end, or the path stops there
};

// Cuts pieces that are longer than `spacing`, and lays stations about as far apart; every stop has one.
inline std::vector<Station> lay_stations(std::vector<Piece> &pieces, const Prices &prices, double spacing) {
  std::vector<Piece> cut;
  for (const Piece &piece : pieces) {
    const int parts = std::max(1, static_cast<int>(std::ceil(std::fabs(piece.stretch.length) / spacing - 1e-9)));
    for (int i = 0; i < parts; ++i) {
      cut.push_back(parts == 1 ? piece : piece.part(static_cast<double>(i) / parts, static_cast<double>(i + 1) / parts));
    }
  }
  pieces = std::move(cut);
  std::vector<Station> stations;
  Station now{pieces.front().from, 0, {}, 0.0, 0, 0, 0, true};
  stations.push_back(now);
  double driven = 0.0;  // since the last station
  int last_direction = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece &piece = pieces[i];
    const Price price = prices.of(piece);
    if (last_direction * piece.direction() < 0) ++now.changes;
    last_direction = piece.direction();
    now.sum.line += price.line, now.sum.whole += price.whole;
    now.bend += std::fabs(piece.stretch.turn);
    now.forward += piece.direction() > 0, now.back += piece.direction() < 0;
    driven += std::fabs(piece.stretch.length);
    const bool ends = i + 1 == pieces.size();
    const bool stops = ends || piece.is_turn() || pieces[i + 1].is_turn() || piece.direction() != pieces[i + 1].direction();
    const double next = ends ? 0.0 : std::fabs(pieces[i + 1].stretch.length);
    if (!stops && driven + next <= spacing * (1.0 + 1e-9)) continue;
    now.pose = piece.to, now.piece = i + 1, now.fixed = stops;
    stations.push_back(now);
    driven = 0.0;
  }
  return stations;
}

}  // namespace trundle::smoothing
