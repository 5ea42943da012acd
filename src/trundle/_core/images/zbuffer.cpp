// Triangles drawn into a depth buffer: a picture of a scene without a graphics driver.
#include "images/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace trundle {
namespace {

// In the camera's frame: x to the right, y up, z forward.
struct Vertex {
  double x, y, z;
};

// On the picture: pixels to the right and down, and a nearness that is linear there and grows towards the camera.
struct Spot {
  double x, y, near;
};

struct View {
  double scale;  // pixels per unit of x / z (perspective) or of x (parallel)
  double near;   // least z that is drawn (perspective)
  bool perspective;
};

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

class ZBuffer {
 public:
  ZBuffer(std::int64_t width, std::int64_t height)
      : width_(width),
        height_(height),
        faces_(static_cast<std::size_t>(width * height), -1),
        near_(faces_.size(), -std::numeric_limits<double>::infinity()) {}

  void add(const Vertex *corners, std::int32_t face, const View &view) {
    // A triangle cut by the near plane has up to four corners.
    std::array<Vertex, 4> polygon;
    const std::size_t count = view.perspective ? clip(corners, view.near, polygon) : 3;
    if (!view.perspective) std::copy(corners, corners + 3, polygon.begin());
    if (count < 3) return;
    std::array<Spot, 4> spots;
    for (std::size_t i = 0; i < count; ++i) spots[i] = project(polygon[i], view);
    for (std::size_t i = 2; i < count; ++i) draw(spots[0], spots[i - 1], spots[i], face);
  }

  // Nearness back to z; what nothing was drawn on is infinitely far.
  std::vector<double> depths(bool perspective) const {
    std::vector<double> out(near_.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = faces_[i] < 0 ? std::numeric_limits<double>::infinity() : (perspective ? 1.0 / near_[i] : -near_[i]);
    return out;
  }

  std::vector<std::int32_t> take_faces() { return std::move(faces_); }

 private:
  static std::size_t clip(const Vertex *corners, double near, std::array<Vertex, 4> &out) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex &a = corners[i], &b = corners[(i + 1) % 3];
      if (a.z >= near) out[count++] = a;
      if ((a.z >= near) != (b.z >= near)) {
        const double share = (near - a.z) / (b.z - a.z);
        out[count++] = {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), near};
      }
    }
    return count;
  }

  Spot project(const Vertex &v, const View &view) const {
    const double scale = view.perspective ? view.scale / v.z : view.scale;
    return {0.5 * static_cast<double>(width_) + scale * v.x, 0.5 * static_cast<double>(height_) - scale * v.y,
            view.perspective ? 1.0 / v.z : -v.z};
  }

  void draw(const Spot &a, Spot b, Spot c, std::int32_t face) {
    double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (!(std::abs(area) > 1e-12) || !std::isfinite(area)) return;
    if (area < 0.0) {
      std::swap(b, c);
      area = -area;
    }
    const double along_x = ((b.near - a.near) * (c.y - a.y) - (c.near - a.near) * (b.y - a.y)) / area;
    const double along_y = ((c.near - a.near) * (b.x - a.x) - (b.near - a.near) * (c.x - a.x)) / area;
    const std::int64_t top = pixel(std::min({a.y, b.y, c.y}), height_), bottom = pixel(std::max({a.y, b.y, c.y}), height_);
    for (std::int64_t row = top; row < bottom; ++row) {
      const double y = static_cast<double>(row) + 0.5;
      double left = std::min({a.x, b.x, c.x}), right = std::max({a.x, b.x, c.x});
      narrow(a, b, y, left, right);
      narrow(b, c, y, left, right);
      narrow(c, a, y, left, right);
      if (!(left <= right)) continue;
      const std::int64_t first = pixel(left, width_), last = pixel(right, width_);
      double near = a.near + along_x * (static_cast<double>(first) + 0.5 - a.x) + along_y * (y - a.y);
      const std::size_t begin = static_cast<std::size_t>(row * width_);
      for (std::int64_t col = first; col < last; ++col, near += along_x) {
        const std::size_t at = begin + static_cast<std::size_t>(col);
        if (near > near_[at]) {
          near_[at] = near;
          faces_[at] = face;
        }
      }
    }
  }

  // Keep the part of a line of pixels that is on the inner side of the edge from a to b.
  static void narrow(const Spot &a, const Spot &b, double y, double &left, double &right) {
    const double rise = b.y - a.y;
    if (rise == 0.0) {
      if ((b.x - a.x) * (y - a.y) < 0.0) right = left - 1.0;
      return;
    }
    // From the lower end, so that both triangles at an edge get the same x and leave no pixel between them.
    const Spot &low = rise > 0.0 ? a : b, &high = rise > 0.0 ? b : a;
    const double x = low.x + (high.x - low.x) * (y - low.y) / (high.y - low.y);
    if (rise < 0.0)
      left = std::max(left, x);
    else
      right = std::min(right, x);
  }

  // First pixel whose centre is not before a coordinate, clamped to the picture.
  static std::int64_t pixel(double at, std::int64_t count) {
    return static_cast<std::int64_t>(std::ceil(std::min(std::max(at - 0.5, 0.0), static_cast<double>(count))));
  }

  std::int64_t width_, height_;
  std::vector<std::int32_t> faces_;
  std::vector<double> near_;
};

}  // namespace

nb::tuple draw_triangles(In<double, 3> triangles, std::int64_t width, std::int64_t height, double scale, double near,
                         bool perspective) {
  if (triangles.shape(1) != 3 || triangles.shape(2) != 3) throw std::invalid_argument("triangles need shape (N, 3, 3)");
  if (width < 1 || height < 1 || width > kMaxPixels / height) throw std::invalid_argument("a picture needs 1 to 2^28 pixels");
  if (!(scale > 0.0) || !(near > 0.0)) throw std::invalid_argument("a view needs a positive scale and near distance");
  if (triangles.shape(0) > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw std::invalid_argument("too many triangles");
  std::vector<std::int32_t> faces;
  std::vector<double> depths;
  {
    nb::gil_scoped_release released;
    ZBuffer buffer(width, height);
    const View view{scale, near, perspective};
    for (std::size_t i = 0; i < triangles.shape(0); ++i) {
      const double *at = triangles.data() + 9 * i;
      const Vertex corners[3] = {{at[0], at[1], at[2]}, {at[3], at[4], at[5]}, {at[6], at[7], at[8]}};
      buffer.add(corners, static_cast<std::int32_t>(i), view);
    }
    depths = buffer.depths(perspective);
    faces = buffer.take_faces();
  }
  const auto rows = static_cast<std::size_t>(height), cols = static_cast<std::size_t>(width);
  return nb::make_tuple(to_numpy(std::move(faces), {rows, cols}), to_numpy(std::move(depths), {rows, cols}));
}

}  // namespace trundle
