// SPDX-License-Identifier: MIT
//
// Prints the smallest eigenvalues of fields on generated meshes to their last digit, for scripts/arm64.sh, which
// compares them with those of another processor. Connections are solved as far as rounding allows: where the default
// tolerance ends them depends on the last digits.
#include <cstdio>

#include "alcap/field_run.h"
#include "alcap/generators.h"

int main() {
  using namespace alcap;
  const struct {
    const char* name;
    MeshData mesh;
  } shapes[] = {{"icosphere", icosphere(3)},
                {"jittered", jittered_sphere(4, 0.2, 1)},
                {"torus", torus(30, 15, 1, 0.4)},
                {"genus", genus_surface(2, 8)},
                {"disk", disk(12)},
                {"cylinder", cylinder(30, 12)}};
  for (const auto& [name, mesh] : shapes) {
    for (const int n : {1, 2, 4, 6}) {
      for (const ConnectionKind kind : {ConnectionKind::global, ConnectionKind::local}) {
        const FieldRun run = run_field(
            mesh.V, mesh.F,
            {.n = n, .connection = {.kind = kind, .global = {.tolerance = 1e-12}}, .eigen = {.tolerance = 1e-11}});
        std::printf("%s %d %d %.17g\n", name, n, static_cast<int>(kind), run.eigen[0].lambda);
      }
    }
  }
}
