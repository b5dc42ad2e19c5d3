// SPDX-License-Identifier: MIT
//
// phases.cpp: wall-clock time of every phase from file to field, by mesh family and size. Arguments: family, level (a
// level is four times the faces: 3 is 1,280 faces, 6 is 81,920), and n where it matters. Counters: faces per second,
// bytes per second of files, iterations, residual.
//
//   perf_phases --benchmark_filter=connection --benchmark_out=phases.json
#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>

#include "alcap/design.h"
#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/mesh_io.h"
#include "alcap/singularities.h"

namespace {

using namespace alcap;

enum Family { sphere, jittered, doughnut, scan };

Surface make(std::int64_t family, int level) {
  const int across = 4 << level;
  switch (family) {
    case jittered:
      return jittered_sphere(level, 0.2, 1);
    case doughnut:
      return torus_random_diagonals(2 * across, across, 1.0, 0.4, 1);
    case scan:
      return noisy_scan(level, 0.1, 1);
    default:
      return icosphere(level);
  }
}

const char* name(std::int64_t family) {
  static const char* const names[] = {"icosphere", "jittered sphere", "torus, random diagonals", "noisy scan"};
  return names[family];
}

struct Prepared {
  Surface surface;
  Mesh mesh;
  Geometry<double> geometry;
  explicit Prepared(const benchmark::State& state)
      : surface(make(state.range(0), static_cast<int>(state.range(1)))),
        mesh(surface.F, surface.V.rows()),
        geometry(mesh, surface.V) {}
};

void label(benchmark::State& state, Index faces) {
  state.SetLabel(name(state.range(0)));
  state.counters["faces"] = faces;
  state.counters["faces/s"] = benchmark::Counter(double(faces), benchmark::Counter::kIsIterationInvariantRate);
}

void read(benchmark::State& state, const char* extension) {
  const Surface surface = make(state.range(0), static_cast<int>(state.range(1)));
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / (std::string("alcap_perf_read.") + extension);
  write_mesh(path, surface.V, surface.F);
  for (auto _ : state) benchmark::DoNotOptimize(read_mesh(path));
  label(state, static_cast<Index>(surface.F.rows()));
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(std::filesystem::file_size(path)));
  std::filesystem::remove(path);
}

void half_edges(benchmark::State& state) {
  const Surface surface = make(state.range(0), static_cast<int>(state.range(1)));
  for (auto _ : state) benchmark::DoNotOptimize(Mesh(surface.F, surface.V.rows()));
  label(state, static_cast<Index>(surface.F.rows()));
}

void lengths_and_angles(benchmark::State& state) {
  const Prepared p(state);
  for (auto _ : state) benchmark::DoNotOptimize(Geometry<double>(p.mesh, p.surface.V));
  label(state, p.mesh.faces());
}

void connection(benchmark::State& state) {
  const Prepared p(state);
  Connection<double> c;
  for (auto _ : state) c = globally_optimal(p.mesh, p.geometry);
  label(state, p.mesh.faces());
  state.counters["iterations"] = c.report.iterations;
  state.counters["residual"] = c.report.residual;
}

void assembly(benchmark::State& state) {
  const Prepared p(state);
  const Connection<double> c = locally_optimal(p.mesh, p.geometry);
  const HermitianPattern pattern(p.mesh);
  for (auto _ : state) benchmark::DoNotOptimize(stiffness_and_mass(p.mesh, pattern, p.geometry, c, 4));
  label(state, p.mesh.faces());
}

void eigen_field(benchmark::State& state) {
  const Prepared p(state);
  const Connection<double> c = globally_optimal(p.mesh, p.geometry);
  SmoothestResult result;
  for (auto _ : state)
    result = smoothest_field(p.mesh, p.geometry, c, nullptr, {.n = static_cast<int>(state.range(2))});
  label(state, p.mesh.faces());
  state.counters["iterations"] = result.components.front().iterations;
  state.counters["residual"] = result.components.front().residual;
}

void singularities(benchmark::State& state) {
  const Prepared p(state);
  const Connection<double> c = globally_optimal(p.mesh, p.geometry);
  const Field<double> field = smoothest_field(p.mesh, p.geometry, c, nullptr, {.n = 4}).field;
  for (auto _ : state) benchmark::DoNotOptimize(find_singularities(p.mesh, p.geometry, c, field));
  label(state, p.mesh.faces());
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgsProduct({{sphere, jittered, doughnut, scan}, {5, 6, 7}})->UseRealTime()->Unit(benchmark::kMillisecond);
}
void sizes_and_degrees(benchmark::internal::Benchmark* b) {
  b->ArgsProduct({{sphere, jittered, doughnut, scan}, {5, 6}, {1, 4}})->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(read, obj, "obj")->Apply(sizes);
BENCHMARK_CAPTURE(read, off, "off")->Apply(sizes);
BENCHMARK_CAPTURE(read, ply, "ply")->Apply(sizes);
BENCHMARK(half_edges)->Apply(sizes);
BENCHMARK(lengths_and_angles)->Apply(sizes);
BENCHMARK(connection)->Apply(sizes);
BENCHMARK(assembly)->Apply(sizes);
BENCHMARK(eigen_field)->Apply(sizes_and_degrees);
BENCHMARK(singularities)->Apply(sizes);

}  // namespace

BENCHMARK_MAIN();
