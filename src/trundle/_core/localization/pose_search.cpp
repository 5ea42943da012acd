// Where do these points fit best? Branch and bound over (x, y, yaw), as in Hess, Kohler, Rapp and Andor 2016 (Real-time
// loop closure in 2D lidar SLAM): a table of the map's values at several levels, each of which holds for a square of
// 2^level cells the largest value in it, bounds from above what any pose in that square can score.
//
// Boxes are looked at from the most promising on, depth first, so that a good pose is soon known and most boxes are cut
// off. Several poses are kept where they lie apart: a symmetric map has several. A box's four parts are scored together,
// group of points by group: what the box itself scored in the groups to come bounds what its parts can score there, so
// most of them are given up early.
#include "localization/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "localization/checks.hpp"

namespace trundle {

using namespace localization;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMostLevels = 6;

constexpr int kGroups = 6;

struct Range {
  std::int32_t first, last;
};

// Largest values in squares of 2^level cells from each cell on, up and to the right: of a part of a table, with a
// margin of zeros round it. Points left of it or below may still reach into it, and parts of squares may lie beyond it.
struct Levels {
  std::ptrdiff_t margin, rows, cols;  // of what may be looked up
  std::ptrdiff_t left, bottom, stride;
  std::vector<std::vector<std::uint8_t>> values, open;

  Levels(const std::uint8_t *table, const std::uint8_t *allowed, std::ptrdiff_t table_cols, Range x, Range y, int count)
      : margin(std::ptrdiff_t{1} << (count - 1)), rows(y.last - y.first + 1 + margin),
        cols(x.last - x.first + 1 + margin), left(x.first - margin), bottom(y.first - margin), stride(cols + margin) {
    const auto cells = static_cast<std::size_t>(stride * (rows + margin));
    for (auto [levels, source] : {std::pair{&values, table}, std::pair{&open, allowed}}) {
      std::vector<std::uint8_t> part(cells, 0);
      for (std::ptrdiff_t row = y.first; row <= y.last; ++row) {
        const std::uint8_t *from = source + row * table_cols;
        std::copy(from + x.first, from + x.last + 1, part.data() + (row - bottom) * stride + margin);
      }
      levels->push_back(std::move(part));
      for (int level = 1; level < count; ++level) {
        levels->push_back(doubled(levels->back(), std::ptrdiff_t{1} << (level - 1)));
      }
    }
  }

  std::vector<std::uint8_t> doubled(const std::vector<std::uint8_t> &from, std::ptrdiff_t step) const {
    std::vector<std::uint8_t> wide(from), out;
    const std::ptrdiff_t height = rows + margin;
    for (std::ptrdiff_t row = 0; row < height; ++row) {
      std::uint8_t *line = wide.data() + row * stride;
      const std::uint8_t *old = from.data() + row * stride;
      for (std::ptrdiff_t col = 0; col + step < stride; ++col) line[col] = std::max(old[col], old[col + step]);
    }
    out = wide;
    for (std::ptrdiff_t row = 0; row + step < height; ++row) {
      std::uint8_t *line = out.data() + row * stride;
      const std::uint8_t *above = wide.data() + (row + step) * stride;
      for (std::ptrdiff_t col = 0; col < stride; ++col) line[col] = std::max(line[col], above[col]);
    }
    return out;
  }
};

// The points seen at one yaw, in cells, in groups of nearly one size.
struct Turned {
  std::vector<std::int32_t> x, y;
  std::vector<std::ptrdiff_t> places;  // in the levels, from the robot's
  Range xs{0, 0}, ys{0, 0};
};

struct Root {
  std::int32_t x, y;  // lower-left cell of the robot
  std::int32_t turn;
  std::int32_t score;  // no pose in it scores more
};

struct Box : Root {
  std::array<std::int32_t, kGroups> sums;  // of the groups up to each
};

struct Found {
  double x, y, yaw;
  std::int32_t score;
};

class Search {
 public:
  Search(const Levels &levels, const std::vector<Turned> &turned, std::size_t points, std::int32_t least, double share,
         double apart_m, double apart_rad, double resolution, std::int64_t most, std::int64_t most_nodes)
      : levels_(levels), turned_(turned), least_(least), share_(share), apart_m_(apart_m), apart_rad_(apart_rad),
        resolution_(resolution), most_(static_cast<std::size_t>(most)), left_(most_nodes) {
    for (std::size_t g = 0; g <= kGroups; ++g) ends_[g] = g * points / kGroups;
  }

