// Array types of the kernels' arguments and results.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace trundle {

namespace nb = nanobind;

// A C-contiguous array that is only read; nanobind refuses another dtype, rank or layout before the kernel runs.
template <typename T, int Rank>
using In = nb::ndarray<const T, nb::ndim<Rank>, nb::c_contig, nb::device::cpu>;

// A map's cells (−1 unknown, 0 free, 100 occupied) that a kernel changes in place.
using Cells = nb::ndarray<std::int8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// Hand a vector to NumPy without a copy; the array owns it.
template <typename T>
nb::ndarray<nb::numpy, T> to_numpy(std::vector<T> &&values, std::initializer_list<std::size_t> shape) {
  auto owned = std::make_unique<std::vector<T>>(std::move(values));
  T *data = owned->data();
  nb::capsule owner(owned.release(), [](void *p) noexcept { delete static_cast<std::vector<T> *>(p); });
  return nb::ndarray<nb::numpy, T>(data, shape, owner);
}

}  // namespace trundle
