// The path down a wavefront's costs, from a cell's centre to that of the source.
//
// Steps go against the gradient that the costs came by through their triangles, mixed from the four centres around a
// point: two cells long where these agree, and else one. Where one of the four is closed, or the step would touch
// something, the path goes by the cell's own centre instead. If that does not arrive, the path is the one from cell to
// cheaper cell, which always does.
#pragma once

#include <optional>

#include "cost/line_cost.hpp"
#include "cost/wavefront.hpp"

namespace trundle {

template <typename Real>
class Descent {
 public:
  using Point = lines::Point;
  Descent(Wavefront<Real> &wavefront, const lines::WeightedGrid &grid) : wavefront_(wavefront), grid_(grid) {}

  // Points from one cell's centre to the other's, (x, y) in grid units.
  std::vector<Point> trace(GridCell from, GridCell source) {
    std::vector<Point> line{centre(from.row, from.col)};
    const Point end = centre(source.row, source.col);
    const std::uint64_t most = wavefront_.settled() + 16;
    for (std::uint64_t steps = 0; wavefront_.interpolates() && steps < most; ++steps) {
      const Point here = line.back();
      const double dx = end.x - here.x, dy = end.y - here.y;
      if (dx * dx + dy * dy < kNear && is_open(here, end)) {
        line.push_back(end);
        return line;
      }
      if (const std::optional<Point> next = step(here)) {
        line.push_back(*next);
        continue;
      }
      const GridCell cell{static_cast<std::int32_t>(floor(here.y)), static_cast<std::int32_t>(floor(here.x))};
      const Point middle = centre(cell.row, cell.col);
      if (middle.x != here.x || middle.y != here.y) line.push_back(middle);
      if (by_centres(cell, line) == cell) break;
    }
    line.assign(1, centre(from.row, from.col));
    for (GridCell cell = from; !(cell == source);) {
      const GridCell next = cheaper_neighbour(cell);
      if (next == cell) return {};
      add_centre(cell, next, line);
      cell = next;
    }
    return line;
  }

 private:
  static constexpr double kNear = 4.0;      // cells squared
  static constexpr double kLongStep = 2.0;  // cells
  static constexpr double kAgreed = 0.99;   // length of the mean of the four directions from where on the step is long
  static constexpr std::int64_t kRow[4] = {0, 1, 0, -1}, kCol[4] = {1, 0, -1, 0};
  struct Direction {
    Real x, y;  // to the far side of the triangle
  };

  static Point centre(std::int64_t row, std::int64_t col) {
    return {static_cast<double>(col) + 0.5, static_cast<double>(row) + 0.5};
  }
  static std::int64_t floor(double value) { return static_cast<std::int64_t>(std::floor(value)); }

  bool is_open(const Point &a, const Point &b) const {
    return lines::line_cost(grid_, a, b, lines::kInfinity, 0.0) < lines::kInfinity;
  }

  // The direction from which a cell's cost came.
  bool downhill(std::int64_t row, std::int64_t col, Direction &direction) {
    constexpr Real kFar = Wavefront<Real>::kFar;
    if (!(wavefront_.cost_or_far(row, col) < kFar)) return false;
    const Real half = wavefront_.weight(row, col) / 2;
    Real best = kFar;
    for (int k = 0; k < 4; ++k) {
      const std::int64_t up = row + kRow[k], right = col + kCol[k];
      const Real straight = wavefront_.cost(up, right), weight = wavefront_.weight(up, right);
      if (!(weight < kFar && (straight < kFar || !wavefront_.interpolates()))) continue;
      if (straight + half + weight / 2 < best) {
        best = straight + half + weight / 2;
        direction = {static_cast<Real>(kCol[k]), static_cast<Real>(kRow[k])};
      }
      if (!wavefront_.interpolates()) {
        const int side = (k + 1) & 3;
        const std::int64_t above = up + kRow[side], beside = right + kCol[side];
        const Real cost =
            wavefront_.cost(above, beside) + Real(1.41421356237309505) * (half + wavefront_.weight(above, beside) / 2);
        if (!(cost < best && wavefront_.weight(row + kRow[side], col + kCol[side]) < kFar)) continue;
        best = cost;
        direction = {static_cast<Real>(kCol[k] + kCol[side]), static_cast<Real>(kRow[k] + kRow[side])};
        continue;
      }
      for (const int side : {(k + 1) & 3, (k + 3) & 3}) {
        const std::int64_t above = up + kRow[side], beside = right + kCol[side];
        const Real diagonal_cost = wavefront_.cost(above, beside), beyond = wavefront_.weight(above, beside);
        const Real gap = straight - diagonal_cost, mean = half + (weight + beyond) / 4;
        if (!(gap > 0 && diagonal_cost < kFar && mean < kFar)) continue;
        Real share = 1, cost = diagonal_cost + Real(1.41421356237309505) * (half + beyond / 2);
        if (gap * gap * 2 < mean * mean) {
          const Real rest = std::sqrt(mean * mean - gap * gap);
          share = gap / rest, cost = straight + rest;
        }
        if (!(cost < best)) continue;
        best = cost;
        share = std::min(share, Real(0.98));  // past a corner that may be closed
        direction = {kCol[k] + share * kCol[side], kRow[k] + share * kRow[side]};
      }
    }
    return best < kFar;
  }

