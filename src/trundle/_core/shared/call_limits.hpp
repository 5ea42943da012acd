// From Python's arguments to when a search is to give up.
#pragma once

#include <nanobind/stl/optional.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "shared/arrays.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

using Flag = std::optional<In<std::uint8_t, 1>>;

// The patience of one call: the moment that is so many seconds away, the flag's byte, and the signals that wait for
// Python, such as that of Ctrl-C. Their handlers run now and then while the call has released the GIL; as whoever else
// has it may want a lock of this search, a lock is waited for without it.
class CallPatience {
 public:
  CallPatience(const std::optional<double> &seconds, const Flag &cancel) : interrupt_(run_handlers) {
    patience_.interrupt = &interrupt_;
    if (cancel && cancel->size() > 0) patience_.cancel = cancel->data();
    if (seconds) {
      const std::chrono::duration<double> most(std::min(*seconds, 1e9));
      patience_.deadline =
          std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(most);
    }
  }
  operator const Patience &() const { return patience_; }

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
  Patience patience_;
};

}  // namespace trundle
