// Where do these points fit best? Branch and bound over (x, y, yaw), as in Hess, Kohler, Rapp and Andor 2016 (Real-time
// loop closure in 2D lidar SLAM): a table of the map's values at several levels, each of which holds for a square of
// 2^level cells the largest value in it, bounds from above what any pose in that square can score.
//
// Boxes are looked at from the most promising on, depth first, so that a good pose is soon known and most boxes are cut
// off. Several poses are kept where they lie apart: a symmetric map has several.
#include "localization/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "localization/checks.hpp"

namespace trundle {

using namespace localization;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMostLevels = 6;

// Largest values in squares of 2^level cells from each cell on, up and to the right.
struct Levels {
  std::ptrdiff_t rows, cols;
  std::vector<std::vector<std::uint8_t>> values, open;

  Levels(const std::uint8_t *table, const std::uint8_t *allowed, std::ptrdiff_t rows_, std::ptrdiff_t cols_, int count)
      : rows(rows_), cols(cols_) {
    const auto cells = static_cast<std::size_t>(rows * cols);
    values.emplace_back(table, table + cells);
    open.emplace_back(allowed, allowed + cells);
    for (int level = 1; level < count; ++level) {
      values.push_back(doubled(values.back(), std::ptrdiff_t{1} << (level - 1)));
      open.push_back(doubled(open.back(), std::ptrdiff_t{1} << (level - 1)));
    }
  }

  std::vector<std::uint8_t> doubled(const std::vector<std::uint8_t> &from, std::ptrdiff_t step) const {
    std::vector<std::uint8_t> wide(from), out;
    for (std::ptrdiff_t row = 0; row < rows; ++row) {
      std::uint8_t *line = wide.data() + row * cols;
      const std::uint8_t *old = from.data() + row * cols;
      for (std::ptrdiff_t col = 0; col + step < cols; ++col) line[col] = std::max(old[col], old[col + step]);
    }
    out = wide;
    for (std::ptrdiff_t row = 0; row + step < rows; ++row) {
      std::uint8_t *line = out.data() + row * cols;
      const std::uint8_t *above = wide.data() + (row + step) * cols;
      for (std::ptrdiff_t col = 0; col < cols; ++col) line[col] = std::max(line[col], above[col]);
    }
    return out;
  }
};

struct Cell {
  std::int32_t x, y;
};

struct Box {
  std::int32_t x, y;  // lower-left cell of the robot
  std::int32_t turn;
  std::int32_t score;  // no pose in it scores more
};

struct Found {
  double x, y, yaw;
  std::int32_t score;
};

class Search {
 public:
  Search(const Levels &levels, std::int32_t least, double share, double apart_m, double apart_rad, double resolution,
         std::int64_t most, std::int64_t most_nodes)
      : levels_(levels), least_(least), share_(share), apart_m_(apart_m), apart_rad_(apart_rad),
        resolution_(resolution), most_(static_cast<std::size_t>(most)), left_(most_nodes) {}

  std::vector<std::vector<Cell>> turned;  // the points in cells, for each yaw
  std::vector<double> yaws;
  std::vector<Found> found;
  bool complete = true;

  // Points that lie left of or below the table may still reach it within the square, so the square is cut there.
  std::int32_t score(int level, std::int32_t x, std::int32_t y, std::int32_t turn, std::int32_t needed) const {
    const std::uint8_t *values = levels_.values[level].data();
    const std::int32_t size = std::int32_t{1} << level, rows = static_cast<std::int32_t>(levels_.rows),
                       cols = static_cast<std::int32_t>(levels_.cols);
    const std::vector<Cell> &cells = turned[turn];
    std::int32_t sum = 0, left = static_cast<std::int32_t>(cells.size());
    for (const Cell &cell : cells) {
      std::int32_t u = x + cell.x, v = y + cell.y;
      if (u < 0 && u + size > 0) u = 0;
      if (v < 0 && v + size > 0) v = 0;
      if (u >= 0 && v >= 0 && u < cols && v < rows) sum += values[static_cast<std::ptrdiff_t>(v) * cols + u];
      if (sum + 255 * --left < needed) return -1;
    }
    return sum;
  }

