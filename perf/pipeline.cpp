// SPDX-License-Identifier: MIT
//
// pipeline.cpp: the phases between a file and a field, and the whole of it in memory.
#include <atomic>
#include <filesystem>
#include <utility>

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

void declare_batches(const perf::Plan& plan);

void declare(const perf::Plan& plan) {
  declare_batches(plan);

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

// As the targets ask: of 2K to 10K triangles, and of about 1K.
std::vector<MeshData> small_meshes() {
  std::vector<MeshData> meshes;
  for (int across = 23; across <= 50; ++across) {
    meshes.push_back(torus_random_diagonals(2 * across, across, 1.0, 0.4, static_cast<std::uint64_t>(across)));
    meshes.push_back(noisy_scan(4, 0.1, static_cast<std::uint64_t>(across)));
  }
  return meshes;
}

std::vector<MeshData> smallest_meshes() {
  std::vector<MeshData> meshes;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    meshes.push_back(torus_random_diagonals(32, 16, 1.0, 0.4, seed));
    meshes.push_back(noisy_scan(3, 0.1, seed));
  }
  return meshes;
}

/// Many meshes, n = 4, to 1e-6: in memory, or each from a PLY file to a PLY file with its field.
void batch(benchmark::State& state, int jobs, const std::vector<MeshData>& meshes, bool files) {
  const auto path = [](std::size_t i, const char* what) {
    return std::filesystem::temp_directory_path() / ("alcap_perf_" + std::to_string(i) + what + ".ply");
  };
  std::int64_t faces = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    faces += meshes[i].F.rows();
    if (files) write_mesh(path(i, "_mesh"), meshes[i].V, meshes[i].F);
  }
  std::atomic<int> bad{0};
  const auto one = [&](Context& context, std::int64_t which) {
    const auto i = static_cast<std::size_t>(which);
    if (!files) {
      if (!context.run(meshes[i].V, meshes[i].F).certificate.holds()) ++bad;
      return;
    }
    MeshFile mesh = read_mesh(path(i, "_mesh"));
    const FieldRun& run = context.run(std::move(mesh.V), std::move(mesh.F));
    if (!run.certificate.holds()) ++bad;
    (void)write_field({run.surface, run.field, run.singularities}, path(i, "_field"));
  };
  for (auto _ : state)
    run_batch(static_cast<std::int64_t>(meshes.size()), {.field = {.n = 4, .eigen = {.tolerance = 1e-6}}, .jobs = jobs},
              one, [&](std::int64_t, const std::exception&) { ++bad; });
  state.counters["meshes/s"] = benchmark::Counter(double(meshes.size()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["faces"] = double(faces) / double(meshes.size());
  state.counters["bad"] = bad.load();
  for (std::size_t i = 0; files && i < meshes.size(); ++i)
    for (const char* const what : {"_mesh", "_field"}) std::filesystem::remove(path(i, what));
}

void declare_batches(const perf::Plan& plan) {
  const auto declare_batch = [&](const std::string& name, std::vector<MeshData> (*meshes)(), bool files) {
    for (const int threads : plan.threads)
      benchmark::RegisterBenchmark((name + "/threads:" + std::to_string(threads)).c_str(),
                                   [=](benchmark::State& state) { batch(state, threads, meshes(), files); })
          ->UseRealTime()
          ->MeasureProcessCPUTime()
          ->Unit(benchmark::kMillisecond);
  };
  declare_batch("batch", small_meshes, false);
  declare_batch("batch_files", small_meshes, true);
  declare_batch("batch_1k", smallest_meshes, false);
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
