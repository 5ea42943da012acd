// Flood fill, 4-connected, row span by row span: which unknown cells of a map can be reached.
//
// Eight cells are read together wherever they are alike.
#include "regions/kernels.hpp"
#include "regions/runs.hpp"

#include <cstring>
#include <stdexcept>

namespace trundle {

static constexpr std::int8_t kUnknown = -1, kFree = 0;

static constexpr std::uint64_t kOnes = 0x0101010101010101ULL;

static std::uint64_t eight(const std::int8_t *cells) {
  std::uint64_t word;
  std::memcpy(&word, cells, sizeof word);
  return word;
}

static std::uint64_t repeated(std::int8_t value) { return kOnes * static_cast<std::uint8_t>(value); }

// How many bytes lie in memory before the first that has a bit set in a word that is not 0; 0 where that is not known.
static int bytes_before(std::uint64_t word) {
#if defined(__GNUC__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
  return __builtin_ctzll(word) / 8;
#else
  (void)word;
  return 0;
#endif
}

// The first of [at, end) that is not `value`.
static const std::int8_t *skip(const std::int8_t *at, const std::int8_t *end, std::int8_t value) {
  for (; end - at >= 8; at += 8)
    if (const std::uint64_t word = eight(at) ^ repeated(value)) {
      at += bytes_before(word);
      break;
    }
  while (at < end && *at == value) ++at;
  return at;
}

// The first of [at, end) that is `value`. A word's first byte of 0 is the first one set in (w - 1…1) & ~w & 128…128.
static const std::int8_t *find(const std::int8_t *at, const std::int8_t *end, std::int8_t value) {
  for (; end - at >= 8; at += 8) {
    const std::uint64_t word = eight(at) ^ repeated(value);
    if (const std::uint64_t zeros = (word - kOnes) & ~word & (kOnes << 7)) {
      at += bytes_before(zeros);
      break;
    }
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

namespace {

// A run of cells that is to be looked for in a row: somewhere in [begin, end).
struct Window {
  std::int64_t row, begin, end;
  std::int64_t back;  // The row that it was seen from, -1 or 1 rows away, all of whose window is done.
};

}  // namespace

// Turn the `from` cells around `start` into `to`; return how many. (Heckbert, A Seed Fill Algorithm, Graphics Gems
// 1990: of the row that a run was seen from, only the part beyond the run there is scanned again.)
static std::int64_t flood(std::int8_t *cells, std::int64_t rows, std::int64_t cols, std::int64_t start,
                          std::int8_t from, std::int8_t to, std::vector<Window> &stack) {
  if (cells[start] != from) return 0;
  std::int64_t count = 0;
  stack.assign(1, {start / cols, start % cols, start % cols + 1, 0});
  while (!stack.empty()) {
    const Window window = stack.back();
    stack.pop_back();
    const std::int8_t *line = cells + window.row * cols, *last = line + window.end;
    const auto look = [&](std::int64_t step, std::int64_t begin, std::int64_t end) {
      const std::int64_t row = window.row + step;
      if (begin < end && row >= 0 && row < rows) stack.push_back({row, begin, end, -step});
    };
    for (const std::int8_t *at = find(line + window.begin, last, from); at < last;) {
      const std::int64_t left = skip_back(at, line, from) - line, right = skip(at, line + cols, from) - line;
      std::memset(cells + window.row * cols + left, to, static_cast<std::size_t>(right - left));
      count += right - left;
      for (const std::int64_t step : {-1, 1}) {
        if (step != window.back) {
          look(step, left, right);
        } else {
          look(step, left, window.begin);
          look(step, window.end, right);
        }
      }
      at = right < window.end ? find(line + right, last, from) : last;
    }
  }
  return count;
}

std::int64_t flood_free(Cells cells, In<std::int64_t, 2> seeds) {
  const auto rows = static_cast<std::int64_t>(cells.shape(0)), cols = static_cast<std::int64_t>(cells.shape(1));
  if (seeds.shape(1) != 2) throw std::invalid_argument("seeds need shape (N, 2): row, col");
  for (std::size_t i = 0; i < seeds.shape(0); ++i)
    if (seeds(i, 0) < 0 || seeds(i, 0) >= rows || seeds(i, 1) < 0 || seeds(i, 1) >= cols)
      throw std::invalid_argument("a seed lies outside the grid");
  nb::gil_scoped_release released;
  std::vector<Window> stack;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < seeds.shape(0); ++i)
    count += flood(cells.data(), rows, cols, seeds(i, 0) * cols + seeds(i, 1), kUnknown, kFree, stack);
  return count;
}

// Call `visit` with each run of unknown cells, in the order of the memory.
template <typename Visit>
static void each_run(const std::int8_t *cells, std::int64_t rows, std::int64_t cols, Visit visit) {
  for (std::int64_t row = 0; row < rows; ++row) {
    const std::int8_t *line = cells + row * cols, *end = line + cols;
    for (const std::int8_t *at = find(line, end, kUnknown); at < end;) {
      const std::int8_t *next = skip(at, end, kUnknown);
      visit(Run{row, at - line, next - line});
      at = find(next, end, kUnknown);
    }
  }
}

// Row by row: following each area through the map would fetch its cells from memory again and again.
std::int64_t flood_largest(Cells cells) {
  const auto rows = static_cast<std::int64_t>(cells.shape(0)), cols = static_cast<std::int64_t>(cells.shape(1));
  nb::gil_scoped_release released;
  RunForest forest;
  std::vector<Run> here, above;
  std::size_t first = 0, at = 0;  // Of the row above: the number of its first run, and how many are passed.
  std::vector<std::int64_t> counts;
  each_run(cells.data(), rows, cols, [&](const Run &run) {
    if (here.empty() || here.back().row != run.row) {
      above.swap(here);
      if (!above.empty() && above.back().row + 1 != run.row) above.clear();
      here.clear();
      first = forest.size() - above.size();
      at = 0;
    }
    forest.add(run, above.data(), above.size(), first, at, 0);
    here.push_back(run);
    counts.push_back(run.end - run.begin);
  });
  std::int32_t largest = -1;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto own = static_cast<std::int32_t>(i), root = forest.root(own);
    if (root != own) counts[root] += counts[i];
  }
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (forest.root(static_cast<std::int32_t>(i)) == static_cast<std::int32_t>(i) && (largest < 0 || counts[i] > counts[largest]))
      largest = static_cast<std::int32_t>(i);
  if (largest < 0) return 0;
  std::int32_t number = 0;
  each_run(cells.data(), rows, cols, [&](const Run &run) {
    if (forest.root(number++) == largest)
      std::memset(cells.data() + run.row * cols + run.begin, kFree, static_cast<std::size_t>(run.end - run.begin));
  });
  return counts[largest];
}

}  // namespace trundle
