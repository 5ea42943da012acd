// `Mppi` as Python sees it: samples of what a differential drive could do, their costs, and the sequence of controls
// that they lead to. Calls of several threads wait for each other.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "mppi/optimizer.hpp"

namespace trundle {

using namespace mppi;

namespace {

Level level_of(const std::optional<std::string> &name) {
  if (!name.has_value()) return has_avx2() ? Level::kAvx2 : Level::kBase;
  if (*name == "base") return Level::kBase;
  refuse_unless(*name == "avx2", "the level must be base or avx2");
  refuse_unless(has_avx2(), "this processor has no AVX2");
  return Level::kAvx2;
}

}  // namespace

class Mppi {
 public:
  Mppi(int samples, int steps, int knot_steps, const std::optional<std::string> &level)
      : optimizer_(samples, steps, knot_steps, level_of(level)) {}

  nb::tuple step(const State &state, Sequence controls, const Limits &limits, const Noise &noise, In<double, 2> discs,
                 const Window &window, const Aim &aim, In<double, 2> movers, const Critics &critics) {
    const Request request{state, limits, noise, discs, window, aim, movers, critics};
    check(request);
    refuse_unless(controls.shape(0) == static_cast<std::size_t>(optimizer_.steps()), "the controls need shape (steps, 2)");
    Answer a;
    {
      nb::gil_scoped_release release;
      const std::lock_guard<std::mutex> lock(mutex_);
      a = optimizer_.step(request, controls.data());
    }
    return nb::make_tuple(a.v, a.w, a.cost, a.best, a.free, a.blocked, a.contacts, a.dropped, a.touching, a.temperature,
                          a.effective, a.best_taken);
  }

  nb::ndarray<nb::numpy, float> costs() {
    std::vector<float> copy;
    {
      nb::gil_scoped_release release;
      const std::lock_guard<std::mutex> lock(mutex_);
      copy = optimizer_.costs();
    }
    const std::size_t count = copy.size();
    return to_numpy(std::move(copy), {count});
  }

  nb::tuple rollouts(int count) {
    refuse_unless(count >= 0, "the number of rollouts must be at least 0");
    std::vector<float> poses, costs;
    {
      nb::gil_scoped_release release;
      const std::lock_guard<std::mutex> lock(mutex_);
      for (const int sample : optimizer_.best(count)) {
        optimizer_.trace(sample, poses);
        costs.push_back(optimizer_.costs()[static_cast<std::size_t>(sample)]);
      }
    }
    const std::size_t found = costs.size(), length = static_cast<std::size_t>(optimizer_.steps()) + 1;
    return nb::make_tuple(to_numpy(std::move(poses), {found, length, 3}), to_numpy(std::move(costs), {found}));
  }

  std::string level() const { return optimizer_.level() == Level::kAvx2 ? "avx2" : "base"; }

 private:
  std::mutex mutex_;
  Optimizer optimizer_;
};

}  // namespace trundle

namespace {

// Plain values: made by keyword, and only read.
void bind_arguments(nanobind::module_ &m) {
  namespace nb = nanobind;
  using nb::arg;
  using namespace trundle;
  using namespace trundle::mppi;
  nb::class_<State>(m, "MppiState")
      .def(nb::init<double, double, double, double, double, double, double>(), nb::kw_only(), arg("x"), arg("y"),
           arg("yaw"), arg("v"), arg("w"), arg("v_rate"), arg("w_rate"));
  nb::class_<Limits>(m, "MppiLimits")
      .def(nb::init<double, double, double, double, double, double, double, double>(), nb::kw_only(), arg("dt"),
           arg("v_min"), arg("v_max"), arg("w_max"), arg("acceleration"), arg("deceleration"),
           arg("angular_acceleration"), arg("speed_limit"));
  nb::class_<Noise>(m, "MppiNoise")
      .def(nb::init<double, double, double, double, double>(), nb::kw_only(), arg("v_std"), arg("w_std"), arg("share"),
           arg("seed"), arg("shift"));
  nb::class_<Window>(m, "MppiWindow")
      .def(nb::init<In<std::uint8_t, 2>, In<float, 2>, double, double>(), nb::kw_only(), arg("nearness").noconvert(),
           arg("to_go").noconvert(), arg("resolution"), arg("unit"));
  nb::class_<Aim>(m, "MppiAim")
      .def(nb::init<double, double, double, bool, double, double, double>(), nb::kw_only(), arg("x"), arg("y"),
           arg("yaw"), arg("has_yaw"), arg("reach"), arg("fade"), arg("direction"));
  nb::class_<Critics>(m, "MppiCritics")
      .def(nb::init<double, double, double, double, double, double, double, double, double, double, double, double,
                    double, double, double, double, double, double, double>(),
           nb::kw_only(), arg("collision"), arg("contact"), arg("to_go"), arg("to_go_end"), arg("heading"), arg("yaw"),
           arg("overshoot"), arg("obstacle"), arg("obstacle_speed"), arg("mover"), arg("direction"), arg("twirl"),
           arg("acceleration"), arg("jerk"), arg("speed"), arg("obstacle_reach"), arg("mover_margin"),
           arg("mover_sigmas"), arg("free_heading"));
}

}  // namespace

void bind_mppi(nanobind::module_ &m) {
  namespace nb = nanobind;
  using nb::arg;
  bind_arguments(m);
  nb::class_<trundle::Mppi>(m, "Mppi")
      .def(nb::init<int, int, int, const std::optional<std::string> &>(), arg("samples"), arg("steps"), arg("knot_steps"),
           arg("level") = nb::none())
      .def("step", &trundle::Mppi::step, arg("state"), arg("controls").noconvert(), arg("limits"), arg("noise"),
           arg("discs").noconvert(), arg("window"), arg("aim"), arg("movers").noconvert(), arg("critics"))
      .def("costs", &trundle::Mppi::costs)
      .def("rollouts", &trundle::Mppi::rollouts, arg("count"))
      .def_prop_ro("level", &trundle::Mppi::level);
}
