// A particle filter's three steps: motion (Thrun, Burgard and Fox 2005, table 5.6), weights by a table of the map
// (likelihood fields, table 6.3), and resampling with as many particles as their spread needs (Fox 2001, KLD sampling).
// Random numbers are hashed counters, so the same seed gives the same particles on any machine and in any thread.
#include "localization/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <vector>

#include "localization/checks.hpp"
#include "mppi/draws.hpp"

namespace trundle {

using namespace localization;

namespace {

// The sum of four numbers of 16 bits, which is nearly normal: mean 0, variance 1, within ±3.5. One hash is enough for it:
// particles are resampled, and nobody looks at their tails.
double normal(std::uint64_t start, std::uint64_t index) {
  std::int32_t sum = -2 * 65535;
  for (std::uint64_t bits = mppi::hashed(start + index), k = 0; k < 4; ++k, bits >>= 16) {
    sum += static_cast<std::int32_t>(bits & 0xffff);
  }
  return static_cast<double>(sum) * (1.7320508075688772 / 65536.0);
}

}  // namespace

Floats move_particles(In<double, 2> particles, In<double, 1> motion, In<double, 1> alphas, In<double, 1> least,
                      std::uint64_t seed) {
  check_poses(particles);
  refuse_unless(motion.shape(0) == 3, "a motion has 3 numbers: turn, distance, turn");
  refuse_unless(alphas.shape(0) == 4, "there are 4 alphas");
  refuse_unless(least.shape(0) == 2, "the least noise has 2 numbers: metres and radians");
  refuse_far(motion.data(), 3, "the motion must be finite");
  refuse_far(alphas.data(), 4, "the alphas must be finite");
  refuse_far(least.data(), 2, "the least noise must be finite");
  for (int i = 0; i < 4; ++i) refuse_unless(alphas.data()[i] >= 0.0, "the alphas must be at least 0");
  for (int i = 0; i < 2; ++i) refuse_unless(least.data()[i] >= 0.0, "the least noise must be at least 0");
  const std::size_t count = particles.shape(0);
  std::vector<double> out(3 * count);
  {
    nb::gil_scoped_release release;
    const double first = motion.data()[0], along = motion.data()[1], second = motion.data()[2];
    const double *a = alphas.data();
    // A robot that drives backwards turns by little, not by half a turn and back (as in Nav2).
    const auto turn = [](double angle) {
      const double pi = 3.14159265358979323846;
      const double wrapped = std::remainder(angle, 2.0 * pi);
      return std::min(std::abs(wrapped), std::abs(std::remainder(angle - pi, 2.0 * pi)));
    };
    const double t1 = turn(first), t2 = turn(second);
    const double first_std = std::sqrt(a[0] * t1 * t1 + a[1] * along * along);
    const double second_std = std::sqrt(a[0] * t2 * t2 + a[1] * along * along + least.data()[1] * least.data()[1]);
    const double along_std = std::sqrt(a[2] * along * along + a[3] * (t1 * t1 + t2 * t2));
    const std::uint64_t start = mppi::hashed(seed + 1);
    for (std::size_t i = 0; i < count; ++i) {
      const double *from = particles.data() + 3 * i;
      const auto draw = [&](std::uint64_t k) { return normal(start, 5 * i + k); };
      const double heading = from[2] + first + first_std * draw(0);
      const double driven = along + along_std * draw(1);
      out[3 * i] = from[0] + driven * std::cos(heading) + least.data()[0] * draw(2);
      out[3 * i + 1] = from[1] + driven * std::sin(heading) + least.data()[0] * draw(3);
      out[3 * i + 2] = std::remainder(heading + second + second_std * draw(4),
                                      2.0 * 3.14159265358979323846);
    }
  }
  return to_numpy(std::move(out), {count, 3});
}

Floats weigh_particles(In<float, 2> table, double resolution, double outside, In<double, 2> particles,
                       In<double, 2> points) {
  check_resolution(resolution);
  check_poses(particles);
  check_points(points);
  const std::size_t count = particles.shape(0), beams = points.shape(0);
  std::vector<double> out(count);
  {
    nb::gil_scoped_release release;
    const auto rows = static_cast<double>(table.shape(0)), cols = static_cast<double>(table.shape(1));
    const double per_metre = 1.0 / resolution;
    const float *values = table.data();
    const std::size_t width = table.shape(1);
    std::vector<double> scaled(2 * beams);
    for (std::size_t k = 0; k < 2 * beams; ++k) scaled[k] = points.data()[k] * per_metre;
    for (std::size_t i = 0; i < count; ++i) {
      const double *pose = particles.data() + 3 * i;
      const double cos = std::cos(pose[2]), sin = std::sin(pose[2]);
      const double x = pose[0] * per_metre, y = pose[1] * per_metre;
      double sum = 0.0;
      for (std::size_t k = 0; k < beams; ++k) {
        const double u = x + cos * scaled[2 * k] - sin * scaled[2 * k + 1];
        const double v = y + sin * scaled[2 * k] + cos * scaled[2 * k + 1];
        if (u >= 0.0 && v >= 0.0 && u < cols && v < rows) {
          sum += values[static_cast<std::size_t>(static_cast<std::int64_t>(v)) * width +
                        static_cast<std::size_t>(static_cast<std::int64_t>(u))];
        } else {
          sum += outside;
        }
      }
      out[i] = sum;
    }
  }
  return to_numpy(std::move(out), {count});
}

Floats peak_particle(In<double, 2> particles, In<double, 1> weights, double metres, double radians) {
  check_poses(particles);
  const std::size_t count = particles.shape(0);
  refuse_unless(count > 0 && weights.shape(0) == count, "each particle needs a weight, and there must be particles");
  for (std::size_t i = 0; i < count; ++i) {
    refuse_unless(weights.data()[i] >= 0.0 && weights.data()[i] <= 1e100, "weights must be at least 0");
  }
  refuse_unless(metres >= 0.0 && radians >= 0.0, "the distances must be at least 0");
  std::vector<double> out(3);
  {
    nb::gil_scoped_release release;
    const double *w = weights.data(), *peak = particles.data() + 3 * (std::max_element(w, w + count) - w);
    double total = 0.0, turned = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double *one = particles.data() + 3 * i;
      const double dx = one[0] - peak[0], dy = one[1] - peak[1];
      if (!(dx * dx + dy * dy <= metres * metres)) continue;
      const double turn = std::remainder(one[2] - peak[2], 2.0 * 3.14159265358979323846);
      if (std::abs(turn) > radians) continue;
      total += w[i];
      out[0] += w[i] * dx;
      out[1] += w[i] * dy;
      turned += w[i] * turn;
    }
    const double share = total > 0.0 ? 1.0 / total : 0.0;
    out[0] = peak[0] + share * out[0];
    out[1] = peak[1] + share * out[1];
    out[2] = peak[2] + share * turned;
  }
  return to_numpy(std::move(out), {3});
}

