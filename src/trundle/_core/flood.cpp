// Flood fill, 4-connected, row span by row span: which unknown cells of a map can be reached.
//
// Eight cells are looked at together wherever they are alike.
#include "arrays.hpp"

#include <cstring>
#include <stdexcept>

namespace trundle {

using Cells = nb::ndarray<std::int8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

static constexpr std::int8_t kUnknown = -1, kFree = 0, kVisited = 1;

static constexpr std::uint64_t kOnes = 0x0101010101010101ULL;

static std::uint64_t eight(const std::int8_t *cells) {
  std::uint64_t word;
  std::memcpy(&word, cells, sizeof word);
  return word;
}

static std::uint64_t repeated(std::int8_t value) { return kOnes * static_cast<std::uint8_t>(value); }

// The first of [at, end) that is not `value`.
static const std::int8_t *skip(const std::int8_t *at, const std::int8_t *end, std::int8_t value) {
  while (end - at >= 8 && eight(at) == repeated(value)) at += 8;
  while (at < end && *at == value) ++at;
  return at;
}

// The first of [at, end) that is `value`. A word has a byte of 0 where (w - 1…1) & ~w & 128…128 is not 0.
static const std::int8_t *find(const std::int8_t *at, const std::int8_t *end, std::int8_t value) {
  for (; end - at >= 8; at += 8) {
    const std::uint64_t word = eight(at) ^ repeated(value);
    if ((word - kOnes) & ~word & (kOnes << 7)) break;
  }
  while (at < end && *at != value) ++at;
  return at;
}

// Go back from `at` over cells that are `value`, to `begin` at most; returns the first of them.
static const std::int8_t *skip_back(const std::int8_t *at, const std::int8_t *begin, std::int8_t value) {
  while (at - begin >= 8 && eight(at - 8) == repeated(value)) at -= 8;
  while (at > begin && at[-1] == value) --at;
  return at;
}

// Turn the `from` cells around `start` into `to`; return how many.
static std::int64_t flood(std::int8_t *cells, std::int64_t rows, std::int64_t cols, std::int64_t start,
                          std::int8_t from, std::int8_t to, std::vector<std::int64_t> &stack) {
  std::int64_t count = 0;
  stack.assign(1, start);
  while (!stack.empty()) {
    const std::int64_t index = stack.back();
    stack.pop_back();
    if (cells[index] != from) continue;
    const std::int64_t row = index / cols;
    const std::int8_t *begin = cells + row * cols;
    const std::int64_t left = skip_back(cells + index, begin, from) - cells;
    const std::int64_t right = skip(cells + index, begin + cols, from) - cells;
    std::memset(cells + left, to, static_cast<std::size_t>(right - left));
    count += right - left;
    for (const std::int64_t step : {-cols, cols}) {
      if (step < 0 ? row == 0 : row + 1 == rows) continue;
      const std::int8_t *end = cells + right + step;
      for (const std::int8_t *at = find(cells + left + step, end, from); at < end; at = find(skip(at, end, from), end, from))
        stack.push_back(at - cells);
    }
  }
  return count;
}

// Unknown cells that are joined to a seed become free; return how many.
static std::int64_t flood_free(Cells cells, In<std::int64_t, 2> seeds) {
  const auto rows = static_cast<std::int64_t>(cells.shape(0)), cols = static_cast<std::int64_t>(cells.shape(1));
  if (seeds.shape(1) != 2) throw std::invalid_argument("seeds need shape (N, 2): row, col");
  for (std::size_t i = 0; i < seeds.shape(0); ++i)
    if (seeds(i, 0) < 0 || seeds(i, 0) >= rows || seeds(i, 1) < 0 || seeds(i, 1) >= cols)
      throw std::invalid_argument("a seed lies outside the grid");
  nb::gil_scoped_release released;
  std::vector<std::int64_t> stack;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < seeds.shape(0); ++i)
    count += flood(cells.data(), rows, cols, seeds(i, 0) * cols + seeds(i, 1), kUnknown, kFree, stack);
  return count;
}

// The largest area of unknown cells becomes free; return how many, 0 where there is none.
static std::int64_t flood_largest(Cells cells) {
  const auto rows = static_cast<std::int64_t>(cells.shape(0)), cols = static_cast<std::int64_t>(cells.shape(1));
  nb::gil_scoped_release released;
  std::int8_t *data = cells.data();
  const std::int8_t *end = data + rows * cols;
  std::vector<std::int64_t> stack;
  std::int64_t largest = 0, seed = 0;
  // An area that is still to come begins where it is found first, so it is no larger than what is left of the map.
  for (const std::int8_t *at = find(data, end, kUnknown); at < end && end - at > largest; at = find(at, end, kUnknown)) {
    const std::int64_t count = flood(data, rows, cols, at - data, kUnknown, kVisited, stack);
    if (count > largest) {
      largest = count;
      seed = at - data;
    }
  }
  if (largest > 0) flood(data, rows, cols, seed, kVisited, kFree, stack);
  for (std::int8_t *cell = data; cell < end; ++cell) *cell = *cell == kVisited ? kUnknown : *cell;
  return largest;
}

}  // namespace trundle

void bind_flood(nanobind::module_ &m) {
  m.def("flood_free", &trundle::flood_free, nanobind::arg("cells"), nanobind::arg("seeds"));
  m.def("flood_largest", &trundle::flood_largest, nanobind::arg("cells"));
}
