// SPDX-License-Identifier: MIT
//
// pipeline.cpp: the phases between a file and a field, and the whole of it in memory.
#include <atomic>
#include <filesystem>

#include "alcap/batch.h"
#include "alcap/mesh_io.h"
#include "alcap/output.h"
#include "alcap/singularities.h"
#include "perf/common.h"

namespace {

using namespace alcap;
using perf::Prepared;

void read(benchmark::State& state, const Prepared& p, int threads, const std::string& extension) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / ("alcap_perf_read." + extension);
  write_mesh(path, p.surface.V, p.surface.F);
  perf::timed(state, threads, [&] { benchmark::DoNotOptimize(read_mesh(path)); });
  perf::bandwidth(state, double(std::filesystem::file_size(path)));
  std::filesystem::remove(path);
}

// Any field will do: that of u = 1 in the frames of the polar map.
Field some_field(const Prepared& p, const Connection& c) {
  return {.n = 4,
          .u = ComplexVectorX<double>::Ones(p.mesh.vertices()),
          .frames = std::make_shared<const Frames>(vertex_frames(p.mesh, p.surface.V, c))};
}

void indices(benchmark::State& state, const Prepared& p, int threads) {
  const Connection c = polar(p.mesh, p.geometry);
  const Field field = some_field(p, c);
  perf::timed(state, threads, [&] { benchmark::DoNotOptimize(find_singularities(p.mesh, p.geometry, c, field)); });
}

void write(benchmark::State& state, const Prepared& p, int threads) {
  const ConnectedSurface surface(Surface(p.surface.V, p.surface.F), polar(p.mesh, p.geometry));
  const Field field = some_field(p, surface.connection());
  const std::vector<Singularity> zeros = find_singularities(surface, field);
  std::vector<std::filesystem::path> files;
  for (const char* const format : {"ply", "vtp", "rawfield", "rosy"})
    files.push_back(std::filesystem::temp_directory_path() / ("alcap_perf_write." + std::string(format)));
  std::vector<std::filesystem::path> written;
  perf::timed(state, threads, [&] { written = write_field({surface, field, zeros}, files); });
  double bytes = 0;
  for (const std::filesystem::path& file : written) {
    bytes += double(std::filesystem::file_size(file));
    std::filesystem::remove(file);
  }
  perf::bandwidth(state, bytes);
}

void batch(benchmark::State& state, int jobs);

void declare(const perf::Plan& plan) {
  for (const int threads : plan.threads)
    benchmark::RegisterBenchmark(("batch/threads:" + std::to_string(threads)).c_str(),
                                 [threads](benchmark::State& state) { batch(state, threads); })
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);

  for (const std::string extension : {"ply", "obj", "off"})
    perf::add(
        plan, "read", "backend:" + extension,
        [extension](benchmark::State& state, const Prepared& p, int threads) { read(state, p, threads, extension); });
  perf::add(plan, "halfedges", "", [](benchmark::State& state, const Prepared& p, int threads) {
    perf::timed(state, threads, [&] { benchmark::DoNotOptimize(Mesh(p.surface.F, p.surface.V.rows())); });
  });
  perf::add(plan, "topology", "", [](benchmark::State& state, const Prepared& p, int threads) {
    perf::timed(state, threads, [&] { benchmark::DoNotOptimize(find_topology(p.mesh)); });
  });
  perf::add(plan, "geometry", "", [](benchmark::State& state, const Prepared& p, int threads) {
    perf::timed(state, threads, [&] { benchmark::DoNotOptimize(Geometry(p.mesh, p.surface.V)); });
  });
  perf::add(plan, "frames", "", [](benchmark::State& state, const Prepared& p, int threads) {
    const Connection c = polar(p.mesh, p.geometry);
    perf::timed(state, threads, [&] { benchmark::DoNotOptimize(vertex_frames(p.mesh, p.surface.V, c)); });
  });
  perf::add(plan, "indices", "", indices);
  perf::add(plan, "write", "", write);
  for (const int n : plan.degrees)
    perf::add(plan, "field", "n:" + std::to_string(n), [n](benchmark::State& state, const Prepared& p, int threads) {
      FieldRun run;
      perf::timed(state, threads,
                  [&] { run = run_field(p.surface.V, p.surface.F, {.n = n, .eigen = {.tolerance = 1e-6}}); });
      const StiffnessMass s = energy_matrices(run.surface, n);
      state.counters["residual"] = perf::eigen_residual(s.S, s.M, run.field.u);
      state.counters["its"] = run.eigen[0].iterations;
      state.counters["mesh s"] = run.times.mesh;
      state.counters["connection s"] = run.times.connection;
      state.counters["assembly s"] = run.times.assembly;
      state.counters["eigen s"] = run.times.eigen;
      state.counters["analysis s"] = run.times.analysis;
    });
}

// Many small meshes in memory, as the target asks: 2K to 10K triangles, n = 4, to 1e-6.
void batch(benchmark::State& state, int jobs) {
  std::vector<MeshData> meshes;
  for (int across = 23; across <= 50; ++across) {
    meshes.push_back(torus_random_diagonals(2 * across, across, 1.0, 0.4, static_cast<std::uint64_t>(across)));
    meshes.push_back(noisy_scan(4, 0.1, static_cast<std::uint64_t>(across)));
  }
  std::int64_t faces = 0;
  for (const MeshData& s : meshes) faces += s.F.rows();
  std::atomic<int> bad{0};
  for (auto _ : state)
    run_batch(
        static_cast<std::int64_t>(meshes.size()), {.field = {.n = 4, .eigen = {.tolerance = 1e-6}}, .jobs = jobs},
        [&](Context& context, std::int64_t i) {
          const MeshData& s = meshes[static_cast<std::size_t>(i)];
          if (!context.run(s.V, s.F).certificate.holds()) ++bad;
        },
        [&](std::int64_t, const std::exception&) { ++bad; });
  state.counters["meshes/s"] = benchmark::Counter(double(meshes.size()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["faces"] = double(faces) / double(meshes.size());
  state.counters["bad"] = bad.load();
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
