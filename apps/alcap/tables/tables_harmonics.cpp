// SPDX-License-Identifier: MIT
//
// tables_harmonics.cpp: Y_lm = N_lm (d^m P_l / dz^m)(z) Re or Im of (x + iy)^m, polynomials in x, y, z.
#include "apps/alcap/tables/tables_harmonics.h"

#include <complex>
#include <numbers>

#include "src/base/random.h"

namespace alcap::app {
namespace {

constexpr int max_degree = 6;

// d^m P_l / dz^m for l, m <= max_degree, and m one more for derivatives.
struct Legendre {
  double d[max_degree + 1][max_degree + 2] = {};
  explicit Legendre(double z) {
    double diagonal = 1;
    for (int m = 0; m <= max_degree; ++m) {
      d[m][m] = diagonal;
      if (m < max_degree) d[m + 1][m] = (2 * m + 1) * z * diagonal;
      for (int l = m + 2; l <= max_degree; ++l)
        d[l][m] = ((2 * l - 1) * z * d[l - 1][m] - (l + m - 1) * d[l - 2][m]) / (l - m);
      diagonal *= 2 * m + 1;
    }
  }
};

double norm(int l, int m) {
  double ratio = 1;  // (l-m)! / (l+m)!
  for (int i = l - m + 1; i <= l + m; ++i) ratio /= i;
  return std::sqrt((2 * l + 1) / (4 * std::numbers::pi) * ratio * (m > 0 ? 2 : 1));
}

// Calls body(k, N, l, |m|, whether the imaginary part) for the first `count` harmonics.
template <class Body>
void for_each_harmonic(Eigen::Index count, Body&& body) {
  Eigen::Index k = 0;
  for (int l = 1; k < count; ++l)
    for (int m = -l; m <= l && k < count; ++m, ++k) body(k, norm(l, std::abs(m)), l, std::abs(m), m < 0);
}

struct Powers {
  std::complex<double> z[max_degree + 1];  // (x + iy)^m
  explicit Powers(std::complex<double> xy) {
    z[0] = 1;
    for (int m = 1; m <= max_degree; ++m) z[m] = z[m - 1] * xy;
  }
};

double part(std::complex<double> z, bool imaginary) { return imaginary ? z.imag() : z.real(); }

}  // namespace

void harmonics(const Eigen::RowVector3d& p, Eigen::Ref<Eigen::VectorXd> values) {
  const Legendre legendre(p.z());
  const Powers powers({p.x(), p.y()});
  for_each_harmonic(values.size(), [&](Eigen::Index k, double N, int l, int m, bool imaginary) {
    values[k] = N * legendre.d[l][m] * part(powers.z[m], imaginary);
  });
}

void harmonic_gradients(const Eigen::RowVector3d& p, Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> gradients) {
  const Legendre legendre(p.z());
  const Powers powers({p.x(), p.y()});
  for_each_harmonic(gradients.rows(), [&](Eigen::Index k, double N, int l, int m, bool imaginary) {
    const double scale = N / std::sqrt(l * (l + 1.0));
    const std::complex<double> slope = m > 0 ? double(m) * powers.z[m - 1] : 0.0;
    Eigen::RowVector3d g(legendre.d[l][m] * part(slope, imaginary),
                         legendre.d[l][m] * part(std::complex<double>(0, 1) * slope, imaginary),
                         legendre.d[l][m + 1] * part(powers.z[m], imaginary));
    g *= scale;
    gradients.row(k) = g - g.dot(p) * p;
  });
}

Eigen::MatrixXcd random_coefficients(int count, int fields, std::uint64_t seed) {
  detail::Random random(seed);
  Eigen::MatrixXcd c(count, fields);
  for (Eigen::Index f = 0; f < fields; ++f) {
    for (Eigen::Index k = 0; k < count; ++k) {  // Box and Muller 1958: both parts are independent Gaussians
      const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
      c(k, f) = std::polar(radius, random.uniform(0, 2 * std::numbers::pi));
    }
    c.col(f).normalize();
  }
  return c;
}

}  // namespace alcap::app
