// Maps from beams: cells count the beams that end in them and that pass through them, and where the wall is in between.
//
// Ends of beams scatter round a surface over two or three cells. The wall is drawn where they lie on average: the ends of
// a cell are moved across the surface onto the mean of those near by, and the cell where they come to lie is the wall.
#include "mapping/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "localization/checks.hpp"

namespace trundle {

using namespace localization;

namespace {

constexpr int kKinds = 4;
constexpr double kPerCell = 1000.0;
constexpr std::int32_t kSure = 4;  // beams that passed
constexpr std::int32_t kMost = 1'000'000;  // sums of places stay below 2^31

}  // namespace

void count_beams(Counts counts, In<double, 2> sensors, In<double, 2> points, In<std::uint8_t, 1> hits,
                 In<double, 1> corner, double resolution, double short_by, int sign) {
  check_points(sensors);
  check_points(points);
  check_resolution(resolution);
  refuse_unless(counts.shape(2) == kKinds, "counts need shape (rows, cols, 4)");
  refuse_unless(sensors.shape(0) == points.shape(0) && hits.shape(0) == points.shape(0), "each beam needs both ends");
  refuse_unless(corner.shape(0) == 2, "a corner has 2 numbers");
  refuse_far(corner.data(), 2, "the corner must be finite");
  refuse_unless(short_by >= 0.0 && short_by <= 1e3, "beams end up to a kilometre short");
  refuse_unless(sign == 1 || sign == -1, "beams are added (1) or taken away (-1)");
  nb::gil_scoped_release release;
  const auto rows = static_cast<std::ptrdiff_t>(counts.shape(0)), cols = static_cast<std::ptrdiff_t>(counts.shape(1));
  std::int32_t *cells = counts.data();
  const double per = 1.0 / resolution, cut = short_by * per;
  for (std::size_t i = 0; i < points.shape(0); ++i) {
    const double x0 = (sensors.data()[2 * i] - corner.data()[0]) * per, y0 = (sensors.data()[2 * i + 1] - corner.data()[1]) * per;
    const double x1 = (points.data()[2 * i] - corner.data()[0]) * per, y1 = (points.data()[2 * i + 1] - corner.data()[1]) * per;
    std::ptrdiff_t end_col = -1, end_row = -1;
    if (x1 >= 0.0 && y1 >= 0.0 && x1 < static_cast<double>(cols) && y1 < static_cast<double>(rows)) {
      end_col = static_cast<std::ptrdiff_t>(x1), end_row = static_cast<std::ptrdiff_t>(y1);
      std::int32_t *cell = cells + (end_row * cols + end_col) * kKinds;
      if (hits.data()[i] && cell[0] + sign >= 0 && cell[0] + sign <= kMost) {
        cell[0] += sign;
        cell[2] += sign * static_cast<std::int32_t>((x1 - static_cast<double>(end_col)) * kPerCell);
        cell[3] += sign * static_cast<std::int32_t>((y1 - static_cast<double>(end_row)) * kPerCell);
      }
    }
    const double length = std::hypot(x1 - x0, y1 - y0), until = hits.data()[i] ? length - cut : length;
    if (!(until > 0.0)) continue;
    // Voxel traversal (Amanatides and Woo 1987), from where the beam enters the map to where it leaves it.
    const double dx = (x1 - x0) / length, dy = (y1 - y0) / length;
    double first = 0.0, last = until;
    bool off = false;
    const double from[2] = {x0, y0}, along[2] = {dx, dy}, size[2] = {static_cast<double>(cols), static_cast<double>(rows)};
    for (int axis = 0; axis < 2; ++axis) {
      if (along[axis] == 0.0) {
        off = off || from[axis] < 0.0 || from[axis] >= size[axis];
        continue;
      }
      double low = -from[axis] / along[axis], high = (size[axis] - from[axis]) / along[axis];
      if (low > high) std::swap(low, high);
      first = std::max(first, low), last = std::min(last, high);
    }
    if (off || !(first < last)) continue;
    auto col = static_cast<std::ptrdiff_t>(std::clamp(std::floor(x0 + dx * first), 0.0, size[0] - 1.0));
    auto row = static_cast<std::ptrdiff_t>(std::clamp(std::floor(y0 + dy * first), 0.0, size[1] - 1.0));
    const std::ptrdiff_t right = dx > 0.0 ? 1 : -1, up = dy > 0.0 ? 1 : -1;
    const double far = 1e300;
    const double step_x = dx != 0.0 ? std::abs(1.0 / dx) : far, step_y = dy != 0.0 ? std::abs(1.0 / dy) : far;
    double next_x = dx != 0.0 ? (static_cast<double>(col + (dx > 0.0)) - x0) / dx : far;
    double next_y = dy != 0.0 ? (static_cast<double>(row + (dy > 0.0)) - y0) / dy : far;
    while (col >= 0 && row >= 0 && col < cols && row < rows) {
      std::int32_t &passed = cells[(row * cols + col) * kKinds + 1];
      if (!(hits.data()[i] && col == end_col && row == end_row) && passed + sign >= 0 && passed < kMost) passed += sign;
      if (next_x < next_y) {
        if (next_x >= last) break;
        col += right, next_x += step_x;
      } else {
        if (next_y >= last) break;
        row += up, next_y += step_y;
      }
    }
  }
}

nb::ndarray<nb::numpy, std::int8_t> draw_cells(In<std::int32_t, 3> counts, In<double, 1> settings) {
  refuse_unless(counts.shape(2) == kKinds, "counts need shape (rows, cols, 4)");
  refuse_unless(settings.shape(0) == 3, "there are 3 settings: least ends, least share, least beams");
  const double *s = settings.data();
  refuse_unless(s[0] >= 1.0 && s[0] <= 1e6 && s[1] > 0.0 && s[1] < 1.0 && s[2] >= 1.0 && s[2] <= 1e6,
                "a setting of the drawing is out of range");
  const auto rows = static_cast<std::ptrdiff_t>(counts.shape(0)), cols = static_cast<std::ptrdiff_t>(counts.shape(1));
  std::vector<std::int8_t> out(static_cast<std::size_t>(rows * cols), -1);
  {
    nb::gil_scoped_release release;
    const std::int32_t *cells = counts.data();
    // Where the ends of each cell come to lie on the surface.
    std::vector<float> moved(static_cast<std::size_t>(rows * cols), 0.0f);
    std::vector<float> beams(static_cast<std::size_t>(rows * cols), 0.0f);  // what passed where those had been
    std::vector<std::uint8_t> across(static_cast<std::size_t>(rows * cols), 0);  // the axis that a wall is across: 1 x, 2 y
    constexpr std::ptrdiff_t kReach = 2;
    for (std::ptrdiff_t row = 0; row < rows; ++row) {
      for (std::ptrdiff_t col = 0; col < cols; ++col) {
        const std::int32_t *mine = cells + (row * cols + col) * kKinds;
        if (mine[0] <= 0) continue;
        const double mx = mine[2] / (kPerCell * mine[0]), my = mine[3] / (kPerCell * mine[0]);
        double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;  // seen from the mean of the cell
        for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(0, row - kReach); r <= std::min(rows - 1, row + kReach); ++r) {
          for (std::ptrdiff_t c = std::max<std::ptrdiff_t>(0, col - kReach); c <= std::min(cols - 1, col + kReach); ++c) {
            const std::int32_t *other = cells + (r * cols + c) * kKinds;
            if (other[0] <= 0) continue;
            const double ex = static_cast<double>(c - col) + other[2] / (kPerCell * other[0]) - mx;
            const double ey = static_cast<double>(r - row) + other[3] / (kPerCell * other[0]) - my;
            const double d2 = ex * ex + ey * ey, near = std::max(0.0, 1.0 - d2 / 6.25), weight = near * other[0];
            n += weight, x += weight * ex, y += weight * ey;
            xx += weight * ex * ex, xy += weight * ex * ey, yy += weight * ey * ey;
          }
        }
        x /= n, y /= n;
        xx = xx / n - x * x, xy = xy / n - x * y, yy = yy / n - y * y;
        const double half = std::hypot(0.5 * (xx - yy), xy), mean = 0.5 * (xx + yy);
        double u = mx, v = my;
        std::uint8_t axis = 0;
        if (mean - half < 0.5 * (mean + half)) {  // a line, so it has a normal
          const double along = 0.5 * std::atan2(2.0 * xy, xx - yy), nx = -std::sin(along), ny = std::cos(along);
          const double by = x * nx + y * ny;
          u += by * nx, v += by * ny;
          axis = std::abs(nx) > std::abs(ny) ? 1 : 2;
        } else {
          u += x, v += y;
        }
        const auto c = std::clamp<std::ptrdiff_t>(col + static_cast<std::ptrdiff_t>(std::floor(u)), 0, cols - 1);
        const auto r = std::clamp<std::ptrdiff_t>(row + static_cast<std::ptrdiff_t>(std::floor(v)), 0, rows - 1);
        const auto to = static_cast<std::size_t>(r * cols + c);
        moved[to] += static_cast<float>(mine[0]);
        beams[to] += static_cast<float>(mine[1]);
        if (axis) across[to] = axis;
      }
    }
    const auto is_wall = [&](std::size_t at) {
      return moved[at] >= s[0] && moved[at] >= s[1] * (moved[at] + beams[at]);
    };
    // A wall on the border of two cells comes to lie in both of them by turns: the one with more ends keeps it.
    // On the side that beams came from it is free then, behind the wall it is not known: 1 or 2; 0 where it keeps it.
    const auto beaten = [&](std::ptrdiff_t row, std::ptrdiff_t col) {
      const auto at = static_cast<std::size_t>(row * cols + col);
      if (!across[at]) return 0;
      for (const std::ptrdiff_t step : {std::ptrdiff_t{-1}, std::ptrdiff_t{1}}) {
        const std::ptrdiff_t r = across[at] == 2 ? row + step : row, c = across[at] == 1 ? col + step : col;
        if (r < 0 || c < 0 || r >= rows || c >= cols) continue;
        const auto other = static_cast<std::size_t>(r * cols + c);
        if (across[other] != across[at] || !is_wall(other)) continue;
        if (moved[other] < moved[at] || (moved[other] == moved[at] && step > 0)) continue;
        bool is_seen = false;  // beams end a little short of a wall, and those that graze it pass through its cells
        for (std::ptrdiff_t away = 1; away <= 2; ++away) {
          const std::ptrdiff_t r2 = across[at] == 2 ? row - away * step : row, c2 = across[at] == 1 ? col - away * step : col;
          is_seen = is_seen || (r2 >= 0 && c2 >= 0 && r2 < rows && c2 < cols && cells[(r2 * cols + c2) * kKinds + 1] > 0);
        }
        return is_seen ? 1 : 2;
      }
      return 0;
    };
    for (std::ptrdiff_t row = 0; row < rows; ++row) {
      for (std::ptrdiff_t col = 0; col < cols; ++col) {
        const auto at = static_cast<std::size_t>(row * cols + col);
        const std::int32_t *mine = cells + (row * cols + col) * kKinds;
        const double ends = moved[at], passed = ends > 0.0 ? beams[at] : 0.0;
        const double share = ends > 0.0 ? ends / (ends + passed) : 0.0;
        const int lost = is_wall(at) ? beaten(row, col) : 0;
        if (lost) {
          out[at] = lost == 1 ? 10 : -1;
        } else if (is_wall(at)) {
          // From the least share on 65 to 100: what maps take for occupied.
          out[at] = static_cast<std::int8_t>(std::lround(65.0 + 35.0 * (share - s[1]) / (1.0 - s[1])));
        } else if (mine[1] + mine[0] >= s[2]) {
          const double all = static_cast<double>(mine[1]) + ends;
          const double odds = all > 0.0 ? std::min(1.0, ends / (all * s[1])) : 0.0;
          // What some beams passed is free, though a person stood there once; of what one or two passed it is not sure.
          const double doubt = mine[1] >= kSure || odds < 0.5 ? 20.0 * odds : 20.0 + 80.0 * (odds - 0.5);
          out[at] = mine[1] > 0 ? static_cast<std::int8_t>(std::lround(doubt)) : -1;
        }
      }
    }
    // Beams are counted up to a little before their ends: what is left between free space and a wall is free.
    std::vector<std::size_t> before;
    for (std::ptrdiff_t row = 1; row + 1 < rows; ++row) {
      for (std::ptrdiff_t col = 1; col + 1 < cols; ++col) {
        const auto at = static_cast<std::size_t>(row * cols + col);
        if (out[at] != -1) continue;
        for (const std::ptrdiff_t to : {std::ptrdiff_t{1}, std::ptrdiff_t{-1}, cols, -cols}) {
          const auto wall = static_cast<std::size_t>(row * cols + col + to), free = static_cast<std::size_t>(row * cols + col - to);
          if (out[wall] >= 65 && out[free] >= 0 && out[free] <= 20) {
            before.push_back(at);
            break;
          }
        }
      }
    }
    for (const std::size_t at : before) out[at] = 10;
  }
  return to_numpy(std::move(out), {static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)});
}

}  // namespace trundle