  bool may_stand(int level, std::int32_t x, std::int32_t y) const {
    return x < levels_.cols && y < levels_.rows && levels_.open[level][static_cast<std::ptrdiff_t>(y) * levels_.cols + x];
  }

  // What a box must score to matter; a box within one that was found must beat that one.
  std::int32_t needed() const {
    std::int32_t limit = least_;
    if (!found.empty()) limit = std::max(limit, static_cast<std::int32_t>(share_ * found.front().score));
    if (found.size() >= most_) limit = std::max(limit, found.back().score + 1);
    return limit;
  }

  void branch(const Box &box, int level, const std::int32_t high[2]) {
    if (box.score < needed() || is_covered(box, level)) return;
    if (--left_ < 0) {
      complete = false;
      return;
    }
    if (level == 0) {
      add({(box.x + 0.5) * resolution_, (box.y + 0.5) * resolution_, yaws[box.turn], box.score});
      return;
    }
    const std::int32_t half = std::int32_t{1} << (level - 1), limit = needed();
    Box parts[4];
    int count = 0;
    for (int i = 0; i < 4; ++i) {
      Box part{box.x + (i & 1) * half, box.y + (i >> 1) * half, box.turn, 0};
      if (part.x > high[0] || part.y > high[1] || !may_stand(level - 1, part.x, part.y)) continue;
      part.score = score(level - 1, part.x, part.y, part.turn, limit);
      if (part.score >= limit) parts[count++] = part;
    }
    std::stable_sort(parts, parts + count, [](const Box &a, const Box &b) { return a.score > b.score; });
    for (int i = 0; i < count; ++i) branch(parts[i], level - 1, high);
  }

 private:
  bool is_near(const Found &one, double x, double y, double yaw, double slack) const {
    return std::hypot(one.x - x, one.y - y) + slack <= apart_m_ &&
           std::abs(std::remainder(one.yaw - yaw, 2.0 * kPi)) <= apart_rad_;
  }

  bool is_covered(const Box &box, int level) const {
    const double half = 0.5 * static_cast<double>(std::int32_t{1} << level);
    for (const Found &one : found) {
      if (one.score >= box.score && is_near(one, (box.x + half) * resolution_, (box.y + half) * resolution_,
                                            yaws[box.turn], 1.5 * half * resolution_)) {
        return true;
      }
    }
    return false;
  }

  void add(const Found &given) {
    std::vector<Found> kept;
    for (const Found &one : found) {
      if (is_near(one, given.x, given.y, given.yaw, 0.0)) {
        if (one.score >= given.score) return;
        continue;
      }
      kept.push_back(one);
    }
    const auto after = std::find_if(kept.begin(), kept.end(), [&](const Found &one) { return one.score < given.score; });
    kept.insert(after, given);
    if (kept.size() > most_) kept.resize(most_);
    while (static_cast<std::int32_t>(share_ * kept.front().score) > kept.back().score) kept.pop_back();
    found = std::move(kept);
  }

  const Levels &levels_;
  std::int32_t least_;
  double share_, apart_m_, apart_rad_, resolution_;
  std::size_t most_;
  std::int64_t left_;
};

}  // namespace