  std::vector<double> yaws;
  std::vector<Found> found;
  bool complete = true;

  // Score `kParts` squares of a level: the one at (x, y), or with four also those right of, above, and right above it.
  // `whole` is the box that they are parts of; false if none of them can score what is needed.
  template <int kParts>
  bool score(int level, Box *parts, const Box *whole, std::int32_t needed) const {
    const Turned &turned = turned_[parts[0].turn];
    const std::ptrdiff_t x = parts[0].x - levels_.left, y = parts[0].y - levels_.bottom;
    const bool inside = x + turned.xs.first >= 0 && y + turned.ys.first >= 0 && x + turned.xs.last < levels_.cols &&
                        y + turned.ys.last < levels_.rows;
    return inside ? add<kParts, true>(level, x, y, turned, parts, whole, needed)
                  : add<kParts, false>(level, x, y, turned, parts, whole, needed);
  }

  bool may_stand(int level, std::int32_t x, std::int32_t y) const {
    return levels_.open[level][static_cast<std::size_t>((y - levels_.bottom) * levels_.stride + x - levels_.left)] != 0;
  }

  // What a box must score to matter; a box within one that was found must beat that one.
  std::int32_t needed() const {
    if (found.empty()) return least_;
    std::int32_t limit = std::max(least_, static_cast<std::int32_t>(share_ * found.front().score));
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
    for (int i = 0; i < 4; ++i) {
      static_cast<Root &>(parts[i]) = {box.x + (i & 1) * half, box.y + (i >> 1) * half, box.turn, 0};
    }
    if (!score<4>(level - 1, parts, &box, limit)) return;
    const Box *order[4];
    int count = 0;
    for (const Box &part : parts) {
      if (part.score < limit || part.x > high[0] || part.y > high[1] || !may_stand(level - 1, part.x, part.y)) continue;
      order[count++] = &part;
    }
    std::stable_sort(order, order + count, [](const Box *a, const Box *b) { return a->score > b->score; });
    for (int i = 0; i < count; ++i) branch(*order[i], level - 1, high);
  }

 private:
  template <int kParts, bool kInside>
  bool add(int level, std::ptrdiff_t x, std::ptrdiff_t y, const Turned &turned, Box *parts, const Box *whole,
           std::int32_t needed) const {
    const std::ptrdiff_t right = std::ptrdiff_t{1} << level, above = right * levels_.stride;
    const std::ptrdiff_t at = y * levels_.stride + x;
    const std::uint8_t *values = levels_.values[level].data();
    std::int32_t a = 0, b = 0, c = 0, d = 0;
    for (std::size_t g = 0; g < kGroups; ++g) {
      for (std::size_t i = ends_[g]; i < ends_[g + 1]; ++i) {
        std::ptrdiff_t place = at + turned.places[i];
        if constexpr (!kInside) {  // in the corner of the margin there are zeros
          const auto u = static_cast<std::size_t>(x + turned.x[i]), v = static_cast<std::size_t>(y + turned.y[i]);
          if (u >= static_cast<std::size_t>(levels_.cols) || v >= static_cast<std::size_t>(levels_.rows)) place = 0;
        }
        a += values[place];
        if constexpr (kParts == 4) {
          b += values[place + right];
          c += values[place + above];
          d += values[place + above + right];
        }
      }
      const std::int32_t most = kParts == 4 ? std::max(std::max(a, b), std::max(c, d)) : a;
      const auto left = static_cast<std::int32_t>(ends_[kGroups] - ends_[g + 1]);
      const std::int32_t rest = whole ? whole->score - whole->sums[g] : 255 * left;
      if (most + rest < needed) return false;
      parts[0].sums[g] = a;
      if constexpr (kParts == 4) parts[1].sums[g] = b, parts[2].sums[g] = c, parts[3].sums[g] = d;
    }
    for (int i = 0; i < kParts; ++i) parts[i].score = parts[i].sums[kGroups - 1];
    return true;
  }

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
    const auto worst = static_cast<std::int32_t>(share_ * kept.front().score);
    while (kept.size() > 1 && worst > kept.back().score) kept.pop_back();
    found = std::move(kept);
  }