namespace {

// Indices that systematic resampling draws: `count` equal steps through the sums of weights, from a random start.
template <typename Take>
void draw_systematic(const std::vector<double> &sums, std::size_t count, double start, Take take) {
  std::size_t index = 0;
  const double step = sums.back() / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + start) * step;
    while (index + 1 < sums.size() && sums[index] <= at) ++index;
    take(index);
  }
}

double uniform(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>(mppi::hashed(mppi::hashed(seed + 1) + index) >> 11) * 0x1.0p-53;
}

}  // namespace

Floats resample_particles(In<double, 2> particles, In<double, 1> weights, In<double, 1> bins, In<double, 1> bound,
                          std::uint64_t seed) {
  check_poses(particles);
  const std::size_t count = particles.shape(0);
  refuse_unless(count > 0 && weights.shape(0) == count, "each particle needs a weight, and there must be particles");
  refuse_unless(bins.shape(0) == 2, "bins have 2 sizes: metres and radians");
  refuse_unless(bound.shape(0) == 4, "the bound has 4 numbers: least, most, error, quantile");
  for (int i = 0; i < 2; ++i) refuse_unless(bins.data()[i] >= 1e-3 && bins.data()[i] <= 1e6, "bins must be at least 0.001");
  const double *b = bound.data();
  refuse_unless(b[0] >= 1.0 && b[1] >= b[0] && b[1] <= 1e6, "there must be from 1 to a million particles");
  refuse_unless(b[2] > 0.0 && b[2] <= 1e6 && std::abs(b[3]) <= 1e3, "error and quantile must be numbers in range");
  std::vector<double> sums(count);
  double total = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    refuse_unless(weights.data()[i] >= 0.0 && weights.data()[i] <= 1e100, "weights must be at least 0");
    sums[i] = total += weights.data()[i];
  }
  refuse_unless(total > 0.0, "a weight must be above 0");
  std::vector<double> out;
  {
    nb::gil_scoped_release release;
    const double *from = particles.data();
    // The bins of a sample of the largest size say how many particles are needed (Fox 2001, equation 7).
    std::unordered_set<std::uint64_t> taken;
    std::size_t last = count;
    draw_systematic(sums, static_cast<std::size_t>(b[1]), uniform(seed, 0), [&](std::size_t index) {
      if (index == last) return;
      last = index;
      const double *p = from + 3 * index;
      const auto bin = [](double value, double size) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / size))) & 0x1fffff;
      };
      taken.insert(bin(p[0], bins.data()[0]) << 42 | bin(p[1], bins.data()[0]) << 21 | bin(p[2], bins.data()[1]));
    });
    double needed = b[0];
    if (taken.size() > 1) {
      const double k = static_cast<double>(taken.size() - 1), c = 2.0 / (9.0 * k);
      const double root = 1.0 - c + std::sqrt(c) * b[3];
      needed = std::clamp(std::ceil(k / (2.0 * b[2]) * root * root * root), b[0], b[1]);
    }
    out.reserve(3 * static_cast<std::size_t>(needed));
    draw_systematic(sums, static_cast<std::size_t>(needed), uniform(seed, 1), [&](std::size_t index) {
      out.insert(out.end(), from + 3 * index, from + 3 * index + 3);
    });
  }
  const std::size_t drawn = out.size() / 3;
  return to_numpy(std::move(out), {drawn, 3});
}

}  // namespace trundle