  Real cost_at(const Point &point) { return wavefront_.cost_or_far(floor(point.y), floor(point.x)); }

  // The next point down from one, where nothing blocks it.
  std::optional<Point> step(const Point &here) {
    const double u = here.x - 0.5, v = here.y - 0.5;
    const std::int64_t col = floor(u), row = floor(v);
    const double right = u - static_cast<double>(col), up = v - static_cast<double>(row);
    double x = 0.0, y = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double share = ((k & 1) ? right : 1.0 - right) * ((k & 2) ? up : 1.0 - up);
      if (share < 1e-6) continue;
      Direction direction;
      if (!downhill(row + (k >> 1), col + (k & 1), direction)) return std::nullopt;
      const double scale = share / std::sqrt(static_cast<double>(direction.x * direction.x + direction.y * direction.y));
      x += scale * direction.x;
      y += scale * direction.y;
    }
    const double norm = std::sqrt(x * x + y * y);
    if (!(norm > 0.3)) return std::nullopt;
    if (norm > kAgreed) {
      const Point next{here.x + kLongStep * x / norm, here.y + kLongStep * y / norm};
      if (cost_at(next) < cost_at(here) && is_open(here, next)) return next;
    }
    const Point next{here.x + x / norm, here.y + y / norm};
    if (cost_at(next) < Wavefront<Real>::kFar && is_open(here, next)) return next;
    return std::nullopt;
  }

  // Add the next centre that a cell's cost came by, and return its cell, or the same if there is none.
  GridCell by_centres(GridCell cell, std::vector<Point> &line) {
    Direction direction{0, 0};
    if (!downhill(cell.row, cell.col, direction)) return cell;
    const GridCell next{cell.row + static_cast<std::int32_t>(std::lround(direction.y)),
                        cell.col + static_cast<std::int32_t>(std::lround(direction.x))};
    add_centre(cell, next, line);
    return next;
  }

  // Of the neighbours that cost less than a cell the one to go on by, or the same cell if there is none. Both cells
  // that a cost came by cost less than it, so that this gets to the source.
  GridCell cheaper_neighbour(GridCell cell) {
    constexpr Real kFar = Wavefront<Real>::kFar;
    const Real own = wavefront_.cost(cell.row, cell.col);
    Real best = kFar;
    GridCell next = cell;
    for (std::int32_t up = -1; up <= 1; ++up) {
      for (std::int32_t right = -1; right <= 1; ++right) {
        const Real cost = wavefront_.cost_or_far(cell.row + up, cell.col + right);
        if (!(cost < own)) continue;
        const bool diagonal = up != 0 && right != 0;
        if (diagonal) {
          const bool beside = wavefront_.weight(cell.row, cell.col + right) < kFar;
          const bool above = wavefront_.weight(cell.row + up, cell.col) < kFar;
          if (!(wavefront_.interpolates() ? beside || above : beside && above)) continue;
        }
        const Real mean = (wavefront_.weight(cell.row, cell.col) + wavefront_.weight(cell.row + up, cell.col + right)) / 2;
        const Real whole = cost + (diagonal ? Real(1.41421356237309505) : Real(1)) * mean;
        if (whole < best) best = whole, next = {cell.row + up, cell.col + right};
      }
    }
    return next;
  }

  // The centre of a cell beside the last one; past a corner by the open one of the cells beside both.
  void add_centre(GridCell cell, GridCell next, std::vector<Point> &line) const {
    if (next.row != cell.row && next.col != cell.col) {
      if (grid_.weight(cell.row, next.col) == 0.0) line.push_back(centre(next.row, cell.col));
      if (grid_.weight(next.row, cell.col) == 0.0) line.push_back(centre(cell.row, next.col));
    }
    line.push_back(centre(next.row, next.col));
  }

  Wavefront<Real> &wavefront_;
  const lines::WeightedGrid &grid_;
};

}  // namespace trundle
