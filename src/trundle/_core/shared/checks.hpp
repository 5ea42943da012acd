// Checks of kernels' arguments.
#pragma once

#include "shared/arrays.hpp"

#include <cmath>
#include <cstddef>

namespace trundle {

// Raise a ValueError unless something holds.
inline void require(bool holds, const char *what) {
  if (!holds) throw nb::value_error(what);
}

// Whether all numbers are finite, and below `most`.
template <typename Array>
bool is_finite(const Array &values, double most = 1e9) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(std::abs(values.data()[i]) < most)) return false;
  }
  return true;
}

}  // namespace trundle
