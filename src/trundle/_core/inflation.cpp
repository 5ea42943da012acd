#include "arrays.hpp"

namespace trundle {

static nb::ndarray<nb::numpy, std::uint8_t> inflate(In<std::uint8_t, 2> cells) {
  std::vector<std::uint8_t> out(cells.data(), cells.data() + cells.size());
  return to_numpy(std::move(out), {cells.shape(0), cells.shape(1)});
}

}  // namespace trundle

void bind_inflation(nanobind::module_ &m) { m.def("inflate", &trundle::inflate); }
