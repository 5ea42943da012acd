// Exact capped Euclidean inflation: from occupancy to cost bytes in one pass over the map.
//
// The distance to the nearest blocked cell separates (Felzenszwalb & Huttenlocher 2012, section 2): first down and up
// every column, then the smallest dx² + vertical² along every row. As the radius is capped, the row step is a plain
// minimum over 2·radius + 1 shifted rows, which vectorises, and rows of cells far from everything are skipped.
#include "arrays.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define TRUNDLE_AVX2 1
#endif

namespace trundle {

namespace {

constexpr std::uint8_t kLethal = 254;
constexpr std::uint8_t kUnknown = 255;
constexpr int kBlock = 64;

struct Job {
  const std::int8_t *occupancy;
  std::uint8_t *costs;
  std::ptrdiff_t rows, cols;
  int radius;                 // cells along one axis: floor(sqrt(limit))
  std::uint32_t limit;        // largest squared distance that has a cost
  const std::uint8_t *table;  // cost by squared distance, limit + 2 entries, the last one 0
};

inline __attribute__((always_inline)) bool is_blocked(std::int8_t value) { return value < 0 || value >= 100; }

// Vertical is the type of a column distance (up to radius + 1), Squared that of a squared distance.
template <typename Vertical, typename Squared>
inline __attribute__((always_inline)) void inflate_all(const Job &job) {
  const std::ptrdiff_t rows = job.rows, cols = job.cols;
  const auto far = static_cast<Vertical>(job.radius + 1);
  // More than the limit, and no overflow when the largest dx² is added.
  const auto beyond = static_cast<Squared>(sizeof(Squared) == 2 ? 65535 - job.radius * job.radius : 0x3fffffff);

  std::vector<Vertical> below(static_cast<std::size_t>(rows) * cols);  // distance to the nearest blocked cell below
  for (std::ptrdiff_t r = 0; r < rows; ++r) {
    const std::int8_t *occupancy = job.occupancy + r * cols;
    Vertical *here = below.data() + r * cols;
    if (r == 0) {
      for (std::ptrdiff_t c = 0; c < cols; ++c) here[c] = is_blocked(occupancy[c]) ? Vertical{0} : far;
      continue;
    }
    const Vertical *previous = here - cols;
    for (std::ptrdiff_t c = 0; c < cols; ++c) {
      const auto next = static_cast<Vertical>(previous[c] + (previous[c] < far ? 1 : 0));
      here[c] = is_blocked(occupancy[c]) ? Vertical{0} : next;
    }
  }

  const std::ptrdiff_t blocks = (cols + kBlock - 1) / kBlock;
  const std::ptrdiff_t reach = (job.radius + kBlock - 1) / kBlock;
  const std::ptrdiff_t margin = job.radius;
  std::vector<Squared> padded(static_cast<std::size_t>(blocks * kBlock + 2 * margin), beyond);
  std::vector<Vertical> above(static_cast<std::size_t>(cols), far);
  std::vector<std::uint8_t> near(static_cast<std::size_t>(blocks));
  Squared *squares = padded.data() + margin;

  for (std::ptrdiff_t r = rows - 1; r >= 0; --r) {
    const std::int8_t *occupancy = job.occupancy + r * cols;
    const Vertical *lower = below.data() + r * cols;
    std::uint8_t *out = job.costs + r * cols;
    for (std::ptrdiff_t c = 0; c < cols; ++c) {
      const auto up = static_cast<Vertical>(above[c] + (above[c] < far ? 1 : 0));
      above[c] = std::min(up, lower[c]);  // `lower` is 0 on a blocked cell; a nearer one below stays nearer going up
    }
    for (std::ptrdiff_t c = 0; c < cols; ++c) {
      const Vertical vertical = above[c];
      squares[c] = vertical < far ? static_cast<Squared>(static_cast<Squared>(vertical) * vertical) : beyond;
    }
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::ptrdiff_t first = b * kBlock, last = std::min(first + kBlock, cols);
      Vertical smallest = far;
      for (std::ptrdiff_t c = first; c < last; ++c) smallest = std::min(smallest, above[c]);
      near[b] = smallest < far;
    }
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::ptrdiff_t first = b * kBlock, last = std::min(first + kBlock, cols);
      bool any = false;
      for (std::ptrdiff_t n = std::max<std::ptrdiff_t>(0, b - reach); n <= std::min(blocks - 1, b + reach); ++n) {
        any = any || near[n];
      }
      if (!any) {
        std::fill(out + first, out + last, std::uint8_t{0});
        continue;
      }
      Squared best[kBlock];
      for (int i = 0; i < kBlock; ++i) best[i] = squares[first + i];
      for (int dx = 1; dx <= job.radius; ++dx) {
        const auto across = static_cast<Squared>(dx * dx);
        const Squared *left = squares + first - dx, *right = squares + first + dx;
        for (int i = 0; i < kBlock; ++i) {
          const auto nearer = static_cast<Squared>(std::min(left[i], right[i]) + across);
          best[i] = std::min(best[i], nearer);
        }
        if ((dx & 3) == 0) {
          Squared largest = 0;
          for (int i = 0; i < kBlock; ++i) largest = std::max(largest, best[i]);
          if (largest <= across) break;  // no cell further to the side can be nearer
        }
      }
      const auto none = static_cast<Squared>(job.limit + 1);
      for (std::ptrdiff_t c = first; c < last; ++c) {
        const std::uint8_t cost = job.table[std::min(best[c - first], none)];
        out[c] = occupancy[c] < 0 ? kUnknown : occupancy[c] >= 100 ? kLethal : cost;
      }
    }
  }
}

// Up to here 181² and 180² together fit into 16 bits.
constexpr int kNarrowRadius = 180;

void inflate_portable(const Job &job) {
  if (job.radius <= kNarrowRadius) {
    inflate_all<std::uint8_t, std::uint16_t>(job);
  } else {
    inflate_all<std::uint16_t, std::uint32_t>(job);
  }
}

#ifdef TRUNDLE_AVX2
__attribute__((target("avx2"))) void inflate_avx2(const Job &job) {
  if (job.radius <= kNarrowRadius) {
    inflate_all<std::uint8_t, std::uint16_t>(job);
  } else {
    inflate_all<std::uint16_t, std::uint32_t>(job);
  }
}
#endif

}  // namespace

static nb::ndarray<nb::numpy, std::uint8_t> inflate(In<std::int8_t, 2> occupancy, In<std::uint8_t, 1> table) {
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

void bind_inflation(nanobind::module_ &m) {
  namespace nb = nanobind;
  m.def("inflate", &trundle::inflate, nb::arg("occupancy").noconvert(), nb::arg("table").noconvert());
}
