// SPDX-License-Identifier: MIT
//
// mesh_files.h: meshes as the bytes of a file in every encoding, written here without the library's writers so that the
// readers are tested against something else than their own inverse.
#pragma once

#include <alcap/mesh_io.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace mesh_files {

using alcap::Faces;
using alcap::Index;
using alcap::Positions;

struct Encoding {
  const char* name;
  const char* format;
  bool binary;
  bool counted;  // announces how much follows, or ends with a mark
};
inline constexpr std::array<Encoding, 7> encodings = {{{"obj", "obj", false, false},
                                                       {"off", "off", false, true},
                                                       {"ply ascii", "ply", false, true},
                                                       {"ply little endian", "ply", true, true},
                                                       {"ply big endian", "ply", true, true},
                                                       {"stl ascii", "stl", false, true},
                                                       {"stl binary", "stl", true, true}}};

template <class... T>
std::string print(const char* format, T... values) {
  char text[256];
  const int length = std::snprintf(text, sizeof text, format, values...);
  return {text, static_cast<std::size_t>(length)};
}

template <class T>
std::string raw(T value, bool big = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big) std::reverse(bytes.begin(), bytes.end());  // the tests run on little-endian machines
  return bytes;
}

inline std::string ply_header(const char* encoding, Eigen::Index vertices, Eigen::Index faces) {
  return print(
      "ply\nformat %s 1.0\ncomment made by a test\nelement vertex %d\nproperty double x\nproperty double y\n"
      "property double z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n",
      encoding, static_cast<int>(vertices), static_cast<int>(faces));
}

inline std::string rows(const char* point, const Positions<double>& V, const char* face, const Faces& F, int first) {
  std::string out;
  for (Eigen::Index v = 0; v < V.rows(); ++v) out += print(point, V(v, 0), V(v, 1), V(v, 2));
  for (Eigen::Index t = 0; t < F.rows(); ++t) out += print(face, F(t, 0) + first, F(t, 1) + first, F(t, 2) + first);
  return out;
}

/// The mesh in the encoding of that name. STL binary keeps float precision only.
inline std::string encode(const std::string& name, const Positions<double>& V, const Faces& F) {
  const auto nv = static_cast<int>(V.rows()), nf = static_cast<int>(F.rows());
  const char* const point = "%.17g %.17g %.17g\n";
  if (name == "obj") return rows("v %.17g %.17g %.17g\n", V, "f %d %d %d\n", F, 1);
  if (name == "off") return print("OFF\n%d %d 0\n", nv, nf) + rows(point, V, "3 %d %d %d\n", F, 0);
  if (name == "ply ascii") return ply_header("ascii", nv, nf) + rows(point, V, "3 %d %d %d\n", F, 0);
  if (name == "stl ascii") {
    std::string out = "solid test\n";
    for (Eigen::Index t = 0; t < F.rows(); ++t) {
      out += "facet normal 0 0 0\nouter loop\n";
      for (int c = 0; c < 3; ++c) {
        const Index v = F(t, c);
        out += print("vertex %.17g %.17g %.17g\n", V(v, 0), V(v, 1), V(v, 2));
      }
      out += "endloop\nendfacet\n";
    }
    return out + "endsolid test\n";
  }
  if (name == "stl binary") {
    std::string out(80, ' ');
    out.replace(0, 5, "solid");  // as many programs write
    out += raw(static_cast<std::uint32_t>(nf));
    for (Eigen::Index t = 0; t < F.rows(); ++t) {
      for (int i = 0; i < 3; ++i) out += raw(0.0F);
      for (int i = 0; i < 9; ++i) out += raw(static_cast<float>(V(F(t, i / 3), i % 3)));
      out += raw(std::uint16_t{0});
    }
    return out;
  }
  const bool big = name == "ply big endian";
  std::string out = ply_header(big ? "binary_big_endian" : "binary_little_endian", nv, nf);
  for (Eigen::Index i = 0; i < V.size(); ++i) out += raw(V.data()[i], big);
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    out += raw(std::uint8_t{3});
    for (int c = 0; c < 3; ++c) out += raw(static_cast<std::int32_t>(F(t, c)), big);
  }
  return out;
}

/// A random mesh whose vertices appear in the faces in the order of their numbers, as STL hands them out: a strip.
inline void random_strip(std::mt19937_64& random, Index vertices, bool floats, Positions<double>& V, Faces& F) {
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-30, 30);
  V.resize(vertices, 3);
  for (Eigen::Index i = 0; i < V.size(); ++i) {
    const double x = std::ldexp(mantissa(random), exponent(random));
    V.data()[i] = floats ? double{static_cast<float>(x)} : x;
  }
  F.resize(vertices - 2, 3);
  for (Index t = 0; t < F.rows(); ++t) F.row(t) << t, t + 1, t + 2;
}

}  // namespace mesh_files
