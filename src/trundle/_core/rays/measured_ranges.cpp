// What a lidar says of the distances along its beams.
#include <limits>
#include <stdexcept>
#include <vector>

#include "rays/kernels.hpp"

namespace trundle {

nb::ndarray<nb::numpy, double> measure_ranges(In<double, 1> distances, In<double, 1> noise, double deviation,
                                              double range_min, double range_max) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::size_t count = distances.shape(0);
  const bool is_noisy = noise.shape(0) > 0;
  if (is_noisy && noise.shape(0) != count) throw std::invalid_argument("there must be a number for each beam, or none");
  std::vector<double> ranges(count);
  {
    nb::gil_scoped_release released;
    for (std::size_t i = 0; i < count; ++i) {
      const double distance = distances.data()[i], error = is_noisy ? noise.data()[i] * deviation : 0.0;
      const double read = distance + error, least = read < range_min ? range_min : read;
      const double kept = least > range_max ? range_max : least;
      ranges[i] = distance > range_max ? kInfinity : kept;
    }
  }
  return to_numpy(std::move(ranges), {count});
}

}  // namespace trundle
