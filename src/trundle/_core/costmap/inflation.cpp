// Exact capped Euclidean inflation: from occupancy to cost bytes in one pass over the map.
//
// The distance to the nearest blocked cell separates (Felzenszwalb & Huttenlocher 2012, section 2): first down and up
// every column, then the smallest dx² + vertical² along every row. As the radius is capped, the row step is a plain
// minimum over 2·radius + 1 shifted rows, which vectorises, and rows of cells far from everything are skipped.
#include "costmap/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "shared/registers.hpp"

namespace trundle {

namespace {

constexpr std::uint8_t kLethal = 254;
constexpr int kBlock = 64;

struct Job {
  const std::int8_t *occupancy;
  std::uint8_t *costs;
  std::ptrdiff_t rows, cols;
  int radius;                 // cells along one axis: floor(sqrt(limit))
  std::uint32_t limit;        // largest squared distance that has a cost
  const std::uint8_t *table;  // cost by squared distance, limit + 2 entries, the first one 254, the last 0
};

// Unknown (negative, from 128 on without the sign) or occupied.
inline __attribute__((always_inline)) bool is_blocked(std::int8_t value) {
  return static_cast<std::uint8_t>(value) >= 100;
}

// As many squared distances as fit into a register of so many bytes.
template <typename Squared, int kBytes>
struct Lanes {
  static constexpr int kCount = kBytes / sizeof(Squared);
  typedef Squared Vector __attribute__((vector_size(kBytes)));
};

template <typename Vector, typename Squared>
inline __attribute__((always_inline)) void load(Vector &lanes, const Squared *from) {
  std::memcpy(&lanes, from, sizeof lanes);
}

// Smallest dx² + square over the row, dx up to the radius, for kBlock cells from `squares` on.
template <int kBytes, typename Squared>
inline __attribute__((always_inline)) void nearest_in_row(const Squared *squares, int radius, Squared *nearest) {
  using Vector = typename Lanes<Squared, kBytes>::Vector;
  constexpr int kLanes = Lanes<Squared, kBytes>::kCount, kGroup = 2;
  for (int part = 0; part < kBlock; part += kGroup * kLanes) {
    Vector best[kGroup];
    for (int v = 0; v < kGroup; ++v) load(best[v], squares + part + v * kLanes);
    for (int dx = 1; dx <= radius; ++dx) {
      const auto across = static_cast<Squared>(dx * dx);
      for (int v = 0; v < kGroup; ++v) {
        Vector left, right;
        load(left, squares + part + v * kLanes - dx);
        load(right, squares + part + v * kLanes + dx);
        const Vector nearer = (left < right ? left : right) + across;
        best[v] = nearer < best[v] ? nearer : best[v];
      }
      if ((dx & 7) == 0) {
        Squared values[kGroup * kLanes], largest = 0;
        std::memcpy(values, best, sizeof values);
        for (int lane = 0; lane < kGroup * kLanes; ++lane) largest = std::max(largest, values[lane]);
        if (largest <= across) break;  // no cell further to the side can be nearer
      }
    }
    for (int v = 0; v < kGroup; ++v) std::memcpy(nearest + part + v * kLanes, &best[v], sizeof best[v]);
  }
}

// Blocked cells have the cost of distance 0, which is 254; unknown ones become 255.
inline __attribute__((always_inline)) void mark_unknown(const std::int8_t *__restrict occupancy,
                                                        const std::uint8_t *__restrict costs, std::ptrdiff_t count,
                                                        std::uint8_t *__restrict out) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    out[i] = static_cast<std::uint8_t>(costs[i] | (occupancy[i] < 0 ? 0xff : 0));
  }
}

// Distance to the nearest blocked cell at or below each cell of a column, up to radius + 1.
template <typename Vertical>
inline __attribute__((always_inline)) void sweep_up(const Job &job, Vertical *below) {
  const auto far = static_cast<Vertical>(job.radius + 1);
  const std::ptrdiff_t rows = job.rows, cols = job.cols;
  for (std::ptrdiff_t r = 0; r < rows; ++r) {
    const std::int8_t *__restrict occupancy = job.occupancy + r * cols;
    Vertical *__restrict here = below + r * cols;
    if (r == 0) {
      for (std::ptrdiff_t c = 0; c < cols; ++c) here[c] = is_blocked(occupancy[c]) ? Vertical{0} : far;
      continue;
    }
    const Vertical *__restrict previous = here - cols;
    for (std::ptrdiff_t c = 0; c < cols; ++c) {
      const auto next = static_cast<Vertical>(previous[c] + (previous[c] < far ? 1 : 0));
      here[c] = is_blocked(occupancy[c]) ? Vertical{0} : next;
    }
  }
}

