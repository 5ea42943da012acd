// What `Mppi` is measured against: the same samples, motion and critics in the layout of Nav2's controller, written from
// its description. Built and called by kernels.py.
//
// Every quantity of the rollouts is an array of samples × steps in memory (a column for each step, as Eigen keeps them):
// noised controls, speeds, yaw, its cosine and sine, x and y. Each critic is a pass of its own over these arrays that
// adds to the samples' costs; the one of obstacles goes sample by sample and ends at the first contact, as Nav2's does.
// Then one softmin with a given temperature, and a weighted sum over the arrays of controls. Noise is made before, once.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace {

struct Request {
  std::int32_t samples, steps, knot_steps, rows, cols, disc_count, mover_count, has_goal, has_yaw;
  float x, y, yaw, v, w, v_change, w_change;                       // cells
  float dt, v_min, v_max, w_max, faster, slower, turn, half_step;  // changes of one step
  float goal_x, goal_y, goal_yaw, reach, fade, direction;          // cells
  float collision, contact, to_go, to_go_end, heading, goal_yaw_weight, overshoot, obstacle, obstacle_speed;
  float against, twirl, v_acceleration, w_acceleration, v_jerk, w_jerk, speed;  // of one step
  float near_scale, heading_free, speed_limit, stop_scale, resolution, rear, front, temperature, far;
};

struct Arrays {
  std::vector<float> controls_v, controls_w, v, w, yaw, cos, sin, x, y;  // samples × steps
  std::vector<float> to_go, fall_x, fall_y;                              // samples × checkpoints
  std::vector<float> weights;
  std::vector<std::uint8_t> hit;

  void resize(const Request &r) {
    const auto all = static_cast<std::size_t>(r.samples) * static_cast<std::size_t>(r.steps);
    for (auto *array : {&controls_v, &controls_w, &v, &w, &yaw, &cos, &sin, &x, &y, &to_go, &fall_x, &fall_y}) {
      array->resize(all);
    }
    weights.resize(static_cast<std::size_t>(r.samples));
    hit.resize(weights.size());
  }
};

float clamped(float number, float low, float high) { return std::min(std::max(number, low), high); }

void make_trajectories(const Request &r, const float *nominal, const float *noise_v, const float *noise_w, Arrays &a) {
  const int n = r.samples;
  for (int t = 0; t < r.steps; ++t) {
    for (int i = 0; i < n; ++i) a.controls_v[t * n + i] = nominal[2 * t] + noise_v[t * n + i];
  }
  for (int t = 0; t < r.steps; ++t) {
    for (int i = 0; i < n; ++i) a.controls_w[t * n + i] = nominal[2 * t + 1] + noise_w[t * n + i];
  }
  for (int t = 0; t < r.steps; ++t) {
    const float *aim = &a.controls_v[t * n];
    float *now = &a.v[t * n];
    for (int i = 0; i < n; ++i) {
      const float last = t == 0 ? r.v : now[i - n];
      const float up = last < 0.0f ? r.slower : r.faster, down = last > 0.0f ? r.slower : r.faster;
      now[i] = clamped(clamped(aim[i], r.v_min, r.v_max), last - down, last + up);
    }
  }
  for (int t = 0; t < r.steps; ++t) {
    const float *aim = &a.controls_w[t * n];
    float *now = &a.w[t * n];
    for (int i = 0; i < n; ++i) {
      const float last = t == 0 ? r.w : now[i - n];
      now[i] = clamped(clamped(aim[i], -r.w_max, r.w_max), last - r.turn, last + r.turn);
    }
  }
  for (int t = 0; t < r.steps; ++t) {
    for (int i = 0; i < n; ++i) a.yaw[t * n + i] = (t == 0 ? r.yaw : a.yaw[(t - 1) * n + i]) + a.w[t * n + i] * r.dt;
  }
  for (std::size_t i = 0; i < a.yaw.size(); ++i) a.cos[i] = std::cos(a.yaw[i]);
  for (std::size_t i = 0; i < a.yaw.size(); ++i) a.sin[i] = std::sin(a.yaw[i]);
  const float cos = std::cos(r.yaw), sin = std::sin(r.yaw);
  for (int t = 0; t < r.steps; ++t) {
    for (int i = 0; i < n; ++i) {
      const int at = t * n + i;
      const float last = t == 0 ? r.x : a.x[at - n], before = t == 0 ? cos : a.cos[at - n];
      a.x[at] = last + a.v[at] * r.half_step * (before + a.cos[at]);
    }
  }
  for (int t = 0; t < r.steps; ++t) {
    for (int i = 0; i < n; ++i) {
      const int at = t * n + i;
      const float last = t == 0 ? r.y : a.y[at - n], before = t == 0 ? sin : a.sin[at - n];
      a.y[at] = last + a.v[at] * r.half_step * (before + a.sin[at]);
    }
  }
}

