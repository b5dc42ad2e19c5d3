// SPDX-License-Identifier: MIT
//
// test_same_bits.cpp: fields of every connection, aligned fields, modes, designs and curves have the same bits for 1,
// 2, 4 and 8 threads, with factorisations too where BLAS has one thread; and when several are made at the same time.
#include <doctest/doctest.h>

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/design_run.h"
#include "alcap/designer.h"
#include "alcap/streamlines.h"
#include "src/base/parallel.h"
#include "tests/support/mesh_helpers.h"

#ifdef __linux__
#include <dlfcn.h>
#endif

using namespace alcap;

namespace {

struct Job {
  const char* name;
  std::function<std::string(int threads)> run;
};

template <class Matrix>
std::string bytes(const Matrix& m) {
  return {reinterpret_cast<const char*>(m.data()), static_cast<std::size_t>(m.size()) * sizeof(m.data()[0])};
}

Job field_job(const char* name, const MeshData& mesh, const FieldRunOptions& options) {
  return {name, [&mesh, options](int threads) {
            FieldRunOptions o = options;
            o.threads = threads;
            const FieldRun run = run_field(mesh.V, mesh.F, o);
            std::string all = bytes(run.field.u) + bytes(run.connection().rho) + bytes(run.connection().K);
            all += bytes(run.modes.lambda);
            return all;
          }};
}

std::vector<Job> field_jobs(const MeshData& mesh, const MeshData& open) {
  using enum ConnectionKind;
  return {
      field_job("global", mesh, {.n = 4}),
      field_job("local, multigrid", mesh,
                {.n = 2, .connection = {.kind = local}, .eigen = {.solver = "multigrid", .method = "lobpcg"}}),
      field_job("polar", open, {.n = 1, .connection = {.kind = polar}}),
      field_job("trivial", mesh, {.n = 4, .connection = {.kind = trivial, .balance_cones = true}}),
      field_job("modes", mesh, {.n = 4, .modes = 3}),
      field_job("aligned", open, {.n = 4, .align = FieldAlignment{}}),
  };
}

std::string design_bytes(const Surface& surface, const char* text, int threads) {
  const DesignRun run = run_design(surface, parse_design(text), {.threads = threads});
  std::string all = bytes(run.field.u);
  run_with_threads(threads, [&] {
    all += bytes(streamlines(run.surface, run.field, {.spacing = 0.05}).points);
    all += bytes(separatrices(run.surface, run.field, run.singularities).points);
  });
  return all;
}

std::vector<Job> design_jobs(const Surface& surface) {
  return {
      {"design",
       [&](int threads) {
         return design_bytes(surface, R"({"alcap_design":1,"n":4,"singularities":[{"face":5,"kind":"saddle"}],
           "strokes":[{"vertices":[0,300]}],"guidance":{"field":"smoothest","weight":0.5}})",
                             threads);
       }},
      {"eigen design",
       [&](int threads) {
         return design_bytes(surface, R"({"alcap_design":1,"n":2,"method":"eigen",
           "singularities":[{"face":700,"kind":"wedge"}]})",
                             threads);
       }},
  };
}

void check_same(const std::vector<Job>& jobs) {
  for (const Job& job : jobs) {
    CAPTURE(std::string(job.name));
    const std::string one = job.run(1);
    for (const int threads : {2, 4, 8}) {
      CAPTURE(threads);
      CHECK((job.run(threads) == one));
    }
  }
}

/// The last bits of a factorisation depend on the threads of BLAS.
void one_blas_thread() {
#ifdef __linux__
  using Set = void (*)(int);
  if (void* const found = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<Set>(found)(1);
#endif
}

}  // namespace

TEST_CASE("fields have the same bits for 1, 2, 4 and 8 threads") {
  one_blas_thread();
  const MeshData mesh = jittered_sphere(5, 0.2, 1), open = grid(90, 70);
  check_same(field_jobs(mesh, open));
}

TEST_CASE("designs and curves have the same bits for 1, 2, 4 and 8 threads") {
  one_blas_thread();
  const MeshData mesh = jittered_sphere(5, 0.2, 1);
  const Surface surface(mesh.V, mesh.F);
  check_same(design_jobs(surface));
}

TEST_CASE("designs made at the same time on one surface, from threads of the caller, have the bits of each alone") {
  one_blas_thread();
  const MeshData mesh = jittered_sphere(3, 0.2, 1);
  const Surface surface(mesh.V, mesh.F);  // the same for all, with what it computes when it is first asked
  const ConnectedSurface connected = connect(surface);
  const auto variational = parse_design(R"({"alcap_design":1,"n":4,"singularities":[{"face":5,"kind":"saddle"}],
    "strokes":[{"vertices":[0,300]}],"guidance":{"field":"smoothest","weight":0.5}})");
  const auto eigen = parse_design(R"({"alcap_design":1,"n":2,"method":"eigen",
    "singularities":[{"face":700,"kind":"wedge"}]})");
  const std::vector<std::function<std::string()>> calls{
      [&] { return bytes(run_design(surface, variational).field.u); },
      [&] { return bytes(run_design(surface, eigen).field.u); },
      [&] {
        Designer designer(connected, {.n = 4, .guidance_weight = 1});
        const ControlId id = designer.add(SingularityTarget{.face = 10, .sign = -1});
        (void)designer.solve();
        designer.set(id, SingularityTarget{.face = 10, .sign = -1, .orientation = 0.3});
        return bytes(designer.solve().field.u);
      },
      [&] {
        const FieldRun run = run_field(surface, {.n = 4});
        return bytes(separatrices(run.surface, run.field, run.singularities).points);
      }};
  std::vector<std::string> alone;
  for (const auto& call : calls) alone.push_back(call());
  constexpr std::size_t rounds = 3;
  std::vector<std::string> together(rounds * calls.size());
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < together.size(); ++k)
    threads.emplace_back([&, k] { together[k] = calls[k % calls.size()](); });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t k = 0; k < together.size(); ++k) {
    CAPTURE(k);
    CHECK((together[k] == alone[k % calls.size()]));
  }
}