// Vertical is the type of a column distance (up to radius + 1), Squared that of a squared distance. `below` may be the
// memory of the costs: a row's distances are read before its costs are written, and not again.
template <int kBytes, typename Vertical, typename Squared>
inline __attribute__((always_inline)) void inflate_all(const Job &job, Vertical *below) {
  // Copied, as a write of costs could change what a pointer shows.
  const std::ptrdiff_t rows = job.rows, cols = job.cols;
  const int radius = job.radius;
  const std::uint8_t *__restrict table = job.table;
  const auto far = static_cast<Vertical>(radius + 1);  // (radius + 1)² is above the limit
  sweep_up(job, below);

  const std::ptrdiff_t blocks = (cols + kBlock - 1) / kBlock;
  const std::ptrdiff_t reach = (radius + kBlock - 1) / kBlock;
  std::vector<Vertical> column(static_cast<std::size_t>(blocks * kBlock), far);
  std::vector<Squared> padded(static_cast<std::size_t>(blocks * kBlock + 2 * radius),
                              static_cast<Squared>(static_cast<Squared>(far) * far));
  std::vector<std::uint8_t> near(static_cast<std::size_t>(blocks));
  Vertical *__restrict vertical = column.data();
  Squared *__restrict squares = padded.data() + radius;
  const auto none = static_cast<Squared>(job.limit + 1);

  for (std::ptrdiff_t r = rows - 1; r >= 0; --r) {
    const std::int8_t *occupancy = job.occupancy + r * cols;
    const Vertical *__restrict lower = below + r * cols;
    for (std::ptrdiff_t c = 0; c < cols; ++c) {
      const auto up = static_cast<Vertical>(vertical[c] + (vertical[c] < far ? 1 : 0));
      vertical[c] = std::min(up, lower[c]);
    }
    for (std::ptrdiff_t c = 0; c < cols; ++c) {
      squares[c] = static_cast<Squared>(static_cast<Squared>(vertical[c]) * vertical[c]);
    }
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      Vertical smallest = far;
      for (int i = 0; i < kBlock; ++i) smallest = std::min(smallest, vertical[b * kBlock + i]);
      near[b] = smallest < far;
    }
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::ptrdiff_t first = b * kBlock, last = std::min(first + kBlock, cols);
      std::uint8_t *out = job.costs + r * cols + first;
      bool any = false;
      for (std::ptrdiff_t n = std::max<std::ptrdiff_t>(0, b - reach); n <= std::min(blocks - 1, b + reach); ++n) {
        any = any || near[n];
      }
      if (!any) {
        std::fill(out, out + (last - first), std::uint8_t{0});
        continue;
      }
      Squared nearest[kBlock];
      std::uint8_t costs[kBlock];
      nearest_in_row<kBytes>(squares + first, radius, nearest);
      for (int i = 0; i < kBlock; ++i) nearest[i] = std::min(nearest[i], none);
      for (int i = 0; i < kBlock; ++i) costs[i] = table[nearest[i]];
      if (last - first == kBlock) {
        mark_unknown(occupancy + first, costs, kBlock, out);
      } else {
        mark_unknown(occupancy + first, costs, last - first, out);
      }
    }
  }
}

// Up to here 181² and 180² together fit into 16 bits.
constexpr int kNarrowRadius = 180;

template <int kBytes>
inline __attribute__((always_inline)) void inflate_any(const Job &job) {
  if (job.radius <= kNarrowRadius) {
    inflate_all<kBytes, std::uint8_t, std::uint16_t>(job, job.costs);
  } else {
    std::vector<std::uint16_t> below(static_cast<std::size_t>(job.rows * job.cols));
    inflate_all<kBytes, std::uint16_t, std::uint32_t>(job, below.data());
  }
}

void inflate_portable(const Job &job) { inflate_any<16>(job); }

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") void inflate_avx2(const Job &job) { inflate_any<32>(job); }
#endif

}  // namespace

nb::ndarray<nb::numpy, std::uint8_t> inflate(In<std::int8_t, 2> occupancy, In<std::uint8_t, 1> table) {
  const auto entries = static_cast<std::int64_t>(table.size());
  if (entries < 1) throw std::invalid_argument("the cost table needs an entry for distance 0");
  auto radius = static_cast<std::int64_t>(std::sqrt(static_cast<double>(entries - 1)));
  while (radius * radius > entries - 1) --radius;
  while ((radius + 1) * (radius + 1) <= entries - 1) ++radius;
  if (radius > 16000) throw std::invalid_argument("the cost table reaches further than 16000 cells");
  const std::size_t rows = occupancy.shape(0), cols = occupancy.shape(1);
  std::vector<std::uint8_t> costs(rows * cols);
  {
    nb::gil_scoped_release release;
    std::vector<std::uint8_t> lookup(table.data(), table.data() + entries);
    lookup.push_back(0);
    lookup[0] = kLethal;
    const Job job{occupancy.data(),
                  costs.data(),
                  static_cast<std::ptrdiff_t>(rows),
                  static_cast<std::ptrdiff_t>(cols),
                  static_cast<int>(radius),
                  static_cast<std::uint32_t>(entries - 1),
                  lookup.data()};
    if (rows > 0 && cols > 0) {
#ifdef TRUNDLE_AVX2
      if (__builtin_cpu_supports("avx2")) {
        inflate_avx2(job);
      } else {
        inflate_portable(job);
      }
#else
      inflate_portable(job);
#endif
    }
  }
  return to_numpy(std::move(costs), {rows, cols});
}

}  // namespace trundle
