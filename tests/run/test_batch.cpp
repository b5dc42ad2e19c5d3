// SPDX-License-Identifier: MIT
//
// test_batch.cpp: many meshes at once: the same bits as one by one, a bad mesh is its own affair, memory stays flat.
#include <doctest/doctest.h>

#include <atomic>
#include <mutex>
#include <new>
#include <string>

#include "alcap/batch.h"
#include "alcap/generators.h"
#include "alcap/memory.h"

using namespace alcap;

namespace {

std::vector<MeshData> meshes() {
  std::vector<MeshData> all;
  for (int i = 0; i < 12; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    if (i % 3 == 0) all.push_back(jittered_sphere(3, 0.2, seed));
    if (i % 3 == 1) all.push_back(torus_random_diagonals(20 + i, 12, 1, 0.4, seed));
    if (i % 3 == 2) all.push_back(noisy_scan(3, 0.1, seed));
  }
  return all;
}

const auto no_failure = [](std::int64_t i, const std::exception& e) { FAIL("mesh " << i << ": " << e.what()); };

}  // namespace

TEST_CASE("a batch gives the bits of one run after the other, whatever the number of jobs") {
  const std::vector<MeshData> all = meshes();
  std::vector<FieldRun> alone;
  for (const MeshData& s : all) alone.push_back(run_field(s.V, s.F, {.n = 4}));
  for (const int jobs : {0, 1, 2, 5}) {
    CAPTURE(jobs);
    std::vector<ComplexVectorX<double>> u(all.size());
    std::vector<std::vector<int>> indices(all.size());
    std::vector<int> visits(all.size(), 0);
    run_batch(
        static_cast<std::int64_t>(all.size()), {.field = {.n = 4}, .jobs = jobs},
        [&](Context& context, std::int64_t i) {
          const auto k = static_cast<std::size_t>(i);
          const FieldRun& run = context.run(all[k].V, all[k].F);
          u[k] = run.field.u;
          indices[k] = run.indices;
          ++visits[k];
        },
        no_failure);
    for (std::size_t k = 0; k < all.size(); ++k) {
      CHECK(visits[k] == 1);
      CHECK(u[k] == alone[k].field.u);
      CHECK(indices[k] == alone[k].indices);
    }
  }
}

TEST_CASE("what goes wrong with one mesh reaches failed() and stops nothing") {
  std::vector<MeshData> all = meshes();
  all[3].F(5, 0) = all[3].F(5, 1);  // a vertex twice in a face
  all[7].V(2, 1) = std::numeric_limits<double>::infinity();
  std::vector<int> failures(all.size(), 0);
  std::atomic<int> done{0};
  run_batch(
      static_cast<std::int64_t>(all.size()), {.jobs = 2},
      [&](Context& context, std::int64_t i) {
        if (i == 9) throw std::bad_alloc();
        const auto k = static_cast<std::size_t>(i);
        const FieldRun& run = context.run(all[k].V, all[k].F);  // throws outside of CHECK, which would catch it
        CHECK(run.certificate.holds());
        ++done;
      },
      [&](std::int64_t i, const std::exception& error) {
        ++failures[static_cast<std::size_t>(i)];
        CHECK((i == 9) == (dynamic_cast<const std::bad_alloc*>(&error) != nullptr));
        CHECK((i == 3 || i == 7) == (dynamic_cast<const MeshError*>(&error) != nullptr));
      });
  CHECK(done == 9);
  for (std::size_t k = 0; k < all.size(); ++k) CHECK(failures[k] == (k == 3 || k == 7 || k == 9 ? 1 : 0));
}

TEST_CASE("a context that met a bad mesh is as good as new") {
  const MeshData good = jittered_sphere(3, 0.2, 1);
  Faces bad = good.F;
  bad(0, 0) = 1 << 20;
  Context context({.n = 2});
  CHECK_THROWS_AS(context.run(good.V, bad), MeshError);
  CHECK(context.run(good.V, good.F).field.u == run_field(good.V, good.F, {.n = 2}).field.u);
}

TEST_CASE("an exception of failed() ends the batch and reaches the caller") {
  std::atomic<int> begun{0};
  CHECK_THROWS_WITH_AS(run_batch(
                           100000, {.jobs = 1},
                           [&](Context&, std::int64_t i) {
                             ++begun;
                             if (i == 3) throw std::runtime_error("bad mesh");
                           },
                           [](std::int64_t, const std::exception&) { throw std::logic_error("enough"); }),
                       "enough", std::logic_error);
  CHECK(begun == 4);
}

TEST_CASE("bad arguments are named, an empty batch is none of them") {
  const auto nothing = [](Context&, std::int64_t) { FAIL("no mesh, no work"); };
  run_batch(0, {}, nothing, no_failure);
  CHECK_THROWS_AS(run_batch(-1, {}, nothing, no_failure), OptionError);
  CHECK_THROWS_AS(run_batch(1, {.jobs = -1}, nothing, no_failure), OptionError);
}

#ifndef __SANITIZE_THREAD__  // its own memory for every access would be counted
TEST_CASE("memory does not grow with the number of meshes, and would if one run of a mesh stayed") {
  const MeshData s = jittered_sphere(3, 0.2, 5);
  std::vector<FieldRun> kept;
  std::mutex keeping;
  // How much the resident set grows, now, whatever earlier tests have used.
  const auto growth = [&](std::int64_t count, bool keep) {
    const std::int64_t before = memory_bytes();
    run_batch(
        count, {.jobs = 2},
        [&](Context& context, std::int64_t) {
          const FieldRun& run = context.run(s.V, s.F);
          if (!keep) return;
          const std::lock_guard lock(keeping);
          kept.push_back(run);
        },
        no_failure);
    return memory_bytes() - before;
  };
  (void)growth(50, false);  // what threads and the allocator keep for themselves
  const std::int64_t flat = growth(150, false), leaked = growth(150, true);
  MESSAGE("150 meshes: " << flat / 1024 << " kB more, with all runs kept " << leaked / 1024 << " kB more");
  CHECK(leaked > 16 * 1024 * 1024);
  CHECK(flat < leaked / 4);
}
#endif
