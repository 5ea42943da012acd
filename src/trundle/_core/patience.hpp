// From Python's arguments to when a search is to give up.
#pragma once

#include <nanobind/stl/optional.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "arrays.hpp"
#include "grid_steps.hpp"

namespace trundle {

using Flag = std::optional<In<std::uint8_t, 1>>;

// The moment that is so many seconds away, and the flag's byte.
inline Patience patience_of(const std::optional<double> &seconds, const Flag &cancel) {
  Patience patience;
  if (cancel && cancel->size() > 0) patience.cancel = cancel->data();
  if (seconds) {
    const std::chrono::duration<double> most(std::min(*seconds, 1e9));
    patience.deadline =
        std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(most);
  }
  return patience;
}

}  // namespace trundle
