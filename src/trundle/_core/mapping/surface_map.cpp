// Adding, matching and searching on a `SurfaceMap`: see its header.
#include "mapping/surface_map.hpp"

#include <algorithm>
#include <limits>

#include "mapping/small_matrix.hpp"

namespace trundle::mapping {

using localization::check_points;
using localization::check_poses;
using localization::refuse_far;
using localization::refuse_infinite;

namespace {

constexpr std::int64_t kMostPlaces = 16'000'000;

void check_normals(const In<double, 2> &points, const In<double, 2> &normals) {
  check_points(points);
  refuse_unless(normals.shape(0) == points.shape(0) && normals.shape(1) == 2, "each point needs a normal, shape (N, 2)");
  for (std::size_t i = 0; i < normals.size(); ++i) {
    refuse_unless(std::abs(normals.data()[i]) <= 1.001, "normals must be of length 1, or 0");
  }
}

}  // namespace

void SurfaceMap::grow(std::int64_t x, std::int64_t y) {
  const std::int64_t pad = 8;
  const std::int64_t left = wide_ ? std::min(left_, x - pad) : x - pad, bottom = high_ ? std::min(bottom_, y - pad) : y - pad;
  const std::int64_t right = wide_ ? std::max(left_ + wide_, x + pad) : x + pad;
  const std::int64_t top = high_ ? std::max(bottom_ + high_, y + pad) : y + pad;
  refuse_unless((right - left) <= kMostPlaces && (top - bottom) <= kMostPlaces && (right - left) * (top - bottom) <= kMostPlaces,
                "the surfaces are too far apart");
  std::vector<std::int32_t> places(static_cast<std::size_t>((right - left) * (top - bottom)), -1);
  for (std::int64_t row = 0; row < high_; ++row) {
    std::copy_n(places_.data() + row * wide_, wide_, places.data() + (row + bottom_ - bottom) * (right - left) + left_ - left);
  }
  places_ = std::move(places);
  left_ = left, bottom_ = bottom, wide_ = right - left, high_ = top - bottom;
}

SurfaceMap::Tile &SurfaceMap::make(std::int64_t col, std::int64_t row) {
  const std::int64_t x = floor_div(col), y = floor_div(row);
  if (x < left_ || y < bottom_ || x >= left_ + wide_ || y >= bottom_ + high_) grow(x, y);
  std::int32_t &index = places_[static_cast<std::size_t>((y - bottom_) * wide_ + x - left_)];
  if (index < 0) {
    index = static_cast<std::int32_t>(tiles_.size());
    tiles_.emplace_back();
  }
  return tiles_[static_cast<std::size_t>(index)];
}

void SurfaceMap::add(In<double, 2> points, In<double, 2> normals, In<double, 1> pose, int sign) {
  check_normals(points, normals);
  refuse_unless(pose.shape(0) == 3, "a pose has 3 numbers");
  refuse_far(pose.data(), 3, "the pose must be finite and within 10,000 km");
  refuse_unless(sign == 1 || sign == -1, "points are added (1) or taken away (-1)");
  nb::gil_scoped_release release;
  const double *p = pose.data(), cos = std::cos(p[2]), sin = std::sin(p[2]);
  for (std::size_t i = 0; i < points.shape(0); ++i) {
    const double x = points.data()[2 * i], y = points.data()[2 * i + 1];
    const double u = (p[0] + cos * x - sin * y) / cell_, v = (p[1] + sin * x + cos * y) / cell_;
    const auto col = static_cast<std::int64_t>(std::floor(u)), row = static_cast<std::int64_t>(std::floor(v));
    Tile &tile = make(col, row);
    tile.here[slot(col, row)] += sign;
    const double a = normals.data()[2 * i], b = normals.data()[2 * i + 1];
    if (a != 0.0 || b != 0.0) {
      const double nx = cos * a - sin * b, ny = sin * a + cos * b;
      Cell &cell = tile.cells[slot(col, row) * kSides + static_cast<std::size_t>(side_of(nx, ny))];
      cell.count += sign;
      cell.x += sign * static_cast<std::int32_t>(std::lround((u - static_cast<double>(col)) * kPerCell));
      cell.y += sign * static_cast<std::int32_t>(std::lround((v - static_cast<double>(row)) * kPerCell));
      cell.nx += sign * static_cast<std::int32_t>(std::lround(nx * 1000.0));
      cell.ny += sign * static_cast<std::int32_t>(std::lround(ny * 1000.0));
    }
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      for (std::int64_t dx = -1; dx <= 1; ++dx) {
        make(col + dx, row + dy).near[slot(col + dx, row + dy)] += sign;
      }
    }
  }
}

