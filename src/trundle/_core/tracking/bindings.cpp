// `ScanTracker` as Python sees it. Calls of several threads wait for each other.
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "shared/arrays.hpp"
#include "tracking/followed.hpp"

namespace trundle {
namespace {

using namespace tracking;

void refuse_unless(bool good, const char *message) {
  if (!good) throw std::invalid_argument(message);
}

void refuse_infinite(const double *numbers, std::size_t count, const char *message) {
  for (std::size_t i = 0; i < count; ++i) refuse_unless(std::isfinite(numbers[i]), message);
}

Settings settings_of(const In<double, 1> &given) {
  refuse_unless(given.shape(0) == 9, "a tracker needs 9 settings");
  const double *s = given.data();
  refuse_infinite(s, 9, "the settings must be finite");
  for (int i = 0; i < 9; ++i) refuse_unless(s[i] >= 0.0, "the settings must be at least 0");
  refuse_unless(s[2] >= 1.0, "min_points must be at least 1");
  return {s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8]};
}

std::vector<Point> outline_of(const In<double, 2> &given) {
  refuse_unless(given.shape(1) == 2, "the body needs shape (N, 2)");
  refuse_infinite(given.data(), given.size(), "the body must be finite");
  std::vector<Point> outline;
  for (std::size_t i = 0; i < given.shape(0); ++i) outline.push_back({given.data()[2 * i], given.data()[2 * i + 1]});
  return outline;
}

class LockedTracker {
 public:
  LockedTracker(In<double, 1> settings, In<double, 2> body) : tracker_(settings_of(settings), outline_of(body)) {}

  void see(std::int64_t lidar, double time, In<double, 1> ranges, In<double, 1> angles, In<double, 2> poses,
           In<double, 1> sensor) {
    const std::size_t count = ranges.shape(0);
    refuse_unless(angles.shape(0) == count, "a scan needs as many ranges as angles");
    refuse_unless(poses.shape(1) == 3 && (poses.shape(0) == 1 || (poses.shape(0) == count && count > 0)),
                  "the sensor needs one pose (x, y, yaw), or one for each beam");
    refuse_unless(sensor.shape(0) == 5, "the sensor needs 5 numbers: x, y, yaw in base_link, range_min, range_max");
    refuse_infinite(angles.data(), count, "the angles must be finite");
    refuse_infinite(poses.data(), poses.size(), "the poses must be finite");
    refuse_infinite(sensor.data(), 5, "the sensor's numbers must be finite");
    refuse_infinite(&time, 1, "the time must be finite");
    const double *s = sensor.data();
    const Scan scan{time,  ranges.data(), angles.data(), count, poses.data(), poses.shape(0),
                    s[0], s[1],          s[2],          s[3],  s[4]};
    nb::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    tracker_.see(lidar, scan);
  }

  nb::tuple tracks(double now) {
    refuse_infinite(&now, 1, "the time must be finite");
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::size_t count = tracker_.tracks().size();
    std::vector<std::int64_t> ids;
    std::vector<std::uint8_t> flags;
    std::vector<double> states, covariances;
    for (const Followed &track : tracker_.tracks()) {
      const DiscFilter filter = tracker_.ahead(track, now);
      ids.push_back(track.id);
      flags.insert(flags.end(), {track.confirmed, track.moving});
      states.insert(states.end(), filter.state, filter.state + 4);
      states.push_back(filter.radius);
      covariances.insert(covariances.end(), &filter.cov[0][0], &filter.cov[0][0] + 16);
    }
    return nb::make_tuple(to_numpy(std::move(ids), {count}), to_numpy(std::move(flags), {count, 2}),
                          to_numpy(std::move(states), {count, 5}), to_numpy(std::move(covariances), {count, 4, 4}));
  }

 private:
  std::mutex mutex_;
  ScanTracker tracker_;
};

}  // namespace
}  // namespace trundle

void bind_tracking(nanobind::module_ &m) {
  namespace nb = nanobind;
  using nb::arg;
  nb::class_<trundle::LockedTracker>(m, "ScanTracker")
      .def(nb::init<trundle::In<double, 1>, trundle::In<double, 2>>(), arg("settings").noconvert(),
           arg("body").noconvert())
      .def("see", &trundle::LockedTracker::see, arg("lidar"), arg("time"), arg("ranges").noconvert(),
           arg("angles").noconvert(), arg("poses").noconvert(), arg("sensor").noconvert())
      .def("tracks", &trundle::LockedTracker::tracks, arg("now"));
}