void obstacle_critic(const Request &r, const float *discs, const std::uint8_t *nearness, Arrays &a, float *costs) {
  const int n = r.samples;
  for (int i = 0; i < n; ++i) {
    float sum = 0.0f;
    a.hit[i] = 0;
    for (int t = 0; t < r.steps; ++t) {
      const int at = t * n + i;
      float room = 1e9f;
      for (int k = 0; k < r.disc_count; ++k) {
        const float col = clamped(a.x[at] + a.cos[at] * discs[2 * k], 0.0f, static_cast<float>(r.cols) - 0.5f);
        const float row = clamped(a.y[at] + a.sin[at] * discs[2 * k], 0.0f, static_cast<float>(r.rows) - 0.5f);
        const float byte = nearness[static_cast<int>(row) * r.cols + static_cast<int>(col)];
        room = std::min(room, discs[2 * k + 1] - byte);
      }
      if (room <= 0.0f) {
        sum = r.collision;
        a.hit[i] = 1;
        break;
      }
      const float near = 1.0f - room * r.near_scale;
      if (near <= 0.0f) continue;
      const float speed = std::fabs(a.v[at]);
      sum += near * near * speed * r.dt * (r.obstacle + r.obstacle_speed * speed);
    }
    costs[i] += sum;
  }
}

template <typename Cost>
void step_critic(const Request &r, float *costs, Cost cost) {
  for (int t = 0; t < r.steps; ++t) {
    for (int i = 0; i < r.samples; ++i) costs[i] += cost(t * r.samples + i);
  }
}

void smoothness_critic(const Request &r, const std::vector<float> &speeds, float now, float change, float acceleration,
                       float jerk, float *costs) {
  const int n = r.samples;
  for (int t = 0; t < r.steps; ++t) {
    for (int i = 0; i < n; ++i) {
      const int at = t * n + i;
      const float last = t == 0 ? now : speeds[at - n];
      const float step = speeds[at] - last;
      const float before = t == 0 ? change : last - (t == 1 ? now : speeds[at - 2 * n]);
      costs[i] += step * step * acceleration + (step - before) * (step - before) * jerk;
    }
  }
}

void mover_critic(const Request &r, const float *movers, const Arrays &a, std::vector<float> &surest, float *costs) {
  const int n = r.samples;
  std::fill(surest.begin(), surest.end(), 0.0f);
  for (int t = 0; t < r.steps; ++t) {
    for (int m = 0; m < r.mover_count; ++m) {
      const float *mover = movers + 6 * (t * r.mover_count + m);
      for (int i = 0; i < n; ++i) {
        const int at = t * n + i;
        const float dx = mover[0] - a.x[at], dy = mover[1] - a.y[at];
        const float ahead = dx * a.cos[at] + dy * a.sin[at], left = dy * a.cos[at] - dx * a.sin[at];
        const float beyond = ahead - clamped(ahead, r.rear, r.front);
        const float share = std::max(mover[2] - (beyond * beyond + left * left) * mover[3], 0.0f);
        costs[i] += share * share * mover[4];
        surest[i] = std::max(surest[i], share >= 1.0f ? mover[5] : 0.0f);
      }
    }
  }
  for (int i = 0; i < n; ++i) costs[i] += surest[i] * r.contact;
}

int checkpoints_of(const Request &r) { return (r.steps + r.knot_steps - 1) / r.knot_steps; }

void to_go_critic(const Request &r, const float *field, Arrays &a, float *costs) {
  const int n = r.samples, checkpoints = checkpoints_of(r);
  for (int c = 0; c < checkpoints; ++c) {
    const int t = std::min((c + 1) * r.knot_steps, r.steps) - 1;
    for (int i = 0; i < n; ++i) {
      const int at = t * n + i, to = c * n + i;
      const float col = clamped(a.x[at] - 0.5f, 0.0f, static_cast<float>(r.cols - 1));
      const float row = clamped(a.y[at] - 0.5f, 0.0f, static_cast<float>(r.rows - 1));
      const int left = std::min(static_cast<int>(col), r.cols - 2), low = std::min(static_cast<int>(row), r.rows - 2);
      const float tx = col - static_cast<float>(left), ty = row - static_cast<float>(low);
      const float *cell = field + low * r.cols + left;
      float corner[4] = {cell[0], cell[1], cell[r.cols], cell[r.cols + 1]};
      const float least = std::min(std::min(corner[0], corner[1]), std::min(corner[2], corner[3]));
      const float rim = std::min(least + 3.0f * r.resolution, r.far);
      for (float &value : corner) value = value < r.far ? value : rim;
      const float below = corner[0] + (corner[1] - corner[0]) * tx, above = corner[2] + (corner[3] - corner[2]) * tx;
      a.to_go[to] = below + (above - below) * ty;
      a.fall_x[to] = (corner[0] - corner[1]) + ((corner[2] - corner[3]) - (corner[0] - corner[1])) * ty;
      a.fall_y[to] = below - above;
      if (r.has_goal != 0) {
        const float dx = r.goal_x - a.x[at], dy = r.goal_y - a.y[at], distance = std::sqrt(dx * dx + dy * dy);
        if (distance < r.reach) a.to_go[to] = distance * r.resolution, a.fall_x[to] = dx, a.fall_y[to] = dy;
      }
      costs[i] += a.to_go[to] * (r.to_go / static_cast<float>(checkpoints));
    }
  }
  const float *last = &a.to_go[(checkpoints - 1) * n];
  for (int i = 0; i < n; ++i) costs[i] += last[i] * r.to_go_end;
}

