// The two planners that `least_cost` is measured against, on potentials: built and called by path_cost.py.
//
// navfn: what Nav2's NavFn does by default, reimplemented from its description. A potential that spreads from the one end
// in three priority buffers until the other is reached, interpolated with NavFn's quadratic, whole weights 50 + 0.8 c,
// the map's border blocked; then steps of half a cell down the interpolated gradient.
// eikonal: the first-order upwind solution of |grad u| = w over the whole map by fast marching (Sethian, 1996), exact
// for its scheme; then steps of `step` cells down its interpolated gradient.
//
// Both write a polyline (x, y) in grid units, centres at .5, and answer how many points it has, or 0 for no path.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

namespace {

constexpr float kUnset = 1e10f;

struct Field {
  std::int64_t rows, cols;
  std::vector<float> value;
  float at(std::int64_t index) const { return value[static_cast<std::size_t>(index)]; }
};

// Downhill direction at a cell's centre, of length 1, or 0 where it has none.
std::pair<float, float> downhill(const Field &field, std::int64_t index, float away) {
  const float here = field.at(index);
  const float left = field.at(index - 1), right = field.at(index + 1);
  const float down = field.at(index - field.cols), up = field.at(index + field.cols);
  float dx = 0.0f, dy = 0.0f;
  if (here >= kUnset) {
    dx = left < kUnset ? -away : right < kUnset ? away : 0.0f;
    dy = down < kUnset ? -away : up < kUnset ? away : 0.0f;
  } else {
    if (left < kUnset) dx += left - here;
    if (right < kUnset) dx += here - right;
    if (down < kUnset) dy += down - here;
    if (up < kUnset) dy += here - up;
  }
  const float norm = std::hypot(dx, dy);
  return norm > 0.0f ? std::make_pair(dx / norm, dy / norm) : std::make_pair(0.0f, 0.0f);
}

// Steps down the field from `from` until the nearest cell is within `near` of the source.
std::int64_t descend(const Field &field, std::int64_t from, std::int64_t source, float near, float step, double *path,
                     std::int64_t room) {
  const std::int64_t cols = field.cols;
  std::int64_t cell = from, count = 0;
  float dx = 0.0f, dy = 0.0f;
  const auto put = [&](double x, double y) {
    path[2 * count] = x + 0.5;
    path[2 * count + 1] = y + 0.5;
    ++count;
  };
  while (count + 1 < room) {
    const std::int64_t nearest = std::clamp<std::int64_t>(
        cell + std::lround(dx) + cols * std::lround(dy), 0, field.rows * cols - 1);
    if (field.at(nearest) < near) {
      put(static_cast<double>(source % cols), static_cast<double>(source / cols));
      return count;
    }
    const std::int64_t row = cell / cols, col = cell % cols;
    if (row < 1 || row >= field.rows - 2 || col < 1 || col >= cols - 2) return 0;
    put(static_cast<double>(col) + dx, static_cast<double>(row) + dy);
    const bool swings = count > 2 && path[2 * count - 2] == path[2 * count - 6] && path[2 * count - 1] == path[2 * count - 5];
    std::int64_t lowest = cell;
    bool edge = swings;
    for (std::int64_t k : {-cols - 1, -cols, -cols + 1, std::int64_t{-1}, std::int64_t{1}, cols - 1, cols, cols + 1}) {
      if (field.at(cell + k) >= kUnset) edge = true;
      if (field.at(cell + k) < field.at(lowest)) lowest = cell + k;
    }
    if (edge) {
      if (lowest == cell && dx == 0.0f && dy == 0.0f) return 0;
      cell = lowest;
      dx = dy = 0.0f;
      if (field.at(cell) >= kUnset) return 0;
      continue;
    }
    const auto a = downhill(field, cell, 254.0f), b = downhill(field, cell + 1, 254.0f);
    const auto c = downhill(field, cell + cols, 254.0f), d = downhill(field, cell + cols + 1, 254.0f);
    const auto mix = [&](float aa, float bb, float cc, float dd) {
      return (1.0f - dy) * ((1.0f - dx) * aa + dx * bb) + dy * ((1.0f - dx) * cc + dx * dd);
    };
    const float x = mix(a.first, b.first, c.first, d.first), y = mix(a.second, b.second, c.second, d.second);
    const float norm = std::hypot(x, y);
    if (norm == 0.0f) return 0;
    dx += step * x / norm;
    dy += step * y / norm;
    if (dx > 1.0f) ++cell, dx -= 1.0f;
    if (dx < 0.0f) --cell, dx += 1.0f;
    if (dy > 1.0f) cell += cols, dy -= 1.0f;
    if (dy < 0.0f) cell -= cols, dy += 1.0f;
  }
  return 0;
}

// With `whole` the potential is spread over the whole map, and no path is traced.
std::int64_t run_navfn(const std::uint8_t *costs, std::int64_t rows, std::int64_t cols, std::int64_t start,
                       std::int64_t goal, bool whole, double *path, std::int64_t room) {
  const std::int64_t cells = rows * cols;
  std::vector<std::uint8_t> weight(static_cast<std::size_t>(cells), 254), waiting(static_cast<std::size_t>(cells), 0);
  for (std::int64_t row = 1; row + 1 < rows; ++row) {
    for (std::int64_t i = row * cols + 1; i < row * cols + cols - 1; ++i) {
      if (costs[i] < 253) weight[i] = static_cast<std::uint8_t>(std::min(253.0, 50.0 + 0.8 * costs[i]));
    }
  }
  Field field{rows, cols, std::vector<float>(static_cast<std::size_t>(cells), kUnset)};
  auto &pot = field.value;
  std::vector<std::int32_t> now, next, over;
  const auto push = [&](std::vector<std::int32_t> &to, std::int64_t index) {
    if (index < 0 || index >= cells || waiting[index] || weight[index] == 254) return;
    to.push_back(static_cast<std::int32_t>(index));
    waiting[index] = 1;
  };
  pot[start] = 0.0f;
  for (std::int64_t k : {std::int64_t{1}, std::int64_t{-1}, cols, -cols}) push(now, start + k);
  float threshold = 254.0f;
  while (!now.empty() || !over.empty()) {
    for (std::int32_t index : now) waiting[index] = 0;
    for (std::int32_t index : now) {
      const float left = pot[index - 1], right = pot[index + 1], up = pot[index - cols], down = pot[index + cols];
      float across = std::min(left, right), along = std::min(up, down);
      const float hf = weight[index];
      float difference = across - along;
      if (difference < 0.0f) {
        difference = -difference;
        along = across;
      }
      float value = along + hf;
      if (difference < hf) {
        const float d = difference / hf;
        value = along + hf * (-0.2301f * d * d + 0.5307f * d + 0.7040f);
      }
      if (!(value < pot[index])) continue;
      pot[index] = value;
      auto &to = value < threshold ? next : over;
      const auto offer = [&](std::int64_t there, float known) {
        if (known > value + 0.707106781f * weight[there]) push(to, there);
      };
      offer(index - 1, left);
      offer(index + 1, right);
      offer(index - cols, up);
      offer(index + cols, down);
    }
    now.clear();
    std::swap(now, next);
    if (now.empty()) {
      threshold += 100.0f;
      std::swap(now, over);
    }
    if (!whole && pot[goal] < kUnset) break;
  }
  if (whole) return 0;
  return pot[goal] < kUnset ? descend(field, goal, start, 50.0f, 0.5f, path, room) : 0;
}

}  // namespace

