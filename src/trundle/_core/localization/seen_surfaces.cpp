// Where lidars see the surfaces of a map: a mean distance for each patch of surface, of what is seen from what is drawn.
//
// A point belongs to the patch at its foot, which is the nearest point of the map's surface: the point less its distance
// along the field's slope.
#include "localization/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "localization/checks.hpp"
#include "localization/field_view.hpp"

namespace trundle {

using namespace localization;

namespace {

struct Seen {
  std::size_t patch;
  double distance;
};

// The patches of points seen from a pose, and the points' distances.
class Patches {
 public:
  Patches(const In<float, 2> &field, double resolution, double limit, const double *pose, double edge, std::size_t rows,
          std::size_t cols)
      : view_{field.data(), static_cast<std::ptrdiff_t>(field.shape(0)), static_cast<std::ptrdiff_t>(field.shape(1)),
              1.0 / resolution, limit},
        x_(pose[0]), y_(pose[1]), cos_(std::cos(pose[2])), sin_(std::sin(pose[2])), per_metre_(1.0 / edge),
        rows_(rows), cols_(cols) {}

  Seen of(const double *point) const {
    const double x = x_ + cos_ * point[0] - sin_ * point[1], y = y_ + sin_ * point[0] + cos_ * point[1];
    const Slope slope = view_.at(x, y);
    const std::size_t col = within((x - slope.value * slope.x) * per_metre_, cols_);
    const std::size_t row = within((y - slope.value * slope.y) * per_metre_, rows_);
    return {row * cols_ + col, slope.value};
  }

 private:
  static std::size_t within(double cell, std::size_t count) {
    return cell > 0.0 ? static_cast<std::size_t>(std::min(cell, static_cast<double>(count - 1))) : 0;
  }

  FieldView view_;
  double x_, y_, cos_, sin_, per_metre_;
  std::size_t rows_, cols_;
};

template <typename Table>
void check_surfaces(double resolution, const In<double, 2> &points, const In<double, 1> &pose, const Table &counts,
                    const Table &means, double edge) {
  check_resolution(resolution);
  check_points(points);
  refuse_unless(pose.shape(0) == 3, "a pose has 3 numbers");
  refuse_far(pose.data(), 3, "the pose must be finite and within 10,000 km");
  refuse_unless(counts.shape(0) > 0 && counts.shape(1) > 0 && counts.shape(0) == means.shape(0) &&
                    counts.shape(1) == means.shape(1),
                "counts and means need one shape, and cells");
  refuse_unless(edge >= 1e-3 && edge <= 1e4, "patches must be from 1 mm to 10 km");
}

}  // namespace

Floats expect_surfaces(In<float, 2> field, double resolution, double limit, In<double, 2> points, In<double, 1> pose,
                       In<float, 2> counts, In<float, 2> means, double edge, double offset, In<double, 1> settings) {
  check_surfaces(resolution, points, pose, counts, means, edge);
  refuse_unless(settings.shape(0) == 5, "there are 5 settings: deepest, least, rise, believed, half after");
  refuse_far(settings.data(), 5, "the settings must be finite");
  refuse_far(&offset, 1, "the offset must be finite");
  const double deepest = settings.data()[0], least = settings.data()[1], rise = settings.data()[2],
               believed = settings.data()[3], half_after = settings.data()[4];
  refuse_unless(rise >= 1e-6 && half_after >= 1e-6, "rise and half after must be above 0");
  const std::size_t count = points.shape(0);
  std::vector<double> out(count, offset);
  {
    nb::gil_scoped_release release;
    const Patches patches(field, resolution, limit, pose.data(), edge, counts.shape(0), counts.shape(1));
    for (std::size_t i = 0; i < count; ++i) {
      const Seen seen = patches.of(points.data() + 2 * i);
      if (!(std::abs(seen.distance) < deepest)) continue;
      const double taken = counts.data()[seen.patch], apart = means.data()[seen.patch] - offset;
      const double share = std::clamp((std::abs(apart) - least) / rise, 0.0, 1.0);
      out[i] = offset + believed * taken / (taken + half_after) * share * apart;
    }
  }
  return to_numpy(std::move(out), {count});
}

void learn_surfaces(In<float, 2> field, double resolution, double limit, In<double, 2> points, In<double, 1> pose,
                    Table counts, Table means, double edge, double deepest, double most) {
  check_surfaces(resolution, points, pose, counts, means, edge);
  refuse_unless(most >= 1.0 && most <= 1e6, "the mean must be of 1 to a million scans");
  nb::gil_scoped_release release;
  const Patches patches(field, resolution, limit, pose.data(), edge, counts.shape(0), counts.shape(1));
  std::vector<std::pair<std::size_t, std::size_t>> order;  // patch and point: of a patch the last one counts
  std::vector<double> distances(points.shape(0));
  order.reserve(distances.size());
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const Seen seen = patches.of(points.data() + 2 * i);
    distances[i] = seen.distance;
    if (std::abs(seen.distance) < deepest) order.emplace_back(seen.patch, i);
  }
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto [patch, point] = order[k];
    if (k + 1 < order.size() && order[k + 1].first == patch) continue;
    float &count = counts.data()[patch], &mean = means.data()[patch];
    count = std::min(count + 1.0f, static_cast<float>(most));
    mean = static_cast<float>(mean + (distances[point] - mean) / count);
  }
}

}  // namespace trundle
