// Pose graphs: Levenberg-Marquardt on the errors of edges, robust where edges may be wrong (Geman and McClure 1987; as
// dynamic covariance scaling: Agarwal, Tipaldi, Spinello, Stachniss and Burgard 2013).
//
// The normal equations are sparse in blocks of 3 x 3. Nodes are eliminated in an order of least degree (Tinney and Walker
// 1967; ties by number, so that the answer is always the same), which leaves little fill in a chain with loops. The
// pattern is worked out once; each iteration fills it, column by column, looking to the left.
#include "mapping/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <vector>

#include "localization/checks.hpp"
#include "mapping/small_matrix.hpp"

namespace trundle {

using namespace localization;
using mapping::invert;
using mapping::Matrix3;

namespace {

constexpr double kPi = 3.14159265358979323846;

struct Edge {
  std::int32_t from, to;
  const double *transform, *information;
  double width;
};

// Error of an edge (3), and its derivatives by both nodes.
void linearize(const Edge &edge, const double *poses, double *error, Matrix3 *by_from, Matrix3 *by_to) {
  const double *a = poses + 3 * edge.from, *b = poses + 3 * edge.to, *z = edge.transform;
  const double cos = std::cos(a[2]), sin = std::sin(a[2]), dx = b[0] - a[0], dy = b[1] - a[1];
  error[0] = cos * dx + sin * dy - z[0];
  error[1] = -sin * dx + cos * dy - z[1];
  error[2] = std::remainder(b[2] - a[2] - z[2], 2.0 * kPi);
  if (!by_from) return;
  *by_from = {-cos, -sin, -sin * dx + cos * dy, sin, -cos, -cos * dx - sin * dy, 0.0, 0.0, -1.0};
  *by_to = {cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0};
}

double squared(const double *error, const double *information) {
  double sum = 0.0;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) sum += error[r] * information[3 * r + c] * error[c];
  }
  return sum;
}

// out += a^T m b
void add_product(Matrix3 &out, const Matrix3 &a, const Matrix3 &m, const Matrix3 &b, double scale) {
  Matrix3 mb{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) mb[3 * r + c] = m[3 * r] * b[c] + m[3 * r + 1] * b[3 + c] + m[3 * r + 2] * b[6 + c];
  }
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out[3 * r + c] += scale * (a[r] * mb[c] + a[3 + r] * mb[3 + c] + a[6 + r] * mb[6 + c]);
  }
}

// A symmetric matrix of blocks, factored as L D L^T with blocks D.
class Factors {
 public:
  // `pairs` are the blocks below the diagonal that are not zero, of free variables.
  Factors(std::int32_t size, const std::vector<std::pair<std::int32_t, std::int32_t>> &pairs) : size_(size) {
    order(pairs);
  }

  void clear() {
    std::fill(diagonal.begin(), diagonal.end(), Matrix3{});
    for (auto &column : values_) std::fill(column.begin(), column.end(), Matrix3{});
  }

  void add_diagonal(std::int32_t node, const Matrix3 &block) {
    Matrix3 &to = diagonal[static_cast<std::size_t>(place_[static_cast<std::size_t>(node)])];
    for (int i = 0; i < 9; ++i) to[i] += block[i];
  }

