// The picture of a scan: which cells its beams pass, and which they hit.
//
// Nothing changes where all is surely free already, which is most of what beams pass: they jump over squares of such
// cells, and only the other squares are drawn and added.
//
// A beam is drawn as in Bresenham's algorithm: one cell for each step along its longer axis, the one that it passes at
// the middle of the step. The cell in which it ends is not passed. The cell behind that one loses what hits it had
// gathered on the way to a mark: a range that is too long now and then does not thicken a wall on its far side, where no
// beam clears.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "layers/evidence.hpp"
#include "shared/registers.hpp"

namespace trundle {
namespace {  // of the one file that includes this, so that compilers inline it

constexpr std::uint8_t kBehind = 1, kPassed = 2, kHit = 3;
constexpr int kSquareBits = 4;
constexpr std::ptrdiff_t kSquare = 1 << kSquareBits;  // cells along the edge of a square

// Clears from (x0, y0) to (x1, y1) and marks (hit_x, hit_y), in cells of the grid; (dx, dy) is its direction.
struct Beam {
  double x0, y0, x1, y1, hit_x, hit_y, dx, dy;
  bool clears, marks;
};

// The cell of the grid that a beam marks, and where in it; and the cell behind that.
struct Mark {
  std::ptrdiff_t row, col, behind_row, behind_col;
  std::uint8_t x, y;

  static Mark of(const Beam &beam) {
    const double col = std::floor(beam.hit_x), row = std::floor(beam.hit_y);
    const double behind_col = std::floor(beam.hit_x + beam.dx), behind_row = std::floor(beam.hit_y + beam.dy);
    return {static_cast<std::ptrdiff_t>(row), static_cast<std::ptrdiff_t>(col), static_cast<std::ptrdiff_t>(behind_row),
            static_cast<std::ptrdiff_t>(behind_col), static_cast<std::uint8_t>((beam.hit_x - col) * kSubcells),
            static_cast<std::uint8_t>((beam.hit_y - row) * kSubcells)};
  }
};

struct Bounds {
  double low_x = kFarthest * 4.0, low_y = low_x, high_x = -low_x, high_y = -low_x;

  void add(double x, double y) {
    low_x = std::min(low_x, x);
    low_y = std::min(low_y, y);
    high_x = std::max(high_x, x);
    high_y = std::max(high_y, y);
  }
};

// Cells of a picture that a beam passes: from column `first` on, column by column in direction `step`, each in row
// `y >> 32`; or the same with rows and columns swapped.
struct Line {
  std::ptrdiff_t first, step, count;
  std::int64_t y, rise;

  // On the way from (x0, y0) to (x1, y1).
  static Line along_x(double x0, double y0, double x1, double y1) {
    const auto fixed = [](double value) { return static_cast<std::int64_t>(std::floor(value * 4294967296.0 + 0.5)); };
    const auto first = static_cast<std::ptrdiff_t>(std::floor(x0)), last = static_cast<std::ptrdiff_t>(std::floor(x1));
    const double slope = (y1 - y0) / (x1 - x0);
    const std::ptrdiff_t step = last > first ? 1 : -1;
    return {first, step, step * (last - first), fixed(y0 + (static_cast<double>(first) + 0.5 - x0) * slope),
            fixed(static_cast<double>(step) * slope)};
  }
};

// The picture of a scan: cells [row, row + rows) x [col, col + cols) of the grid, in squares.
struct Picture {
  static constexpr double kMostPixels = 268435456.0;    // 16384 x 16384
  static constexpr std::size_t kMostSpare = 4'000'000;  // pixels

  std::ptrdiff_t row, col, rows, cols, square_rows, square_cols;
  std::vector<std::uint8_t> pixels;
  std::vector<std::uint8_t> open;   // for each square, whether it has a cell that is not surely free, ...
  std::vector<std::uint8_t> drawn;  // ... and whether a beam may have passed one of these

  // Two rows and columns more on each side: the middle of a beam's first step may lie before its start, and what is
  // behind a hit a cell further on.
  explicit Picture(const Bounds &bounds)
      : row(static_cast<std::ptrdiff_t>(std::floor(bounds.low_y)) - 2),
        col(static_cast<std::ptrdiff_t>(std::floor(bounds.low_x)) - 2),
        rows(static_cast<std::ptrdiff_t>(std::floor(bounds.high_y)) + 3 - row),
        cols(static_cast<std::ptrdiff_t>(std::floor(bounds.high_x)) + 3 - col),
        square_rows((rows + kSquare - 1) / kSquare),
        square_cols((cols + kSquare - 1) / kSquare) {
    if (static_cast<double>(rows) * static_cast<double>(cols) > kMostPixels) {
      throw std::invalid_argument("the beams reach over too many cells");
    }
    pixels.swap(spare());
    pixels.assign(static_cast<std::size_t>(rows * cols), 0);
    open.resize(static_cast<std::size_t>(square_rows * square_cols));
    drawn.assign(open.size(), 0);
  }
  Picture(const Picture &) = delete;
  Picture &operator=(const Picture &) = delete;
  ~Picture() {
    if (pixels.size() <= kMostSpare) pixels.swap(spare());
  }