  const Levels &levels_;
  const std::vector<Turned> &turned_;
  std::array<std::size_t, kGroups + 1> ends_{};
  std::int32_t least_;
  double share_, apart_m_, apart_rad_, resolution_;
  std::size_t most_;
  std::int64_t left_;
};

// The points in cells from the middle of the robot's cell. Neighbours come into different groups, so that each group tells
// of all directions.
Turned turned_points(const In<double, 2> &points, double yaw, double resolution) {
  Turned out;
  const std::size_t count = points.shape(0);
  const double cos = std::cos(yaw), sin = std::sin(yaw);
  for (std::size_t g = 0; g < kGroups; ++g) {
    for (std::size_t i = g; i < count; i += kGroups) {
      const double x = points.data()[2 * i], y = points.data()[2 * i + 1];
      out.x.push_back(static_cast<std::int32_t>(std::floor((cos * x - sin * y) / resolution + 0.5)));
      out.y.push_back(static_cast<std::int32_t>(std::floor((sin * x + cos * y) / resolution + 0.5)));
    }
  }
  const auto [left, right] = std::minmax_element(out.x.begin(), out.x.end());
  const auto [bottom, top] = std::minmax_element(out.y.begin(), out.y.end());
  out.xs = {*left, *right}, out.ys = {*bottom, *top};
  return out;
}

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
    int levels = 1;  // a few roots on each side of a small window: each level costs a pass over the table
    while (levels < kMostLevels && (std::int32_t{4} << levels) <= widest) ++levels;
    const auto turns = static_cast<std::int32_t>(std::max(1.0, std::ceil((w[5] - w[4]) / s[0] + 0.5)));
    std::vector<Turned> turned(static_cast<std::size_t>(turns));
    std::vector<double> yaws;
    Range x{low[0], high[0]}, y{low[1], high[1]};  // what of the table matters
    for (std::int32_t turn = 0; turn < turns; ++turn) {
      const double yaw = w[4] + turn * s[0];
      yaws.push_back(std::remainder(yaw, 2.0 * kPi));
      turned[turn] = turned_points(points, yaw, resolution);
      const Turned &one = turned[turn];
      x = {std::min(x.first, low[0] + one.xs.first), std::max(x.last, high[0] + one.xs.last)};
      y = {std::min(y.first, low[1] + one.ys.first), std::max(y.last, high[1] + one.ys.last)};
    }
    x = {std::max(x.first, 0), std::min(x.last, static_cast<std::int32_t>(cols - 1))};
    y = {std::max(y.first, 0), std::min(y.last, static_cast<std::int32_t>(rows - 1))};
    const Levels pyramid(table.data(), allowed.data(), cols, x, y, levels);
    for (Turned &one : turned) {
      for (std::size_t i = 0; i < one.x.size(); ++i) one.places.push_back(one.y[i] * pyramid.stride + one.x[i]);
    }
    const double count = static_cast<double>(points.shape(0));
    Search search(pyramid, turned, points.shape(0), static_cast<std::int32_t>(std::ceil(s[1] * count)), s[2], s[3], s[4],
                  resolution, most, most_nodes);
    search.yaws = std::move(yaws);
    const int top = levels - 1;
    std::vector<Root> roots;
    const std::int32_t size = std::int32_t{1} << top, least = search.needed();
    for (std::int32_t row = low[1]; row <= high[1]; row += size) {
      for (std::int32_t col = low[0]; col <= high[0]; col += size) {
        if (!search.may_stand(top, col, row)) continue;
        for (std::int32_t turn = 0; turn < turns; ++turn) {
          Box box{{col, row, turn, 0}, {}};
          if (search.score<1>(top, &box, nullptr, least)) roots.push_back(box);
        }
      }
    }
    std::stable_sort(roots.begin(), roots.end(), [](const Root &a, const Root &b) { return a.score > b.score; });
    for (const Root &root : roots) {
      if (root.score < search.needed() || !search.complete) break;
      Box box{root, {}};
      search.score<1>(top, &box, nullptr, 0);  // their sums are not kept: there may be millions of them
      search.branch(box, top, high);
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
