// SPDX-License-Identifier: MIT
// From your own arrays to a cross field: float points and unsigned indices in std::vector, three numbers per row.
#include <alcap/alcap.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <vector>

int main() {
  // Your mesh: here a torus of radii 1 and 0.4.
  const std::uint32_t nu = 40, nv = 20;
  std::vector<float> points;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t i = 0; i < nu; ++i) {
    for (std::uint32_t j = 0; j < nv; ++j) {
      const double u = 2 * std::numbers::pi * i / nu, v = 2 * std::numbers::pi * j / nv, r = 1 + 0.4 * std::cos(v);
      for (const double x : {r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v)})
        points.push_back(static_cast<float>(x));
      const std::uint32_t a = i * nv + j, b = (i + 1) % nu * nv + j;
      const std::uint32_t c = (i + 1) % nu * nv + (j + 1) % nv, d = i * nv + (j + 1) % nv;
      for (const std::uint32_t k : {a, b, c, a, c, d}) triangles.push_back(k);
    }
  }

  // The arrays are checked and copied once; an invalid index is an error that names it.
  const alcap::FieldRun run = alcap::run_field(points, triangles, {.n = 4});
  const alcap::Positions<double> first = run.field.vectors(0);  // #V x 3: one of the four directions at each vertex
  const alcap::Positions<double> second = run.field.vectors(1);

  std::cout << "directions at vertex 0: (" << first.row(0) << ") and (" << second.row(0) << ")\n"
            << "smallest eigenvalue: " << run.eigen[0].lambda << "\n"
            << "indices sum to " << static_cast<double>(run.index_sums[0].sum) / 4 << ", expected "
            << static_cast<double>(run.index_sums[0].expected) / 4 << "\n"
            << "certified: " << (run.certificate.holds() ? "yes" : "no") << "\n";
}
