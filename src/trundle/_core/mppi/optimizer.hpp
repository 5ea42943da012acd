// One iteration of model predictive path integral control per tick (Williams, Drews, Goldfain, Rehg and Theodorou 2016),
// with the memory that it keeps from tick to tick.
//
// The samples' weighted mean is the new sequence, as the robot can drive it. Only samples that touch nothing have a
// weight, unless there are none. Where the mean touches something that the best sample does not, that is taken.
#pragma once

#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <vector>

#include "mppi/kernels.hpp"
#include "mppi/request.hpp"
#include "mppi/sequences.hpp"
#include "mppi/softmin.hpp"

namespace trundle::mppi {

struct Answer {
  float v, w, cost, best, temperature, effective;
  int free, blocked, contacts, dropped, touching;
  bool best_taken;
};

class Optimizer {
 public:
  Optimizer(int samples, int steps, int knot_steps, Level level) : level_(level) {
    refuse_unless(samples >= 128 && samples <= 65536 && samples % kBlock == 0,
                  "the samples must be a multiple of 16, from 128 to 65536");
    refuse_unless(steps >= 2 && steps <= 1024, "the steps must be from 2 to 1024");
    refuse_unless(knot_steps >= 1 && knot_steps <= steps, "the steps from knot to knot must be from 1 to all steps");
    Problem &p = problem_;
    p.samples = samples, p.steps = steps, p.knot_steps = knot_steps;
    p.checkpoints = (steps + knot_steps - 1) / knot_steps;
    p.knots = p.checkpoints + 1;
    const std::size_t row = row_of(p), all = static_cast<std::size_t>(samples);
    draws_.resize((all - kArcs) / kBlock * row);
    arcs_.resize(kArcs / kLanesPerHalf * row);
    knots_.resize(row);
    nominal_.resize(2 * static_cast<std::size_t>(steps));
    mean_.resize(nominal_.size());
    zeros_.resize(nominal_.size());
    costs_.resize(all);
    hit_step_.resize(all);
    contact_.resize(all);
    order_.resize(all);
    softmin_.reserve(samples);
  }

  // The request has to be checked.
  Answer step(const Request &request, float *controls) {
    read(request, controls);
    roll(problem_, {costs_.data(), hit_step_.data(), contact_.data()}, level_);
    stepped_ = true;
    Answer answer = count();
    improve(answer, static_cast<float>(request.noise.share));
    std::copy(mean_.begin(), mean_.end(), controls);
    return answer;
  }

  Level level() const { return level_; }
  int steps() const { return problem_.steps; }
  const std::vector<float> &costs() const { return costs_; }

  // The cheapest samples of the last step, in order.
  std::vector<int> best(int count) {
    const std::size_t wanted = stepped_ ? std::min(static_cast<std::size_t>(count), costs_.size()) : 0;
    std::iota(order_.begin(), order_.end(), 0);
    std::partial_sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(wanted), order_.end(), [&](int a, int b) {
      return std::make_tuple(rank(a), a) < std::make_tuple(rank(b), b);
    });
    return {order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(wanted)};
  }

  // Appends a sample's poses (x, y, yaw) in metres from the start on.
  void trace(int sample, std::vector<float> &poses) const {
    drive(problem_, sample, hit_step_[static_cast<std::size_t>(sample)], [&](const Motion<float> &robot) {
      const float x = robot.x * problem_.resolution, y = robot.y * problem_.resolution;
      poses.insert(poses.end(), {x, y, std::atan2(robot.sin, robot.cos)});
    });
  }

 private:
  float cost(int sample) const { return costs_[static_cast<std::size_t>(sample)]; }
  bool counts(int sample) const { return std::isfinite(cost(sample)); }
  bool is_free(int sample) const { return hit_step_[static_cast<std::size_t>(sample)] == problem_.steps; }
  bool has_contact(int sample) const { return contact_[static_cast<std::size_t>(sample)] != 0; }
  float rank(int sample) const { return counts(sample) ? cost(sample) : Softmin::kUnused; }

  void read(const Request &request, const float *controls) {
    Problem &p = problem_;
    p.model = read_model(request);
    p.start = read_start(request);
    p.goal = read_goal(request);
    p.weights = read_weights(request, p.steps);
    p.resolution = static_cast<float>(request.window.resolution);
    const Critics &critics = request.critics;
    const Noise &noise = request.noise;
    p.near_scale = static_cast<float>(request.window.unit / std::max(critics.obstacle_reach, 1e-6));
    p.heading_free = static_cast<float>(std::cos(0.5 * std::min(critics.free_heading, 3.14159265)));
    p.speed_limit = static_cast<float>(request.limits.speed_limit);
    p.stop_scale = static_cast<float>(0.5 / request.limits.deceleration);
    p.v_std = static_cast<float>(noise.v_std), p.w_std = static_cast<float>(noise.w_std);
    read_window(request.window);
    touching_ = read_discs(request, p);
    read_movers(request, p.steps, movers_);
    p.mover_count = static_cast<int>(request.movers.shape(0));
    p.movers = movers_.data();
    shift(controls, noise.shift, nominal_);
    const auto seed = static_cast<std::uint64_t>(noise.seed);
    if (seed_ != seed) draw(p, seed, draws_);
    seed_ = seed;
    lay_arcs(p, arcs_);
    p.nominal = nominal_.data(), p.zeros = zeros_.data(), p.arcs = arcs_.data(), p.draws = draws_.data();
  }

