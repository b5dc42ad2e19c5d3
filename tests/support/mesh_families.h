// SPDX-License-Identifier: MIT
//
// mesh_families.h: one small mesh of every kind: closed, with boundary, of higher genus, in pieces, obtuse, with
// needles and holes. Tests that hold for every mesh run over them.
#pragma once

#include <string>
#include <vector>

#include "tests/support/mesh_helpers.h"

namespace alcap::test {

struct Family {
  std::string name;
  MeshData surface;
};

/// `level` 2 has 100 to 300 vertices, each level more four times as many; the smallest shapes stay as they are.
inline std::vector<Family> mesh_families(int level) {
  const int f = 1 << level;
  return {
      {"triangle", single_triangle()},
      {"tetrahedron", tetrahedron()},
      {"cube", cube()},
      {"icosphere", icosphere(level)},
      {"jittered sphere", jittered_sphere(level, 0.2, 1)},
      {"bumpy sphere", bumpy_sphere(level, 0.3, 5)},
      {"torus", torus(4 * f, 2 * f, 1, 0.4)},
      {"torus, random diagonals", torus_random_diagonals(4 * f, 2 * f, 1, 0.4, 2)},
      {"genus 2", genus_surface(2, f / 4)},
      {"grid", grid(3 * f, 2 * f, 3, 2)},
      {"obtuse grid", grid(3 * f, 2 * f, 12, 2)},
      {"disk", disk(2 * f)},
      {"fan", fan(12 * f)},
      {"cylinder", cylinder(4 * f, 3 * f)},
      {"stepped shaft", cad_like(4 * f, f)},
      {"scan", noisy_scan(level < 3 ? 3 : level, 0.2, 3)},
      {"two pieces", together(jittered_sphere(level - 1, 0.1, 4), torus(3 * f, f, 1, 0.3))},
      {"shuffled sphere",
       relabelled(bumpy_sphere(level, 0.2, 4), random_order(10 * f * f + 2, 7), random_order(20 * f * f, 8))},
  };
}

}  // namespace alcap::test
