// The row filters of PNG undone (PNG specification, section 9): each byte is a difference from its left, upper or
// upper-left neighbour.
#include "images/kernels.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace trundle {

static std::uint8_t paeth(int left, int above, int corner) {
  const int estimate = left + above - corner;
  const int to_left = std::abs(estimate - left), to_above = std::abs(estimate - above),
            to_corner = std::abs(estimate - corner);
  if (to_left <= to_above && to_left <= to_corner) return static_cast<std::uint8_t>(left);
  return static_cast<std::uint8_t>(to_above <= to_corner ? above : corner);
}

// `step` is the distance in bytes to the left neighbour.
static void unfilter_row(std::uint8_t kind, const std::uint8_t *in, const std::uint8_t *above, std::uint8_t *out,
                         std::size_t size, std::size_t step) {
  for (std::size_t i = 0; i < size; ++i) {
    const int left = i < step ? 0 : out[i - step];
    const int up = above ? above[i] : 0;
    const int corner = above && i >= step ? above[i - step] : 0;
    int guess = 0;
    switch (kind) {
      case 1: guess = left; break;
      case 2: guess = up; break;
      case 3: guess = (left + up) / 2; break;
      case 4: guess = paeth(left, up, corner); break;
      default: break;
    }
    out[i] = static_cast<std::uint8_t>(in[i] + guess);
  }
}

nb::ndarray<nb::numpy, std::uint8_t> png_unfilter(In<std::uint8_t, 2> lines, std::size_t step) {
  const std::size_t rows = lines.shape(0), width = lines.shape(1);
  if (width < 1 || step < 1) throw std::invalid_argument("png_unfilter needs rows with a filter byte and a step of at least 1");
  const std::size_t size = width - 1;
  std::vector<std::uint8_t> out(rows * size);
  {
    nb::gil_scoped_release released;
    const std::uint8_t *in = lines.data();
    for (std::size_t row = 0; row < rows; ++row) {
      const std::uint8_t kind = in[row * width];
      if (kind > 4) throw std::invalid_argument("row filter " + std::to_string(kind) + " in row " + std::to_string(row));
      const std::uint8_t *above = row ? out.data() + (row - 1) * size : nullptr;
      unfilter_row(kind, in + row * width + 1, above, out.data() + row * size, size, step);
    }
  }
  return to_numpy(std::move(out), {rows, size});
}

}  // namespace trundle