  // Both fields are copied: the bytes need some more at their end, and the costs must be numbers.
  void read_window(const Window &window) {
    Problem &p = problem_;
    p.rows = static_cast<std::int32_t>(window.nearness.shape(0));
    p.cols = static_cast<std::int32_t>(window.nearness.shape(1));
    nearness_.resize(std::max(nearness_.size(), window.nearness.size() + 3));
    std::copy_n(window.nearness.data(), window.nearness.size(), nearness_.data());
    to_go_.resize(std::max(to_go_.size(), window.to_go.size()));
    p.unreachable = read_to_go(window, to_go_.data());
    p.edge = kRim * p.resolution;
    p.nearness = nearness_.data(), p.to_go = to_go_.data();
  }

  Answer count() {
    Answer answer{};
    answer.touching = touching_;
    answer.best = std::numeric_limits<float>::infinity();
    for (int sample = 0; sample < problem_.samples; ++sample) {
      if (!counts(sample)) {
        ++answer.dropped;
        continue;
      }
      ++(is_free(sample) ? answer.free : answer.blocked);
      answer.contacts += has_contact(sample) ? 1 : 0;
      answer.best = std::min(answer.best, cost(sample));
    }
    return answer;
  }

  void improve(Answer &answer, float share) {
    const bool free_only = answer.free > 0;
    const int used = free_only ? answer.free : answer.blocked;
    int best = -1, untouched = 0;
    for (int sample = 0; sample < problem_.samples; ++sample) {
      const bool takes_part = counts(sample) && (!free_only || is_free(sample));
      softmin_.gaps()[sample] = takes_part ? cost(sample) : Softmin::kUnused;
      if (takes_part && !has_contact(sample)) ++untouched;
      if (takes_part && (best < 0 || cost(sample) < cost(best))) best = sample;
    }
    std::fill(mean_.begin(), mean_.end(), 0.0f);
    if (used > 0) {
      const float aim = std::min(share * static_cast<float>(problem_.samples),
                                 0.5f * static_cast<float>(untouched > 0 ? untouched : used));
      softmin_.weigh(cost(best), std::max(1.0f, aim));
      answer.temperature = softmin_.temperature(), answer.effective = softmin_.effective();
      average(problem_, softmin_.weights(), knots_, mean_);
    }
    const Single mean = cost_of_mean();
    const bool could_be_better = used > 0 && is_free(best);
    const bool hits = mean.hit_step < problem_.steps, touches = mean.contact && used > 0 && !has_contact(best);
    answer.best_taken = could_be_better && (hits || touches);
    answer.cost = answer.best_taken ? cost(best) : mean.cost;
    keep(answer.best_taken ? best : -1);
    answer.v = mean_[0], answer.w = mean_[1];
  }

  struct Single {
    float cost;
    int hit_step;
    bool contact;
  };

  Single cost_of_mean() {
    float costs[4];
    std::int32_t hit_step[4];
    std::uint8_t contact[4];
    problem_.nominal = mean_.data();
    roll_nominal(problem_, {costs, hit_step, contact});
    problem_.nominal = nominal_.data();
    return {costs[0], hit_step[0], contact[0] != 0};
  }

  // What the robot really does, within its limits, of a sample or of the mean: the sequence that the next tick begins
  // with.
  void keep(int sample) {
    std::size_t at = 0;
    const auto write = [&](const Motion<float> &robot) {
      if (at > 0) mean_[2 * at - 2] = robot.v, mean_[2 * at - 1] = robot.w;
      ++at;
    };
    if (sample >= 0) return drive(problem_, sample, problem_.steps, write);
    const auto target = [&](int step, float &v, float &w) {
      v = mean_[2 * static_cast<std::size_t>(step)], w = mean_[2 * static_cast<std::size_t>(step) + 1];
    };
    follow(problem_, target, problem_.steps, write);
  }

  static constexpr float kRim = 3.0f;  // cells by which an unreachable cell rises above its neighbours

  const Level level_;
  Problem problem_{};
  std::optional<std::uint64_t> seed_;
  bool stepped_ = false;
  int touching_ = 0;
  std::vector<float> draws_, arcs_, nominal_, mean_, zeros_, knots_, costs_, to_go_;
  std::vector<std::int32_t> hit_step_;
  std::vector<std::uint8_t> contact_, nearness_;
  std::vector<MoverStep> movers_;
  std::vector<int> order_;
  Softmin softmin_;
};

}  // namespace trundle::mppi
