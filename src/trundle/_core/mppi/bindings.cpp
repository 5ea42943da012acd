// `Mppi` as Python sees it: model predictive path integral control (Williams, Drews, Goldfain, Rehg and Theodorou 2016),
// with the memory that it keeps between ticks.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <mutex>
#include <numeric>
#include <optional>
#include <tuple>

#include "mppi/draws.hpp"
#include "mppi/kernels.hpp"
#include "mppi/motion.hpp"
#include "mppi/request.hpp"
#include "mppi/softmin.hpp"

namespace trundle {

using namespace mppi;

namespace {

constexpr float kArcSpeeds[] = {-1.0f, -0.5f, 0.0f, 0.25f, 0.5f, 0.75f, 1.0f};  // shares of the limits
// Draws of one block are wide, those of the next closer to the nominal controls: without the close ones, the robot
// creeps for seconds over the last centimetres, as every sample passes by the goal.
constexpr float kShrink[] = {1.0f, 0.5f, 0.25f, 0.125f};
constexpr float kArcTurns[] = {-1.0f, -0.5f, -0.25f, -0.1f, 0.0f, 0.1f, 0.25f, 0.5f, 1.0f};

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
  Mppi(int samples, int steps, int knot_steps, const std::optional<std::string> &level) : level_(level_of(level)) {
    refuse_unless(samples >= 128 && samples <= 65536 && samples % kBlock == 0,
                  "the samples must be a multiple of 16, from 128 to 65536");
    refuse_unless(steps >= 2 && steps <= 1024, "the steps must be from 2 to 1024");
    refuse_unless(knot_steps >= 1 && knot_steps <= steps, "the steps from knot to knot must be from 1 to all steps");
    Problem &p = problem_;
    p.samples = samples, p.steps = steps, p.knot_steps = knot_steps;
    p.checkpoints = (steps + knot_steps - 1) / knot_steps;
    p.knots = p.checkpoints + 1;
    const std::size_t row = static_cast<std::size_t>(p.knots) * 2 * kLanesPerHalf, all = static_cast<std::size_t>(samples);
    draws_.resize((all - kArcs) / kBlock * row);
    arcs_.resize(kArcs / kLanesPerHalf * row);
    nominal_.resize(2 * static_cast<std::size_t>(steps));
    mean_.resize(nominal_.size());
    zeros_.resize(nominal_.size());
    knots_.resize(row);
    costs_.resize(all);
    hit_step_.assign(all, steps);
    contact_.resize(all);
    order_.resize(all);
    softmin_.reserve(samples);
  }

  nb::tuple step(In<double, 1> state, Sequence controls, In<double, 1> model, In<double, 1> noise, In<double, 2> discs,
                 In<std::uint8_t, 2> nearness, In<float, 2> to_go, double resolution, double unit, In<double, 1> goal,
                 In<double, 2> movers, In<double, 1> weights, In<double, 1> bounds) {
    const Request request{state, model, noise, discs, nearness, to_go, resolution, unit, goal, movers, weights, bounds};
    check(request);
    refuse_unless(controls.shape(0) == static_cast<std::size_t>(problem_.steps), "the controls need shape (steps, 2)");
    Answer answer;
    {
      nb::gil_scoped_release release;
      const std::lock_guard<std::mutex> lock(mutex_);
      read(request, controls.data());
      roll(problem_, {costs_.data(), hit_step_.data(), contact_.data()}, level_);
      stepped_ = true;
      count(answer);
      improve(answer, static_cast<float>(noise.data()[2]));
      std::copy(mean_.begin(), mean_.end(), controls.data());
    }
    return nb::make_tuple(answer.v, answer.w, answer.cost, answer.best, answer.free, answer.blocked, answer.contacts,
                          answer.dropped, touching_, answer.temperature, answer.effective, answer.best_taken);
  }

  nb::ndarray<nb::numpy, float> costs() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return to_numpy(std::vector<float>(costs_), {costs_.size()});
  }