  // Add a block of the rows of `a` and the columns of `b`.
  void add(std::int32_t a, std::int32_t b, const Matrix3 &block) {
    std::int32_t row = place_[static_cast<std::size_t>(a)], col = place_[static_cast<std::size_t>(b)];
    const bool turned = row < col;
    if (turned) std::swap(row, col);
    const auto &rows = rows_[static_cast<std::size_t>(col)];
    const auto at = std::lower_bound(rows.begin(), rows.end(), row) - rows.begin();
    Matrix3 &to = values_[static_cast<std::size_t>(col)][static_cast<std::size_t>(at)];
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) to[3 * r + c] += turned ? block[3 * c + r] : block[3 * r + c];
    }
  }

  // Factor what was added, with a share added to its diagonal; false where it is not positive definite.
  bool factor(double lambda) {
    std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> left(static_cast<std::size_t>(size_));
    std::vector<std::int32_t> where(static_cast<std::size_t>(size_), -1);
    lower_ = values_;
    inverse_.assign(static_cast<std::size_t>(size_), Matrix3{});
    std::vector<Matrix3> pivots(diagonal);
    for (std::int32_t j = 0; j < size_; ++j) {
      const auto at = static_cast<std::size_t>(j);
      auto &rows = rows_[at];
      auto &column = lower_[at];
      for (std::size_t i = 0; i < rows.size(); ++i) where[static_cast<std::size_t>(rows[i])] = static_cast<std::int32_t>(i);
      Matrix3 &pivot = pivots[at];
      for (int i = 0; i < 3; ++i) pivot[4 * i] += lambda * pivot[4 * i] + 1e-12;
      for (const auto &[k, first] : left[at]) {  // columns k whose row j is not zero, at index `first`
        const auto &their = lower_[static_cast<std::size_t>(k)];
        const auto &their_rows = rows_[static_cast<std::size_t>(k)];
        const Matrix3 &mine = their[static_cast<std::size_t>(first)];
        Matrix3 scaled;  // D_k L_jk^T
        const Matrix3 &d = pivots[static_cast<std::size_t>(k)];
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 3; ++c) {
            scaled[3 * r + c] = d[3 * r] * mine[3 * c] + d[3 * r + 1] * mine[3 * c + 1] + d[3 * r + 2] * mine[3 * c + 2];
          }
        }
        for (std::size_t i = static_cast<std::size_t>(first); i < their_rows.size(); ++i) {
          const std::int32_t row = their_rows[i];
          Matrix3 &to = row == j ? pivot : column[static_cast<std::size_t>(where[static_cast<std::size_t>(row)])];
          const Matrix3 &l = their[i];
          for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) {
              to[3 * r + c] -= l[3 * r] * scaled[c] + l[3 * r + 1] * scaled[3 + c] + l[3 * r + 2] * scaled[6 + c];
            }
          }
        }
        const auto next = static_cast<std::size_t>(first) + 1;
        if (next < their_rows.size()) {
          left[static_cast<std::size_t>(their_rows[next])].emplace_back(k, static_cast<std::int32_t>(next));
        }
      }
      pivot[1] = pivot[3], pivot[2] = pivot[6], pivot[5] = pivot[7];
      if (!invert(pivot, inverse_[at])) return false;
      for (Matrix3 &block : column) {  // L_ij = A_ij D_j^-1
        Matrix3 out;
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 3; ++c) {
            out[3 * r + c] = block[3 * r] * inverse_[at][c] + block[3 * r + 1] * inverse_[at][3 + c] +
                             block[3 * r + 2] * inverse_[at][6 + c];
          }
        }
        block = out;
      }
      if (!rows.empty()) left[static_cast<std::size_t>(rows[0])].emplace_back(j, 0);
      std::vector<std::pair<std::int32_t, std::int32_t>>().swap(left[at]);
    }
    return true;
  }

  // Solve for right sides by node; the answer comes in place.
  void solve(std::vector<double> &right) const {
    std::vector<double> x(right.size());
    for (std::int32_t node = 0; node < size_; ++node) {
      std::copy_n(right.data() + 3 * node, 3, x.data() + 3 * place_[static_cast<std::size_t>(node)]);
    }
    for (std::int32_t j = 0; j < size_; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const double *v = x.data() + 3 * j;
      for (std::size_t i = 0; i < rows_[at].size(); ++i) {
        double *to = x.data() + 3 * rows_[at][i];
        const Matrix3 &l = lower_[at][i];
        for (int r = 0; r < 3; ++r) to[r] -= l[3 * r] * v[0] + l[3 * r + 1] * v[1] + l[3 * r + 2] * v[2];
      }
    }
    for (std::int32_t j = size_; j-- > 0;) {
      const auto at = static_cast<std::size_t>(j);
      double *v = x.data() + 3 * j, old[3] = {v[0], v[1], v[2]};
      const Matrix3 &d = inverse_[at];
      for (int r = 0; r < 3; ++r) v[r] = d[3 * r] * old[0] + d[3 * r + 1] * old[1] + d[3 * r + 2] * old[2];
      for (std::size_t i = 0; i < rows_[at].size(); ++i) {
        const double *from = x.data() + 3 * rows_[at][i];
        const Matrix3 &l = lower_[at][i];
        for (int c = 0; c < 3; ++c) v[c] -= l[c] * from[0] + l[3 + c] * from[1] + l[6 + c] * from[2];
      }
    }
    for (std::int32_t node = 0; node < size_; ++node) {
      std::copy_n(x.data() + 3 * place_[static_cast<std::size_t>(node)], 3, right.data() + 3 * node);
    }
  }

  std::vector<Matrix3> diagonal;

 private:
  void order(const std::vector<std::pair<std::int32_t, std::int32_t>> &pairs) {
    const auto size = static_cast<std::size_t>(size_);
    std::vector<std::vector<std::int32_t>> beside(size);
    for (const auto &[a, b] : pairs) beside[static_cast<std::size_t>(a)].push_back(b), beside[static_cast<std::size_t>(b)].push_back(a);
    for (auto &one : beside) {
      std::sort(one.begin(), one.end());
      one.erase(std::unique(one.begin(), one.end()), one.end());
    }
    using Entry = std::pair<std::size_t, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::size_t i = 0; i < size; ++i) queue.emplace(beside[i].size(), static_cast<std::int32_t>(i));
    place_.assign(size, -1);
    std::vector<std::vector<std::int32_t>> columns;
    std::int32_t done = 0;
    std::vector<std::int32_t> merged;
    while (!queue.empty()) {
      const auto [degree, node] = queue.top();
      queue.pop();
      const auto at = static_cast<std::size_t>(node);
      if (place_[at] >= 0 || degree != beside[at].size()) continue;
      place_[at] = done++;
      const std::vector<std::int32_t> round = std::move(beside[at]);
      beside[at].clear();
      for (const std::int32_t other : round) {
        auto &theirs = beside[static_cast<std::size_t>(other)];
        merged.clear();
        std::set_union(theirs.begin(), theirs.end(), round.begin(), round.end(), std::back_inserter(merged));
        merged.erase(std::remove_if(merged.begin(), merged.end(), [&](std::int32_t one) { return one == other || one == node; }),
                     merged.end());
        theirs = merged;
        queue.emplace(theirs.size(), other);
      }
      columns.push_back(round);
    }
    rows_.resize(size);
    values_.resize(size);
    diagonal.assign(size, Matrix3{});
    for (std::size_t j = 0; j < size; ++j) {
      for (const std::int32_t node : columns[j]) rows_[j].push_back(place_[static_cast<std::size_t>(node)]);
      std::sort(rows_[j].begin(), rows_[j].end());
      values_[j].assign(rows_[j].size(), Matrix3{});
    }
  }

  std::int32_t size_;
  std::vector<std::int32_t> place_;
  std::vector<std::vector<std::int32_t>> rows_;
  std::vector<std::vector<Matrix3>> values_, lower_;
  std::vector<Matrix3> inverse_;
};

