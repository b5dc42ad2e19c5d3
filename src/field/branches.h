// SPDX-License-Identifier: MIT
//
// branches.h: the n branches of n-vectors. They are products of one root with n-th roots of unity, and exact where
// symmetry allows: quarter turns swap components, and the second half of an even number of branches is the opposite of
// the first. Internal.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "alcap/field.h"

namespace alcap::detail {

[[nodiscard]] inline bool squares_safely(double square) {
  constexpr double digits = std::numeric_limits<double>::epsilon() * std::numeric_limits<double>::epsilon();
  return square > std::numeric_limits<double>::min() / digits && square < std::numeric_limits<double>::max() * digits;
}

/// std::sqrt(z), several times faster where squares neither overflow nor lose digits.
[[nodiscard]] inline Complex<double> square_root(const Complex<double>& z) {
  const double x = z.real(), y = z.imag(), square = x * x + y * y;
  if (!squares_safely(square)) return std::sqrt(z);
  const double large = std::sqrt((std::sqrt(square) + std::abs(x)) / 2), small = y / (2 * large);
  return x >= 0 ? Complex<double>(large, small) : Complex<double>(std::abs(small), std::copysign(large, y));
}

/// The n-th root of z with the argument arg(z) / n.
[[nodiscard]] inline Complex<double> principal_root(const Complex<double>& z, int n) {
  switch (n) {
    case 1:
      return z;
    case 2:
      return square_root(z);
    case 4:
      return square_root(square_root(z));
    default:
      return z == Complex<double>(0)
                 ? z
                 : std::polar(std::pow(std::abs(z), double(1) / double(n)), std::arg(z) / double(n));
  }
}

/// The first of n branches; those after them are their opposites, in the same order.
[[nodiscard]] inline int independent_branches(int n) { return n % 2 == 0 ? n / 2 : n; }

/// exp(2 pi i k / n) for an independent branch k.
[[nodiscard]] inline Complex<double> branch_turn(int k, int n) {
  return 4 * k == n ? Complex<double>(0, 1) : std::polar(double(1), double(2) * pi<double> * double(k) / double(n));
}

/// root * turn without the check for infinities.
[[nodiscard]] inline Complex<double> turned(const Complex<double>& root, const Complex<double>& turn) {
  return {root.real() * turn.real() - root.imag() * turn.imag(), root.real() * turn.imag() + root.imag() * turn.real()};
}

[[nodiscard]] inline Complex<double> opposite(const Complex<double>& z) {
  return {double(0) - z.real(), double(0) - z.imag()};  // 0 - 0 is 0 where -0 would be -0
}

/// The branches of the values of a field.
class Branches {
 public:
  using Row = Eigen::Matrix<double, 1, 3>;

  explicit Branches(int n) : independent_(independent_branches(n)) {
    for (int k = 0; k < independent_; ++k) turns_.push_back(branch_turn(k, n));
  }

  [[nodiscard]] int independent() const { return independent_; }

  /// One element: its branches as vectors in space, exactly 0 where the field is.
  class At {
   public:
    At(const Branches& branches, const Field& field, Index i) : branches_(branches) {
      if (field.u[i] == Complex<double>(0)) return;
      root_ = principal_root(field.u[i], field.n);
      x_ = field.frames->X.row(i);
      y_ = field.frames->Y(i);
    }
    [[nodiscard]] Row vector(int k) const {
      const int half = branches_.independent_;
      const Complex<double> z = turned(root_, branches_.turns_[static_cast<std::size_t>(k < half ? k : k - half)]);
      const Complex<double> w = k < half ? z : opposite(z);
      return w.real() * x_ + w.imag() * y_;
    }

   private:
    const Branches& branches_;
    Complex<double> root_ = 0;
    Row x_ = Row::Zero(), y_ = Row::Zero();
  };
  [[nodiscard]] At at(const Field& field, Index i) const { return At(*this, field, i); }

 private:
  int independent_;
  std::vector<Complex<double>> turns_;
};

}  // namespace alcap::detail