  // The best samples of the last step, driven once more: poses (x, y, yaw) in metres, and their costs.
  nb::tuple rollouts(int count) {
    refuse_unless(count >= 0, "the number of rollouts must be at least 0");
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::size_t wanted = stepped_ ? std::min(static_cast<std::size_t>(count), costs_.size()) : 0;
    const auto steps = static_cast<std::size_t>(problem_.steps);
    std::iota(order_.begin(), order_.end(), 0);
    std::partial_sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(wanted), order_.end(), [&](int a, int b) {
      return std::make_tuple(rank(a), a) < std::make_tuple(rank(b), b);
    });
    std::vector<float> poses, costs;
    poses.reserve(wanted * (steps + 1) * 3);
    for (std::size_t i = 0; i < wanted; ++i) {
      const int sample = order_[i];
      costs.push_back(costs_[static_cast<std::size_t>(sample)]);
      drive(sample, hit_step_[static_cast<std::size_t>(sample)], [&](const Motion<float> &robot) {
        poses.insert(poses.end(), {robot.x * problem_.resolution, robot.y * problem_.resolution,
                                   std::atan2(robot.sin, robot.cos)});
      });
    }
    return nb::make_tuple(to_numpy(std::move(poses), {wanted, steps + 1, 3}), to_numpy(std::move(costs), {wanted}));
  }

  std::string level() const { return level_ == Level::kAvx2 ? "avx2" : "base"; }

 private:
  struct Answer {
    float v, w, cost, best, temperature, effective;
    int free, blocked, contacts, dropped, best_sample;
    bool best_taken;
  };

  bool is_finite(int sample) const { return std::isfinite(costs_[static_cast<std::size_t>(sample)]); }
  bool is_free(int sample) const { return hit_step_[static_cast<std::size_t>(sample)] == problem_.steps; }
  float rank(int sample) const { return is_finite(sample) ? costs_[static_cast<std::size_t>(sample)] : Softmin::kUnused; }

  void read(const Request &request, const float *controls) {
    Problem &p = problem_;
    p.model = read_model(request);
    p.start = read_start(request);
    p.goal = read_goal(request);
    p.weights = read_weights(request, p.steps);
    p.rows = static_cast<std::int32_t>(request.nearness.shape(0));
    p.cols = static_cast<std::int32_t>(request.nearness.shape(1));
    p.resolution = static_cast<float>(request.resolution);
    nearness_.resize(std::max(nearness_.size(), request.nearness.size() + 3));
    std::copy_n(request.nearness.data(), request.nearness.size(), nearness_.data());
    p.nearness = nearness_.data();
    const double *bounds = request.bounds.data(), *noise = request.noise.data();
    p.near_scale = static_cast<float>(request.unit / std::max(bounds[0], 1e-6));
    p.heading_free = static_cast<float>(std::cos(0.5 * std::min(bounds[3], 3.14159265)));
    p.speed_limit = static_cast<float>(bounds[4]);
    p.stop_scale = static_cast<float>(0.5 / request.model.data()[5]);
    p.v_std = static_cast<float>(noise[0]), p.w_std = static_cast<float>(noise[1]);
    touching_ = read_discs(request, p);
    to_go_.resize(std::max(to_go_.size(), request.to_go.size()));
    p.unreachable = read_to_go(request, to_go_.data());
    p.edge = 3.0f * p.resolution;
    p.mover_count = static_cast<int>(request.movers.shape(0));
    movers_.resize(std::max(movers_.size(), request.movers.shape(0) * static_cast<std::size_t>(p.steps)));
    double radius = 0.0;
    for (std::size_t k = 0; k < request.discs.shape(0); ++k) radius = std::max(radius, request.discs.data()[2 * k + 1]);
    read_movers(request, radius, p.steps, movers_.data());
    shift(controls, noise[4]);
    draw(static_cast<std::uint64_t>(noise[3]));
    lay_arcs();
    p.to_go = to_go_.data(), p.movers = movers_.data(), p.nominal = nominal_.data(), p.zeros = zeros_.data();
    p.arcs = arcs_.data(), p.draws = draws_.data();
  }

  // The sequence some steps later, its end held; what is no number is 0.
  void shift(const float *controls, double by) {
    const int last = problem_.steps - 1;
    for (int step = 0; step <= last; ++step) {
      const double at = std::min(step + by, static_cast<double>(last));
      const int first = static_cast<int>(at), next = std::min(first + 1, last);
      const auto part = static_cast<float>(at - first);
      for (int k = 0; k < 2; ++k) {
        const float a = controls[2 * first + k], b = controls[2 * next + k];
        const float value = part > 0.0f ? a + (b - a) * part : a;
        nominal_[static_cast<std::size_t>(2 * step + k)] = std::fabs(value) <= 1e6f ? value : 0.0f;
      }
    }
  }

  // The first sample of the first block, and its mirror image, are the nominal controls themselves.
  void draw(std::uint64_t seed) {
    if (drawn_ == seed) return;
    const std::size_t row = static_cast<std::size_t>(problem_.knots) * 2 * kLanesPerHalf;
    for (std::size_t i = 0; i < draws_.size(); ++i) {
      const bool plain = i < row && i % kLanesPerHalf == 0;
      draws_[i] = plain ? 0.0f : normal(seed, i) * kShrink[i / row % 4];
    }
    drawn_ = seed;
  }

  void lay_arcs() {
    const Model &model = problem_.model;
    for (int sample = 0; sample < kArcs; ++sample) {
      // One more than there are pairs: straight on, slowly.
      const bool pair = sample < kArcs - 1;
      const float speed = pair ? kArcSpeeds[sample / 9] : 0.1f, turn = pair ? kArcTurns[sample % 9] : 0.0f;
      const float v = speed < 0.0f ? -speed * model.v_min : speed * model.v_max, w = turn * model.w_max;
      const int group = sample / kLanesPerHalf, lane = sample % kLanesPerHalf;
      for (int knot = 0; knot < problem_.knots; ++knot) {
        float *row = arcs_.data() + (group * problem_.knots + knot) * 2 * kLanesPerHalf + lane;
        row[0] = v;
        row[kLanesPerHalf] = w;
      }
    }
  }

  void count(Answer &answer) const {
    answer = {};
    answer.best = std::numeric_limits<float>::infinity();
    for (int sample = 0; sample < problem_.samples; ++sample) {
      if (!is_finite(sample)) {
        ++answer.dropped;
        continue;
      }
      ++(is_free(sample) ? answer.free : answer.blocked);
      answer.contacts += contact_[static_cast<std::size_t>(sample)];
      const float cost = costs_[static_cast<std::size_t>(sample)];
      if (cost < answer.best) answer.best = cost, answer.best_sample = sample;
    }
  }

  // The weighted mean of the samples: of those that are free, unless there are none. Where it touches something that
  // the best sample does not, that sample.
  void improve(Answer &answer, float share) {
    const int used = answer.free > 0 ? answer.free : answer.blocked;
    float lowest = answer.best;
    if (answer.free > 0) {
      lowest = std::numeric_limits<float>::infinity();
      for (int sample = 0; sample < problem_.samples; ++sample) {
        const float cost = costs_[static_cast<std::size_t>(sample)];
        if (is_free(sample) && is_finite(sample) && cost < lowest) lowest = cost, answer.best_sample = sample;
      }
    }
    if (used == 0) {
      std::fill(mean_.begin(), mean_.end(), 0.0f);
    } else {
      for (int sample = 0; sample < problem_.samples; ++sample) {
        const bool counts = is_finite(sample) && (answer.free == 0 || is_free(sample));
        softmin_.gaps()[sample] = counts ? costs_[static_cast<std::size_t>(sample)] - lowest : Softmin::kUnused;
      }
      softmin_.weigh(std::max(1.0f, std::min(share * static_cast<float>(problem_.samples), 0.5f * static_cast<float>(used))));
      answer.temperature = softmin_.temperature(), answer.effective = softmin_.effective();
      average();
    }
    Outcome alone{mean_cost_, mean_hit_, mean_contact_};
    problem_.nominal = mean_.data();
    roll_nominal(problem_, alone);
    problem_.nominal = nominal_.data();
    answer.cost = mean_cost_[0];
    const int best = answer.best_sample;
    const bool worse = mean_hit_[0] < problem_.steps && used > 0 && is_free(best);
    const bool touches = mean_contact_[0] != 0 && used > 0 && contact_[static_cast<std::size_t>(best)] == 0 && is_free(best);
    answer.best_taken = worse || touches;
    if (answer.best_taken) answer.cost = costs_[static_cast<std::size_t>(best)];
    // What the robot will really do, within its limits, is the sequence that the next tick begins with.
    std::size_t at = 0;
    const auto keep = [&](const Motion<float> &robot) {
      if (at > 0) mean_[2 * at - 2] = robot.v, mean_[2 * at - 1] = robot.w;
      ++at;
    };
    if (answer.best_taken) {
      drive(best, problem_.steps, keep);
    } else {
      follow([&](int step, float &v, float &w) { v = mean_[2 * static_cast<std::size_t>(step)], w = mean_[2 * static_cast<std::size_t>(step) + 1]; },
             problem_.steps, keep);
    }
    answer.v = mean_[0], answer.w = mean_[1];
  }

  void average() {
    const Problem &p = problem_;
    const float *weights = softmin_.weights();
    const int row = p.knots * 2 * kLanesPerHalf;
    std::fill(knots_.begin(), knots_.end(), 0.0f);
    float arcs = 0.0f, arc_v = 0.0f, arc_w = 0.0f;
    for (int sample = 0; sample < kArcs; ++sample) {
      const float *arc = p.arcs + sample / kLanesPerHalf * row + sample % kLanesPerHalf;
      arcs += weights[sample];
      arc_v += weights[sample] * arc[0];
      arc_w += weights[sample] * arc[kLanesPerHalf];
    }
    for (int first = kArcs; first < p.samples; first += kBlock) {
      const float *draws = p.draws + (first - kArcs) / kBlock * row;
      float pull[kLanesPerHalf];
      for (int lane = 0; lane < kLanesPerHalf; ++lane) pull[lane] = weights[first + lane] - weights[first + kLanesPerHalf + lane];
      for (int i = 0; i < row; i += kLanesPerHalf) {
        for (int lane = 0; lane < kLanesPerHalf; ++lane) knots_[static_cast<std::size_t>(i + lane)] += pull[lane] * draws[i + lane];
      }
    }
    const auto knot = [&](int k, int which) {
      const float *lanes = knots_.data() + (2 * k + which) * kLanesPerHalf;
      return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
    };
    for (int step = 0; step < p.steps; ++step) {
      const int k = step / p.knot_steps;
      const float part = static_cast<float>(step % p.knot_steps) / static_cast<float>(p.knot_steps);
      for (int which = 0; which < 2; ++which) {
        const float from = knot(k, which), to = knot(k + 1, which), scale = which == 0 ? p.v_std : p.w_std;
        const std::size_t at = static_cast<std::size_t>(2 * step + which);
        mean_[at] = nominal_[at] * (1.0f - arcs) + (from + (to - from) * part) * scale + (which == 0 ? arc_v : arc_w);
      }
    }
  }

  // Drives a sample as the rollout does, and shows each state from the start on; it stands from `stop` on.
  template <typename Show>
  void drive(int sample, int stop, Show show) const {
    const Problem &p = problem_;
    const int row = p.knots * 2 * kLanesPerHalf, lane = sample % kLanesPerHalf;
    const bool arc = sample < kArcs;
    const int block = (sample - kArcs) / kBlock;
    const float sign = (sample - kArcs) % kBlock < kLanesPerHalf ? 1.0f : -1.0f;
    const float *draws = arc ? p.arcs + sample / kLanesPerHalf * row + lane : p.draws + block * row + lane;
    const float *nominal = arc ? zeros_.data() : nominal_.data();
    const float v_scale = arc ? 1.0f : sign * p.v_std, w_scale = arc ? 1.0f : sign * p.w_std;
    const float share = 1.0f / static_cast<float>(p.knot_steps);
    follow(
        [&](int step, float &v, float &w) {
          const float *from = draws + step / p.knot_steps * 2 * kLanesPerHalf, *to = from + 2 * kLanesPerHalf;
          const float fraction = static_cast<float>(step % p.knot_steps) * share;
          const float v0 = from[0] * v_scale, w0 = from[kLanesPerHalf] * w_scale;
          v = (v0 + (to[0] * v_scale - v0) * fraction) + nominal[2 * step];
          w = (w0 + (to[kLanesPerHalf] * w_scale - w0) * fraction) + nominal[2 * step + 1];
        },
        stop, show);
  }

  template <typename Target, typename Show>
  void follow(Target target, int stop, Show show) const {
    Motion<float> robot = at_start<float>(problem_.start);
    show(robot);
    for (int step = 0; step < problem_.steps; ++step) {
      float target_v, target_w, v = 0.0f, w = 0.0f;
      target(step, target_v, target_w);
      if (step <= stop) speed_up(problem_.model, robot, target_v, target_w, v, w);
      move(problem_.model, robot, v, w);
      show(robot);
    }
  }

  const Level level_;
  Problem problem_{};
  std::mutex mutex_;
  std::optional<std::uint64_t> drawn_;
  bool stepped_ = false;
  int touching_ = 0;
  std::vector<float> draws_, arcs_, nominal_, mean_, zeros_, knots_, costs_, to_go_;
  std::vector<std::int32_t> hit_step_;
  std::vector<std::uint8_t> contact_, nearness_;
  std::vector<MoverStep> movers_;
  std::vector<int> order_;
  Softmin softmin_;
  float mean_cost_[4];
  std::int32_t mean_hit_[4];
  std::uint8_t mean_contact_[4];
};

}  // namespace trundle

void bind_mppi(nanobind::module_ &m) {
  namespace nb = nanobind;
  using nb::arg;
  nb::class_<trundle::Mppi>(m, "Mppi")
      .def(nb::init<int, int, int, const std::optional<std::string> &>(), arg("samples"), arg("steps"), arg("knot_steps"),
           arg("level") = nb::none())
      .def("step", &trundle::Mppi::step, arg("state").noconvert(), arg("controls").noconvert(), arg("model").noconvert(),
           arg("noise").noconvert(), arg("discs").noconvert(), arg("nearness").noconvert(), arg("to_go").noconvert(),
           arg("resolution"), arg("unit"), arg("goal").noconvert(), arg("movers").noconvert(),
           arg("weights").noconvert(), arg("bounds").noconvert())
      .def("costs", &trundle::Mppi::costs)
      .def("rollouts", &trundle::Mppi::rollouts, arg("count"))
      .def_prop_ro("level", &trundle::Mppi::level);
}
