// Which beams of a scan an update uses, and where they ended: evenly many over all that met something, each placed by the
// motion of the robot at the time of the beam. Every update does this for each lidar, so it is one pass.
#include "localization/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "localization/checks.hpp"

namespace trundle {

using namespace localization;

nb::tuple pick_beams(In<double, 1> ranges, In<double, 1> angles, In<double, 1> mount, In<double, 2> poses,
                     In<double, 2> body, double shortest, double longest, std::int64_t most, double offset) {
  const std::size_t count = ranges.shape(0);
  refuse_unless(angles.shape(0) == count && count < 1'000'000'000, "each range needs an angle");
  refuse_unless(mount.shape(0) == 3, "a mount has 3 numbers: x, y, yaw");
  refuse_far(mount.data(), 3, "the mount must be finite and within 10,000 km");
  check_poses(poses);
  refuse_unless(poses.shape(0) == 2, "there are 2 poses, at the first and at the last beam");
  refuse_unless(body.shape(1) == 3, "the body needs shape (M, 3): normals, and how far it reaches along them");
  refuse_unless(most >= 1 && offset >= 0.0 && offset < 1.0, "at least 1 beam, and an offset from 0 to 1");
  std::vector<double> points, sensors;
  {
    nb::gil_scoped_release release;
    longest = std::min(longest, kFar);
    std::vector<std::uint32_t> hits;
    hits.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {  // NaN and infinity fail both
      if (ranges.data()[i] >= shortest && ranges.data()[i] < longest) hits.push_back(static_cast<std::uint32_t>(i));
    }
    const std::size_t kept = std::min(hits.size(), static_cast<std::size_t>(most));
    const double step = static_cast<double>(hits.size()) / static_cast<double>(most);
    points.reserve(2 * kept);
    sensors.reserve(2 * kept);
    const double *m = mount.data(), *first = poses.data(), *last = first + 3, *side = body.data();
    const bool moves = !std::equal(first, last, last);
    const double per_beam = 1.0 / static_cast<double>(count > 1 ? count - 1 : 1);
    const double turned = std::remainder(last[2] - first[2], 2.0 * 3.14159265358979323846);
    double at[3] = {first[0], first[1], first[2]}, cos = std::cos(at[2]), sin = std::sin(at[2]);
    for (std::size_t k = 0; k < kept; ++k) {
      std::size_t i = k;
      if (hits.size() > kept) i = std::min(hits.size() - 1, static_cast<std::size_t>((static_cast<double>(k) + offset) * step));
      i = hits[i];
      const double range = ranges.data()[i], angle = angles.data()[i] + m[2];
      const double x = m[0] + range * std::cos(angle), y = m[1] + range * std::sin(angle);
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      bool within = body.shape(0) > 0;
      for (std::size_t j = 0; j < body.shape(0) && within; ++j) {
        within = x * side[3 * j] + y * side[3 * j + 1] <= side[3 * j + 2];
      }
      if (within) continue;
      if (moves) {
        const double share = static_cast<double>(i) * per_beam;
        for (int j = 0; j < 2; ++j) at[j] = first[j] + share * (last[j] - first[j]);
        at[2] = first[2] + share * turned;
        cos = std::cos(at[2]), sin = std::sin(at[2]);
      }
      points.push_back(at[0] + cos * x - sin * y);
      points.push_back(at[1] + sin * x + cos * y);
      sensors.push_back(at[0] + cos * m[0] - sin * m[1]);
      sensors.push_back(at[1] + sin * m[0] + cos * m[1]);
    }
  }
  const std::size_t taken = points.size() / 2;
  return nb::make_tuple(to_numpy(std::move(points), {taken, 2}), to_numpy(std::move(sensors), {taken, 2}));
}

}  // namespace trundle
