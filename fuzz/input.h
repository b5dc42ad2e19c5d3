// SPDX-License-Identifier: MIT
//
// input.h: numbers from the bytes that a fuzzer gives, and what every target demands.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "alcap/generators.h"

namespace alcap::fuzz {

/// Ends the program, which is what a fuzzer looks for.
inline void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

/// Numbers from bytes; zeros behind the last one.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  [[nodiscard]] unsigned byte() { return at_ < size_ ? data_[at_++] : 0U; }
  /// In [0, count).
  [[nodiscard]] int below(int count) {
    return static_cast<int>((byte() * 256 + byte()) % static_cast<unsigned>(count));
  }
  /// In [-1, 1].
  [[nodiscard]] double real() { return (byte() * 256 + byte()) / 32767.5 - 1; }
  /// Between 10^-power and 10^power.
  [[nodiscard]] double scale(double power) { return std::pow(10.0, power * real()); }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

/// A small mesh: a generated shape, stretched, with some vertices moved and some faces left out.
inline MeshData small_mesh(Bytes& in) {
  MeshData m;
  switch (in.below(9)) {
    case 0:
      m = tetrahedron();
      break;
    case 1:
      m = cube();
      break;
    case 2:
      m = icosphere(in.below(3));
      break;
    case 3:
      m = torus(3 + in.below(8), 3 + in.below(6), 1, 0.4);
      break;
    case 4:
      m = grid(1 + in.below(6), 1 + in.below(6));
      break;
    case 5:
      m = disk(1 + in.below(4));
      break;
    case 6:
      m = cylinder(3 + in.below(12), 1 + in.below(4));
      break;
    case 7:
      m = genus_surface(1 + in.below(2), 2);
      break;
    default:
      m = fan(3 + in.below(20));
      break;
  }
  const double stretch[3] = {in.scale(4), in.scale(4), in.scale(4)};
  for (int c = 0; c < 3; ++c) m.V.col(c) *= stretch[c];
  for (int k = in.below(6); k > 0; --k) {
    const Eigen::Index v = in.below(static_cast<int>(m.V.rows()));
    for (int c = 0; c < 3; ++c) m.V(v, c) += stretch[c] * in.real();
  }
  std::vector<Eigen::Index> kept;
  const int gone = in.below(4), first = in.below(static_cast<int>(m.F.rows()));
  for (Eigen::Index t = 0; t < m.F.rows(); ++t)
    if (t < first || t >= first + gone) kept.push_back(t);
  if (!kept.empty()) m.F = Faces(m.F(kept, Eigen::all));
  m.V *= in.scale(50);
  return m;
}

}  // namespace alcap::fuzz