SurfaceMap::Value SurfaceMap::value(double x, double y, double nx, double ny) const {
  const double u = x / cell_, v = y / cell_, reach2 = (kReach + 0.5) * (kReach + 0.5);
  const auto col = static_cast<std::int64_t>(std::floor(u)), row = static_cast<std::int64_t>(std::floor(v));
  // Its own quarter of directions, and the one that it is nearest to.
  const auto first = static_cast<std::size_t>(side_of(nx, ny));
  const auto second = static_cast<std::size_t>(
      std::abs(nx) >= std::abs(ny) ? (ny >= 0.0 ? 1 : 3) : (nx >= 0.0 ? 0 : 2));
  Value sum{0.0, 0.0, 0.0, 0.0};
  for (std::int64_t r = row - kReach; r <= row + kReach; ++r) {
    const Tile *tile = nullptr;
    std::int64_t last = std::numeric_limits<std::int64_t>::max();
    for (std::int64_t c = col - kReach; c <= col + kReach; ++c) {
      if (floor_div(c) != last) last = floor_div(c), tile = find(c, r);
      if (!tile || !tile->here[slot(c, r)]) continue;
      for (const std::size_t side : {first, second}) {
        const Cell &cell = tile->cells[slot(c, r) * kSides + side];
        if (cell.count <= 0) continue;
        const double count = cell.count, mx = static_cast<double>(c) + cell.x / (kPerCell * count),
                     my = static_cast<double>(r) + cell.y / (kPerCell * count);
        const double dx = u - mx, dy = v - my, d2 = dx * dx + dy * dy;
        if (d2 >= reach2) continue;
        const double length = std::hypot(static_cast<double>(cell.nx), static_cast<double>(cell.ny));
        if (length < 500.0 * count) continue;
        const double ax = cell.nx / length, ay = cell.ny / length;
        if (ax * nx + ay * ny < 0.7) continue;
        const double near = 1.0 - d2 / reach2, weight = near * near * std::min(count, 10.0);
        sum.distance += weight * (ax * dx + ay * dy);
        sum.nx += weight * ax;
        sum.ny += weight * ay;
        sum.weight += weight;
      }
    }
  }
  if (sum.weight > 1e-3) {
    sum.distance *= cell_ / sum.weight;
    const double length = std::hypot(sum.nx, sum.ny);
    sum.nx /= length, sum.ny /= length;
  } else {
    sum.weight = 0.0;
  }
  return sum;
}

