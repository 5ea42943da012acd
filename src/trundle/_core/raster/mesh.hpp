// What the rasters of triangle meshes share: whether a mesh is closed, the volume it encloses, and its faces in the
// map.
#pragma once

#include "raster/kernels.hpp"
#include "raster/raster.hpp"

#include <array>

namespace trundle {

constexpr std::int8_t kPending = 99;  // Touched by a face without thickness; occupied in the end.

inline void prefetch(const void *address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#else
  (void)address;
#endif
}

inline std::uint64_t mix(std::uint64_t value) {  // The finaliser of splitmix64 (Steele, Lea and Flood 2014).
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

// A double's bits, so folded that round numbers do not end in zeros; -0 is 0.
inline std::uint64_t folded(double value) {
  value += 0.0;
  std::uint64_t word;
  std::memcpy(&word, &value, sizeof word);
  return word ^ (word >> 32);
}

inline void check_mesh(const Vertices &vertices, const Faces &faces, const In<double, 2> &transform) {
  if (vertices.shape(1) != 3 || faces.shape(1) != 3) throw std::invalid_argument("vertices and faces need shape (N, 3)");
  if (transform.shape(0) != 3 || transform.shape(1) != 4) throw std::invalid_argument("a transform needs shape (3, 4)");
  const std::int32_t *corner = faces.data();
  bool inside = true;
  for (std::size_t i = 0; i < faces.size(); ++i)
    inside &= corner[i] >= 0 && static_cast<std::size_t>(corner[i]) < vertices.shape(0);
  if (!inside) throw std::invalid_argument("a face names a vertex that is not there");
}

// Whether each edge runs as often in one direction as in the other, by the sum over the edges of a hash that changes
// its sign with the direction: it is zero for a closed mesh, and for another one with a chance of about 2^-63. Corners
// are the same where their coordinates are, so that a mesh with separate vertices for each corner is closed too.
inline bool is_closed(const Vertices &vertices, const Faces &faces) {
  std::vector<std::uint64_t> words(vertices.shape(0));
  const double *at = vertices.data();
  for (std::size_t i = 0; i < words.size(); ++i, at += 3)
    words[i] = mix(folded(at[0]) * 0x9e3779b97f4a7c15ULL + folded(at[1]) * 0xc2b2ae3d27d4eb4fULL +
                   folded(at[2]) * 0x165667b19e3779f9ULL);
  const auto turned = [](std::uint64_t word) { return word << 27 | word >> 37; };
  std::uint64_t sum = 0;
  const std::int32_t *face = faces.data();
  for (std::size_t i = 0; i < faces.shape(0); ++i, face += 3) {
    const std::uint64_t a = words[static_cast<std::size_t>(face[0])], b = words[static_cast<std::size_t>(face[1])],
                        c = words[static_cast<std::size_t>(face[2])];
    const std::uint64_t a_turned = turned(a), b_turned = turned(b), c_turned = turned(c);
    sum += a * b_turned - b * a_turned + b * c_turned - c * b_turned + c * a_turned - a * c_turned;
  }
  return sum == 0;
}

// Six times the volume that a closed mesh encloses, negative where its faces look inward.
inline double enclosed(const Vertices &vertices, const Faces &faces) {
  const double *from = vertices.data();
  const auto corner = [&](std::int32_t index) {
    const double *v = from + 3 * static_cast<std::size_t>(index);
    return Point3{v[0] - from[0], v[1] - from[1], v[2] - from[2]};
  };
  double volume = 0.0;
  const std::int32_t *face = faces.data();
  for (std::size_t i = 0; i < faces.shape(0); ++i, face += 3) {
    const Point3 a = corner(face[0]), b = corner(face[1]), c = corner(face[2]);
    volume += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  return volume;
}

// The faces of a mesh, x and y in cells, z in metres; the same corner always comes out bit for bit the same.
class Placed {
 public:
  Placed(const Vertices &vertices, const Faces &faces, const In<double, 2> &transform, double resolution)
      : vertices_(vertices.data()), faces_(faces.data()) {
    for (std::size_t i = 0; i < 12; ++i) matrix_[i] = transform.data()[i] / (i < 8 ? resolution : 1.0);
  }

  // Ask for the memory of a face that will be placed soon, first for its indices, then for its corners.
  void fetch_face(std::size_t index) const { prefetch(faces_ + 3 * index); }
  void fetch_corners(std::size_t index) const {
    for (std::size_t j = 0; j < 3; ++j) prefetch(vertices_ + 3 * static_cast<std::size_t>(faces_[3 * index + j]));
  }

  // Place a face that reaches into heights from low to high; false for another one.
  bool place(std::size_t index, double low, double high, std::array<Point3, 3> &corners) const {
    const std::int32_t *face = faces_ + 3 * index;
    std::array<const double *, 3> v;
    const double *m = matrix_.data();
    for (std::size_t j = 0; j < 3; ++j) {
      v[j] = vertices_ + 3 * static_cast<std::size_t>(face[j]);
      corners[j].z = m[8] * v[j][0] + m[9] * v[j][1] + m[10] * v[j][2] + m[11];
    }
    if (corners[0].z < low && corners[1].z < low && corners[2].z < low) return false;
    if (corners[0].z > high && corners[1].z > high && corners[2].z > high) return false;
    for (std::size_t j = 0; j < 3; ++j) {
      corners[j].x = m[0] * v[j][0] + m[1] * v[j][1] + m[2] * v[j][2] + m[3];
      corners[j].y = m[4] * v[j][0] + m[5] * v[j][1] + m[6] * v[j][2] + m[7];
    }
    return true;
  }

 private:
  const double *vertices_;
  const std::int32_t *faces_;
  std::array<double, 12> matrix_;
};

}  // namespace trundle