extern "C" std::int64_t navfn(const std::uint8_t *costs, std::int64_t rows, std::int64_t cols, std::int64_t start,
                              std::int64_t goal, double *path, std::int64_t room) {
  return run_navfn(costs, rows, cols, start, goal, false, path, room);
}

extern "C" std::int64_t navfn_field(const std::uint8_t *costs, std::int64_t rows, std::int64_t cols,
                                    std::int64_t start, std::int64_t goal, double *path, std::int64_t room) {
  return run_navfn(costs, rows, cols, start, goal, true, path, room);
}

extern "C" std::int64_t eikonal(const std::uint8_t *costs, const double *weights, std::int64_t rows, std::int64_t cols,
                                std::int64_t start, std::int64_t goal, double step, double *path, std::int64_t room) {
  const std::int64_t cells = rows * cols;
  const double unset = std::numeric_limits<double>::infinity();
  std::vector<double> value(static_cast<std::size_t>(cells), unset);
  std::vector<std::uint8_t> done(static_cast<std::size_t>(cells), 0);
  std::priority_queue<std::pair<double, std::int64_t>, std::vector<std::pair<double, std::int64_t>>, std::greater<>> queue;
  value[start] = 0.0;
  queue.push({0.0, start});
  const auto read = [&](std::int64_t row, std::int64_t col) {
    return row < 0 || row >= rows || col < 0 || col >= cols ? unset : value[row * cols + col];
  };
  while (!queue.empty()) {
    const std::int64_t here = queue.top().second;
    queue.pop();
    if (done[here]) continue;
    done[here] = 1;
    const std::int64_t row = here / cols, col = here % cols;
    const std::int64_t step_row[4] = {0, 0, 1, -1}, step_col[4] = {1, -1, 0, 0};
    for (int k = 0; k < 4; ++k) {
      const std::int64_t r = row + step_row[k], c = col + step_col[k];
      if (r < 0 || r >= rows || c < 0 || c >= cols) continue;
      const std::int64_t there = r * cols + c;
      const double w = weights[costs[there]];
      if (done[there] || w == 0.0) continue;
      const double a = std::min(read(r, c - 1), read(r, c + 1)), b = std::min(read(r - 1, c), read(r + 1, c));
      const double low = std::min(a, b), apart = std::abs(a - b);
      const double u = apart >= w ? low + w : 0.5 * (a + b + std::sqrt(2.0 * w * w - apart * apart));
      if (u < value[there]) {
        value[there] = u;
        queue.push({u, there});
      }
    }
  }
  if (value[goal] == unset) return 0;
  Field field{rows, cols, std::vector<float>(static_cast<std::size_t>(cells), kUnset)};
  for (std::int64_t i = 0; i < cells; ++i) {
    if (value[i] < unset) field.value[i] = static_cast<float>(value[i]);
  }
  return descend(field, goal, start, 50.0f, static_cast<float>(step), path, room);
}