nb::tuple SurfaceMap::match(In<double, 2> points, In<double, 2> normals, In<double, 2> starts, In<double, 1> prior,
                            In<double, 2> covariance, In<double, 1> settings) const {
  check_normals(points, normals);
  check_poses(starts);
  refuse_unless(prior.shape(0) == 3, "a prior has 3 numbers");
  refuse_far(prior.data(), 3, "the prior must be finite");
  refuse_unless(covariance.shape(0) == 3 && covariance.shape(1) == 3, "a covariance has shape (3, 3)");
  refuse_infinite(covariance.data(), 9, "the covariance must be finite");
  refuse_unless(settings.shape(0) == 5, "there are 5 settings: first width, last width, noise, most beams, iterations");
  const double *s = settings.data();
  for (int i = 0; i < 4; ++i) refuse_unless(s[i] >= 1e-4 && s[i] <= 1e6, "the settings must be from 0.0001 to a million");
  refuse_unless(s[4] >= 1.0 && s[4] <= 1000.0, "there must be from 1 to 1000 iterations");
  Matrix3 known, given;
  std::copy_n(covariance.data(), 9, given.begin());
  refuse_unless(invert(given, known), "the covariance must be positive definite");
  const std::size_t count = starts.shape(0), beams = points.shape(0);
  std::vector<double> poses(starts.data(), starts.data() + 3 * count), found(9 * count), told(4 * count, 0.0);
  {
    nb::gil_scoped_release release;
    for (std::size_t k = 0; k < count; ++k) {
      double *pose = poses.data() + 3 * k, width = std::max(s[0], s[1]);
      Matrix3 total{}, scan{};
      for (int done = 0;; ++done) {
        scan = Matrix3{};
        std::array<double, 3> gradient{};
        double weights = 0.0, squares = 0.0, asked = 0.0, met = 0.0;
        const double cos = std::cos(pose[2]), sin = std::sin(pose[2]), w2 = width * width;
        for (std::size_t i = 0; i < beams; ++i) {
          const double a = normals.data()[2 * i], b = normals.data()[2 * i + 1];
          if (a == 0.0 && b == 0.0) continue;
          asked += 1.0;
          const double x = points.data()[2 * i], y = points.data()[2 * i + 1];
          const double px = cos * x - sin * y, py = sin * x + cos * y;
          const Value at = value(pose[0] + px, pose[1] + py, cos * a - sin * b, sin * a + cos * b);
          if (at.weight <= 0.0) continue;
          met += 1.0;
          const double share = w2 / (w2 + at.distance * at.distance), weight = share * share;
          const double j[3] = {at.nx, at.ny, at.ny * px - at.nx * py};
          for (int r = 0; r < 3; ++r) {
            for (int c = 0; c <= r; ++c) scan[3 * r + c] += weight * j[r] * j[c];
            gradient[r] += weight * j[r] * at.distance;
          }
          weights += weight;
          squares += weight * at.distance * at.distance;
        }
        scan[1] = scan[3], scan[2] = scan[6], scan[5] = scan[7];
        const double scale = weights > 0.0 ? std::min(1.0, s[3] / weights) / (s[2] * s[2]) : 0.0;
        for (int i = 0; i < 9; ++i) total[i] = scale * scan[i] + known[i];
        told[4 * k] = asked > 0.0 ? weights / asked : 0.0;
        told[4 * k + 1] = weights > 0.0 ? std::sqrt(squares / weights) : 0.0;
        told[4 * k + 2] = asked > 0.0 ? met / asked : 0.0;
        told[4 * k + 3] = done;
        if (done >= static_cast<int>(s[4])) break;
        const double off[3] = {pose[0] - prior.data()[0], pose[1] - prior.data()[1],
                               std::remainder(pose[2] - prior.data()[2], 2.0 * kPi)};
        std::array<double, 3> right{}, step{};
        for (int r = 0; r < 3; ++r) {
          right[r] = -scale * gradient[r];
          for (int c = 0; c < 3; ++c) right[r] -= known[3 * r + c] * off[c];
        }
        if (!solve(total, right, step)) break;
        const double most = std::max({std::abs(step[0]) / 0.3, std::abs(step[1]) / 0.3, std::abs(step[2]) / 0.3, 1.0});
        for (int i = 0; i < 3; ++i) pose[i] += step[i] / most;
        const bool small = std::abs(step[0]) < 2e-4 && std::abs(step[1]) < 2e-4 && std::abs(step[2]) < 5e-5;
        if (small && width <= s[1]) break;
        width = std::max(s[1], 0.6 * width);
      }
      pose[2] = std::remainder(pose[2], 2.0 * kPi);
      Matrix3 spread;
      if (!invert(total, spread)) spread = given;
      std::copy(spread.begin(), spread.end(), found.begin() + static_cast<std::ptrdiff_t>(9 * k));
    }
  }
  return nb::make_tuple(to_numpy(std::move(poses), {count, 3}), to_numpy(std::move(found), {count, 3, 3}),
                        to_numpy(std::move(told), {count, 4}));
}