double robust_cost(double chi2, double width) {
  return width > 0.0 ? width * width * chi2 / (width * width + chi2) : chi2;
}

double total_cost(const std::vector<Edge> &edges, const double *poses, double *each) {
  double sum = 0.0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    double error[3];
    linearize(edges[i], poses, error, nullptr, nullptr);
    each[i] = squared(error, edges[i].information);
    sum += robust_cost(each[i], edges[i].width);
  }
  return sum;
}

}  // namespace

nb::tuple solve_graph(In<double, 2> poses, In<std::int32_t, 2> edges, In<double, 2> transforms,
                      In<double, 3> information, In<double, 1> widths, In<std::uint8_t, 1> fixed,
                      std::int64_t iterations) {
  check_poses(poses);
  const std::size_t nodes = poses.shape(0), count = edges.shape(0);
  refuse_unless(nodes > 0 && nodes < 10'000'000, "a graph needs nodes, at most 10 million");
  refuse_unless(edges.shape(1) == 2, "edges need shape (E, 2)");
  refuse_unless(transforms.shape(0) == count && transforms.shape(1) == 3, "each edge needs a transform, shape (E, 3)");
  refuse_far(transforms.data(), transforms.size(), "the transforms must be finite");
  refuse_unless(information.shape(0) == count && information.shape(1) == 3 && information.shape(2) == 3,
                "each edge needs its information, shape (E, 3, 3)");
  for (std::size_t i = 0; i < information.size(); ++i) {
    refuse_unless(std::abs(information.data()[i]) <= 1e15, "the information must be finite");
  }
  refuse_unless(widths.shape(0) == count && fixed.shape(0) == nodes, "each edge needs a width, each node whether it is fixed");
  refuse_unless(iterations >= 1 && iterations <= 1000, "there must be from 1 to 1000 iterations");
  std::vector<Edge> list;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t a = edges.data()[2 * i], b = edges.data()[2 * i + 1];
    refuse_unless(a >= 0 && b >= 0 && static_cast<std::size_t>(a) < nodes && static_cast<std::size_t>(b) < nodes && a != b,
                  "an edge must join two nodes of the graph");
    refuse_unless(widths.data()[i] >= 0.0 && widths.data()[i] <= 1e9, "widths must be 0 or more");
    Matrix3 m, unused;
    std::copy_n(information.data() + 9 * i, 9, m.begin());
    refuse_unless(invert(m, unused), "the information must be positive definite");
    list.push_back({a, b, transforms.data() + 3 * i, information.data() + 9 * i, widths.data()[i]});
  }
  std::vector<double> out(poses.data(), poses.data() + 3 * nodes), each(count, 0.0), told(3, 0.0);
  {
    nb::gil_scoped_release release;
    std::vector<std::int32_t> variable(nodes, -1);
    std::int32_t size = 0;
    for (std::size_t i = 0; i < nodes; ++i) {
      if (!fixed.data()[i]) variable[i] = size++;
    }
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    for (const Edge &edge : list) {
      const std::int32_t a = variable[static_cast<std::size_t>(edge.from)], b = variable[static_cast<std::size_t>(edge.to)];
      if (a >= 0 && b >= 0) pairs.emplace_back(a, b);
    }
    Factors factors(size, pairs);
    double cost = total_cost(list, out.data(), each.data()), lambda = 1e-9;
    told[1] = cost;
    std::int64_t done = 0;
    bool stuck = size == 0;
    for (; done < iterations && !stuck; ++done) {
      factors.clear();
      std::vector<double> right(static_cast<std::size_t>(3 * size), 0.0);
      for (const Edge &edge : list) {
        double e[3];
        Matrix3 ja, jb, m, block;
        linearize(edge, out.data(), e, &ja, &jb);
        std::copy_n(edge.information, 9, m.begin());
        const double chi2 = squared(e, edge.information), w2 = edge.width * edge.width;
        const double share = edge.width > 0.0 ? w2 / (w2 + chi2) : 1.0, weight = share * share;
        const std::int32_t ends[2] = {variable[static_cast<std::size_t>(edge.from)], variable[static_cast<std::size_t>(edge.to)]};
        const Matrix3 *by[2] = {&ja, &jb};
        for (int end = 0; end < 2; ++end) {
          if (ends[end] < 0) continue;
          block = Matrix3{};
          add_product(block, *by[end], m, *by[end], weight);
          factors.add_diagonal(ends[end], block);
          for (int i = 0; i < 3; ++i) {
            for (int r = 0; r < 3; ++r) {
              for (int c = 0; c < 3; ++c) right[static_cast<std::size_t>(3 * ends[end] + i)] -= weight * (*by[end])[3 * r + i] * m[3 * r + c] * e[c];
            }
          }
        }
        if (ends[0] >= 0 && ends[1] >= 0) {
          block = Matrix3{};
          add_product(block, ja, m, jb, weight);
          factors.add(ends[0], ends[1], block);
        }
      }
      bool better = false;
      double largest = 0.0;
      for (int attempt = 0; attempt < 8 && !better; ++attempt) {
        std::vector<double> step(right), next(out);
        if (factors.factor(lambda)) {
          factors.solve(step);
          largest = 0.0;
          bool good = true;
          for (std::size_t i = 0; i < nodes; ++i) {
            if (variable[i] < 0) continue;
            for (int k = 0; k < 3; ++k) {
              const double by = step[static_cast<std::size_t>(3 * variable[i] + k)];
              good = good && std::isfinite(by) && std::abs(next[3 * i + static_cast<std::size_t>(k)] + by) <= kFar;
              next[3 * i + static_cast<std::size_t>(k)] += by;
              largest = std::max(largest, std::abs(by));
            }
          }
          if (good) {
            std::vector<double> errors(count);
            const double after = total_cost(list, next.data(), errors.data());
            if (after <= cost * (1.0 + 1e-12)) {
              better = true;
              stuck = cost - after <= 1e-6 * cost;
              cost = after, out = std::move(next), each = std::move(errors);
              lambda = std::max(1e-9, 0.1 * lambda);
            }
          }
        }
        if (!better) lambda = std::max(1e-6, 10.0 * lambda);
      }
      stuck = stuck || !better || largest < 1e-5;
    }
    for (std::size_t i = 0; i < nodes; ++i) out[3 * i + 2] = std::remainder(out[3 * i + 2], 2.0 * kPi);
    told[0] = static_cast<double>(done), told[2] = cost;
  }
  return nb::make_tuple(to_numpy(std::move(out), {nodes, 3}), to_numpy(std::move(each), {count}),
                        to_numpy(std::move(told), {3}));
}

}  // namespace trundle