float near_goal(const Request &r, float x, float y) {
  if (r.has_goal == 0) return 0.0f;
  const float dx = r.goal_x - x, dy = r.goal_y - y;
  return std::max(1.0f - std::sqrt(dx * dx + dy * dy) / r.fade, 0.0f);
}

float half_cosine(float cosine) { return std::sqrt(std::max(0.5f + 0.5f * cosine, 0.0f)); }

void heading_critic(const Request &r, const Arrays &a, float *costs) {
  const int n = r.samples, checkpoints = checkpoints_of(r);
  for (int c = 0; c < checkpoints; ++c) {
    const int t = std::min((c + 1) * r.knot_steps, r.steps) - 1;
    for (int i = 0; i < n; ++i) {
      const int at = t * n + i, from = c * n + i;
      const float slope = std::sqrt(std::max(a.fall_x[from] * a.fall_x[from] + a.fall_y[from] * a.fall_y[from], 1e-12f));
      const float along = (a.fall_x[from] * a.cos[at] + a.fall_y[from] * a.sin[at]) / slope;
      const float ahead = r.direction != 0.0f ? along * r.direction : std::fabs(along);
      const float off = std::max(r.heading_free - half_cosine(ahead), 0.0f);
      costs[i] += off * (1.0f - near_goal(r, a.x[at], a.y[at])) * (r.heading / static_cast<float>(checkpoints));
    }
  }
}

void goal_yaw_critic(const Request &r, const Arrays &a, float *costs) {
  if (r.has_yaw == 0) return;
  const int n = r.samples, checkpoints = checkpoints_of(r);
  const float cos = std::cos(r.goal_yaw), sin = std::sin(r.goal_yaw);
  for (int c = 0; c < checkpoints; ++c) {
    const int t = std::min((c + 1) * r.knot_steps, r.steps) - 1;
    for (int i = 0; i < n; ++i) {
      const int at = t * n + i;
      const float half = half_cosine(a.cos[at] * cos + a.sin[at] * sin);
      costs[i] += (1.0f - half * near_goal(r, a.x[at], a.y[at])) * (r.goal_yaw_weight / static_cast<float>(checkpoints));
    }
  }
}

void overshoot_critic(const Request &r, const Arrays &a, float *costs) {
  const int n = r.samples;
  const float *v = &a.v[(r.steps - 1) * n], *to_go = &a.to_go[(checkpoints_of(r) - 1) * n];
  for (int i = 0; i < n; ++i) costs[i] += std::max(v[i] * v[i] * r.stop_scale - to_go[i], 0.0f) * r.overshoot;
}

}  // namespace

extern "C" {

void *nav2_layout_make(const Request *request) {
  auto *arrays = new Arrays;
  arrays->resize(*request);
  return arrays;
}

void nav2_layout_free(void *arrays) { delete static_cast<Arrays *>(arrays); }

void nav2_layout_step(void *memory, const Request *request, const float *nominal, const float *noise_v,
                      const float *noise_w, const float *discs, const std::uint8_t *nearness, const float *field,
                      const float *movers, float *costs, float *answer) {
  const Request &r = *request;
  Arrays &a = *static_cast<Arrays *>(memory);
  const int n = r.samples;
  make_trajectories(r, nominal, noise_v, noise_w, a);
  std::fill(costs, costs + n, 0.0f);
  obstacle_critic(r, discs, nearness, a, costs);
  to_go_critic(r, field, a, costs);
  heading_critic(r, a, costs);
  goal_yaw_critic(r, a, costs);
  overshoot_critic(r, a, costs);
  step_critic(r, costs, [&](int at) { return std::max(-a.v[at] * r.direction, 0.0f) * r.against; });
  step_critic(r, costs, [&](int at) { return std::fabs(a.w[at]) * r.twirl; });
  step_critic(r, costs, [&](int at) {
    const float over = std::max(std::fabs(a.v[at]) - r.speed_limit, 0.0f);
    return over * over * r.speed;
  });
  smoothness_critic(r, a.v, r.v, r.v_change, r.v_acceleration, r.v_jerk, costs);
  smoothness_critic(r, a.w, r.w, r.w_change, r.w_acceleration, r.w_jerk, costs);
  if (r.mover_count > 0) mover_critic(r, movers, a, a.weights, costs);

  const float least = *std::min_element(costs, costs + n);
  float sum = 0.0f;
  for (int i = 0; i < n; ++i) a.weights[i] = std::exp((least - costs[i]) / r.temperature);
  for (int i = 0; i < n; ++i) sum += a.weights[i];
  for (int t = 0; t < r.steps; ++t) {
    float v = 0.0f, w = 0.0f;
    for (int i = 0; i < n; ++i) v += a.weights[i] * a.controls_v[t * n + i];
    for (int i = 0; i < n; ++i) w += a.weights[i] * a.controls_w[t * n + i];
    answer[2 * t] = v / sum;
    answer[2 * t + 1] = w / sum;
  }
}
}