  // Memory of the thread's last picture: the system would take back and clear so much each time.
  static std::vector<std::uint8_t> &spare() {
    static thread_local std::vector<std::uint8_t> memory;
    return memory;
  }

  std::uint8_t &at(std::ptrdiff_t grid_row, std::ptrdiff_t grid_col) {
    return pixels[static_cast<std::size_t>((grid_row - row) * cols + grid_col - col)];
  }

  // Rows and columns of the picture that lie in a grid with so many rows and columns.
  CellBox inside(std::ptrdiff_t grid_rows, std::ptrdiff_t grid_cols) const {
    return {std::max<std::ptrdiff_t>(0, -row), std::min(rows, grid_rows - row), std::max<std::ptrdiff_t>(0, -col),
            std::min(cols, grid_cols - col)};
  }

  // Find the squares that are open; there is nothing to change beside the grid.
  TRUNDLE_INLINE void look_at(const std::uint8_t *evidence, std::ptrdiff_t grid_rows, std::ptrdiff_t grid_cols) {
    const CellBox part = inside(grid_rows, grid_cols);
    std::vector<std::uint8_t> any(static_cast<std::size_t>(square_cols * kSquare));
    for (std::ptrdiff_t s = 0; s < square_rows; ++s) {
      std::fill(any.begin(), any.end(), std::uint8_t{0});
      const std::ptrdiff_t end = std::min(part.row_end, (s + 1) * kSquare);
      for (std::ptrdiff_t r = std::max(part.row, s * kSquare); r < end; ++r) {
        add_unsure(evidence + (row + r) * grid_cols + col + part.col, any.data() + part.col, part.col_end - part.col);
      }
      for (std::ptrdiff_t c = 0; c < square_cols; ++c) {
        std::uint8_t one = 0;
        for (std::ptrdiff_t i = 0; i < kSquare; ++i) one |= any[static_cast<std::size_t>(c * kSquare + i)];
        open[static_cast<std::size_t>(s * square_cols + c)] = one;
      }
    }
  }

  static TRUNDLE_INLINE void add_unsure(const std::uint8_t *__restrict evidence, std::uint8_t *__restrict any,
                                        std::ptrdiff_t count) {
    for (std::ptrdiff_t i = 0; i < count; ++i) any[i] |= evidence[i] ^ 1;
  }

  // Draw what a line passes in open squares.
  template <bool kSwapped>
  TRUNDLE_INLINE void draw(const Line &line) {
    const std::ptrdiff_t along = kSwapped ? cols : 1, across = kSwapped ? 1 : cols, step = line.step;
    const std::ptrdiff_t squares_along = kSwapped ? square_cols : 1, squares_across = kSwapped ? 1 : square_cols;
    const std::int64_t rise = line.rise;
    std::int64_t y = line.y;
    for (std::ptrdiff_t x = line.first, left = line.count; left > 0;) {
      const std::ptrdiff_t count = std::min(left, 1 + ((step > 0 ? ~x : x) & (kSquare - 1)));  // to the edge of a square
      const std::int64_t last = y + (count - 1) * rise;
      const std::ptrdiff_t squares = (x >> kSquareBits) * squares_along;
      const std::ptrdiff_t one = squares + (y >> (32 + kSquareBits)) * squares_across;
      const std::ptrdiff_t other = squares + (last >> (32 + kSquareBits)) * squares_across;
      if (open[one] | open[other]) {
        drawn[one] = drawn[other] = 1;
        std::uint8_t *out = pixels.data() + x * along;
        for (std::ptrdiff_t n = count; n > 0; --n) {
          out[(y >> 32) * across] = kPassed;
          y += rise;
          out += step * along;
        }
      } else {
        y = last + rise;
      }
      x += step * count;
      left -= count;
    }
  }

  TRUNDLE_INLINE void draw(const std::vector<Beam> &beams, const std::vector<Mark> &marks) {
    for (const Mark &mark : marks) at(mark.behind_row, mark.behind_col) = kBehind;
    for (const Beam &beam : beams) {
      if (!beam.clears) continue;
      const double x0 = beam.x0 - static_cast<double>(col), y0 = beam.y0 - static_cast<double>(row);
      const double x1 = beam.x1 - static_cast<double>(col), y1 = beam.y1 - static_cast<double>(row);
      if (!(std::abs(x1 - x0) >= std::abs(y1 - y0))) {
        draw<true>(Line::along_x(y0, x0, y1, x1));
      } else if (x1 != x0) {
        draw<false>(Line::along_x(x0, y0, x1, y1));
      }
    }
    for (const Mark &mark : marks) at(mark.row, mark.col) = kHit;
  }
};

}  // namespace
}  // namespace trundle
