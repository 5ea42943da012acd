// Which hits of a scan are lone, for the kernels that leave them out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace trundle {

// The beams of a scan. Poses of the sensor are rows x, y, yaw: one, or one for each beam (`stride` 3 instead of 0).
struct ScanBeams {
  const double *ranges, *angles, *poses;
  std::size_t stride, count;
};

// Indices of the hits, from `least` to `most`, that neither a beam beside them nor the lidar's scan before has seen.
std::vector<std::int64_t> lone_hits_of(const ScanBeams &scan, const ScanBeams &before, double least, double most);

}  // namespace trundle