nb::tuple search_poses(In<std::uint8_t, 2> table, In<std::uint8_t, 2> allowed, double resolution, In<double, 2> points,
                       In<double, 1> window, In<double, 1> settings, std::int64_t most, std::int64_t most_nodes) {
  check_resolution(resolution);
  check_points(points);
  refuse_unless(table.shape(0) > 0 && table.shape(1) > 0 && table.shape(0) < 100'000 && table.shape(1) < 100'000,
                "the table must have from 1 to 100,000 rows and columns");
  refuse_unless(allowed.shape(0) == table.shape(0) && allowed.shape(1) == table.shape(1),
                "what is allowed needs the shape of the table");
  refuse_unless(points.shape(0) > 0 && points.shape(0) <= 100'000, "there must be from 1 to 100,000 points");
  for (std::size_t i = 0; i < points.size(); ++i) {
    refuse_unless(std::abs(points.data()[i]) <= 1e5 * resolution, "points must be within 100,000 cells");
  }
  refuse_unless(window.shape(0) == 6, "the window has 6 numbers: least and most x, y, yaw");
  refuse_far(window.data(), 6, "the window must be finite");
  refuse_unless(settings.shape(0) == 5, "there are 5 settings: step, least score, share, metres and radians apart");
  refuse_far(settings.data(), 5, "the settings must be finite");
  const double *w = window.data(), *s = settings.data();
  refuse_unless(s[0] >= 1e-3 && s[1] >= 0.0 && s[1] <= 255.0 && s[2] >= 0.0 && s[2] <= 1.0 && s[3] >= 0.0 && s[4] >= 0.0,
                "a setting of the search is out of range");
  refuse_unless(w[5] - w[4] <= 7.0, "the window must be at most a turn wide");
  refuse_unless(most >= 1 && most <= 1000 && most_nodes >= 1, "there must be from 1 to 1000 poses, and nodes");
  std::vector<double> poses, scores;
  bool complete = true;
  {
    nb::gil_scoped_release release;
    const auto rows = static_cast<std::ptrdiff_t>(table.shape(0)), cols = static_cast<std::ptrdiff_t>(table.shape(1));
    const auto cell = [&](double metres, std::ptrdiff_t count) {
      return static_cast<std::int32_t>(std::clamp(std::floor(metres / resolution), 0.0, static_cast<double>(count - 1)));
    };
    const std::int32_t low[2] = {cell(w[0], cols), cell(w[2], rows)}, high[2] = {cell(w[1], cols), cell(w[3], rows)};
    const std::int32_t widest = std::max(high[0] - low[0], high[1] - low[1]) + 1;
    int levels = 1;
    while (levels < kMostLevels && (std::int32_t{1} << levels) <= widest) ++levels;
    const Levels pyramid(table.data(), allowed.data(), rows, cols, levels);
    const double count = static_cast<double>(points.shape(0));
    Search search(pyramid, static_cast<std::int32_t>(std::ceil(s[1] * count)), s[2], s[3], s[4], resolution, most,
                  most_nodes);
    const auto turns = static_cast<std::int32_t>(std::max(1.0, std::ceil((w[5] - w[4]) / s[0] + 0.5)));
    for (std::int32_t turn = 0; turn < turns; ++turn) {
      const double yaw = w[4] + turn * s[0], cos = std::cos(yaw), sin = std::sin(yaw);
      search.yaws.push_back(std::remainder(yaw, 2.0 * kPi));
      std::vector<Cell> cells;
      for (std::size_t i = 0; i < points.shape(0); ++i) {
        const double x = points.data()[2 * i], y = points.data()[2 * i + 1];
        // From the middle of the robot's cell.
        cells.push_back({static_cast<std::int32_t>(std::floor((cos * x - sin * y) / resolution + 0.5)),
                         static_cast<std::int32_t>(std::floor((sin * x + cos * y) / resolution + 0.5))});
      }
      search.turned.push_back(std::move(cells));
    }
    const int top = levels - 1;
    std::vector<Box> roots;
    const std::int32_t size = std::int32_t{1} << top, least = search.needed();
    for (std::int32_t y = low[1]; y <= high[1]; y += size) {
      for (std::int32_t x = low[0]; x <= high[0]; x += size) {
        if (!search.may_stand(top, x, y)) continue;
        for (std::int32_t turn = 0; turn < turns; ++turn) {
          const std::int32_t score = search.score(top, x, y, turn, least);
          if (score >= least) roots.push_back({x, y, turn, score});
        }
      }
    }
    std::stable_sort(roots.begin(), roots.end(), [](const Box &a, const Box &b) { return a.score > b.score; });
    for (const Box &root : roots) {
      if (root.score < search.needed() || !search.complete) break;
      search.branch(root, top, high);
    }
    complete = search.complete;
    for (const Found &one : search.found) {
      poses.insert(poses.end(), {one.x, one.y, one.yaw});
      scores.push_back(one.score / count);
    }
  }
  const std::size_t kept = scores.size();
  return nb::make_tuple(to_numpy(std::move(poses), {kept, 3}), to_numpy(std::move(scores), {kept}), complete);
}

}  // namespace trundle
