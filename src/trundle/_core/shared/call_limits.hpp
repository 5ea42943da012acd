// When a call from Python gives up: its deadline, its cancel flag, and Ctrl-C.
#pragma once

#include <nanobind/stl/optional.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "shared/arrays.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

using Flag = std::optional<In<std::uint8_t, 1>>;

// The limits of one call: its deadline, the flag's byte, and signals that wait for Python, such as that of Ctrl-C.
// Their handlers run now and then while the call has released the GIL. As another thread that has the GIL may wait for
// a lock of this search, no lock is waited for with the GIL held.
class CallLimits {
 public:
  CallLimits(const std::optional<double> &seconds, const Flag &cancel) : interrupt_(run_handlers) {
    limits_.interrupt = &interrupt_;
    if (cancel && cancel->size() > 0) limits_.cancel = cancel->data();
    if (seconds) {
      const std::chrono::duration<double> most(std::min(*seconds, 1e9));
      limits_.deadline =
          std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(most);
    }
  }
  operator const SearchLimits &() const { return limits_; }

  // With the GIL held again: throws what a handler raised.
  void rethrow() const {
    if (interrupt_.happened()) throw nb::python_error();
  }

 private:
  static bool run_handlers() {
    nb::gil_scoped_acquire held;
    return PyErr_CheckSignals() != 0;
  }

  Interrupt interrupt_;
  SearchLimits limits_;
};

}  // namespace trundle