nb::tuple SurfaceMap::search(In<double, 2> points, In<double, 1> centre, In<double, 1> reach,
                             In<double, 1> sigmas) const {
  check_points(points);
  refuse_unless(centre.shape(0) == 3 && reach.shape(0) == 3 && sigmas.shape(0) == 2,
                "a centre has 3 numbers, a reach 3 (metres, radians, step of yaw), and there are 2 sigmas");
  refuse_far(centre.data(), 3, "the centre must be finite");
  const double *c = centre.data(), *r = reach.data(), *s = sigmas.data();
  refuse_unless(r[0] >= 0.0 && r[0] <= 100.0 * cell_ && r[1] >= 0.0 && r[1] <= 3.2 && r[2] >= 1e-3,
                "a search reaches up to 100 cells and half a turn, in steps of at least 0.001 rad");
  refuse_unless(s[0] > 0.0 && s[1] > 0.0, "the sigmas must be above 0");
  std::vector<double> best{c[0], c[1], c[2]};
  double top = -1.0, plain = 0.0;
  {
    nb::gil_scoped_release release;
    const auto steps = static_cast<std::int64_t>(std::ceil(r[0] / cell_));
    const auto turns = static_cast<std::int64_t>(std::ceil(r[1] / r[2]));
    const std::size_t count = points.shape(0);
    std::vector<std::int64_t> cols(count), rows(count);
    for (std::int64_t turn = -turns; turn <= turns; ++turn) {
      const double yaw = c[2] + static_cast<double>(turn) * r[2], cos = std::cos(yaw), sin = std::sin(yaw);
      for (std::size_t i = 0; i < count; ++i) {
        const double x = points.data()[2 * i], y = points.data()[2 * i + 1];
        cols[i] = static_cast<std::int64_t>(std::floor((c[0] + cos * x - sin * y) / cell_));
        rows[i] = static_cast<std::int64_t>(std::floor((c[1] + sin * x + cos * y) / cell_));
      }
      for (std::int64_t dy = -steps; dy <= steps; ++dy) {
        for (std::int64_t dx = -steps; dx <= steps; ++dx) {
          std::int64_t sum = 0;
          for (std::size_t i = 0; i < count; ++i) {
            const Tile *tile = find(cols[i] + dx, rows[i] + dy);
            if (!tile) continue;
            const std::size_t at = slot(cols[i] + dx, rows[i] + dy);
            sum += tile->here[at] ? 2 : tile->near[at] ? 1 : 0;
          }
          const double mx = static_cast<double>(dx) * cell_ / s[0], my = static_cast<double>(dy) * cell_ / s[0];
          const double mt = static_cast<double>(turn) * r[2] / s[1];
          const double score = static_cast<double>(sum) / (2.0 * static_cast<double>(std::max<std::size_t>(count, 1)));
          const double judged = score - 0.01 * (mx * mx + my * my + mt * mt);
          if (judged > top) {
            top = judged, plain = score;
            best = {c[0] + static_cast<double>(dx) * cell_, c[1] + static_cast<double>(dy) * cell_, yaw};
          }
        }
      }
    }
  }
  return nb::make_tuple(to_numpy(std::move(best), {3}), plain);
}

nb::tuple SurfaceMap::table(double resolution) const {
  const auto stride = static_cast<std::int64_t>(std::lround(resolution / cell_));
  refuse_unless(stride >= 1 && stride <= 16 && std::abs(stride * cell_ - resolution) < 1e-9,
                "a table's cells are 1 to 16 of the map's");
  std::vector<std::uint8_t> out(1, 0);
  std::int64_t cols = 1, rows = 1, left = 0, bottom = 0;
  {
    nb::gil_scoped_release release;
    std::int64_t low[2] = {INT64_MAX, INT64_MAX}, high[2] = {INT64_MIN, INT64_MIN};
    const auto each = [&](auto &&take) {
      for (std::int64_t y = 0; y < high_; ++y) {
        for (std::int64_t x = 0; x < wide_; ++x) {
          const std::int32_t index = places_[static_cast<std::size_t>(y * wide_ + x)];
          if (index < 0) continue;
          const Tile &tile = tiles_[static_cast<std::size_t>(index)];
          for (std::int64_t i = 0; i < kEdge * kEdge; ++i) {
            const auto at = static_cast<std::size_t>(i);
            if (tile.near[at]) take((x + left_) * kEdge + i % kEdge, (y + bottom_) * kEdge + i / kEdge, tile.here[at] > 0);
          }
        }
      }
    };
    each([&](std::int64_t col, std::int64_t row, bool) {
      low[0] = std::min(low[0], col), low[1] = std::min(low[1], row);
      high[0] = std::max(high[0], col), high[1] = std::max(high[1], row);
    });
    if (low[0] <= high[0]) {
      left = low[0], bottom = low[1];
      cols = (high[0] - left) / stride + 1, rows = (high[1] - bottom) / stride + 1;
      out.assign(static_cast<std::size_t>(cols * rows), 0);
      each([&](std::int64_t col, std::int64_t row, bool here) {
        std::uint8_t &value = out[static_cast<std::size_t>((row - bottom) / stride * cols + (col - left) / stride)];
        value = std::max<std::uint8_t>(value, here ? 255 : 128);
      });
    }
  }
  std::vector<double> corner{static_cast<double>(left) * cell_, static_cast<double>(bottom) * cell_};
  return nb::make_tuple(to_numpy(std::move(out), {static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)}),
                        to_numpy(std::move(corner), {2}));
}

}  // namespace trundle::mapping
