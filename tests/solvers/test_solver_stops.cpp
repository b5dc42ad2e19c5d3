// SPDX-License-Identifier: MIT
//
// Solves that end early: cancelled by their caller, from the solve itself or from another thread, or out of memory.
// Each is a typed exception, nothing is leaked, and the solver can be used again.
//
// Memory runs out when the test says so: the C library's allocator is replaced by one that refuses large blocks from
// the k-th on, and counts those that are alive. Not under sanitizers, which bring their own (and find leaks
// themselves).
#include <doctest/doctest.h>

#include <atomic>
#include <cerrno>
#include <complex>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "alcap/solve.h"
#include "tests/solvers/solver_fixture.h"
#include "tests/support/libc_allocator.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ALCAP_TEST_ALLOCATOR
#include <dlfcn.h>
#include <malloc.h>
#endif

using namespace alcap;
using namespace alcap::test;

namespace {

std::atomic<long> alive{0};  // large blocks

}  // namespace

#ifdef ALCAP_TEST_ALLOCATOR
static constexpr std::size_t large = std::size_t{16} << 10;
static std::atomic<long> allowed{1L << 60};  // so many large blocks are granted

extern "C" {
// NOLINTBEGIN: the C library's own names.
static void* counted(void* block) {
  if (block != nullptr && malloc_usable_size(block) >= large) ++alive;
  return block;
}
static bool refused(std::size_t size) {
  if (size < large || --allowed >= 0) return false;
  errno = ENOMEM;
  return true;
}
void* malloc(std::size_t size) { return refused(size) ? nullptr : counted(__libc_malloc(size)); }
void* calloc(std::size_t count, std::size_t size) {
  return refused(count * size) ? nullptr : counted(__libc_calloc(count, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return refused(size) ? nullptr : counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  if (refused(size)) return ENOMEM;
  *out = counted(__libc_memalign(alignment, size));
  return *out == nullptr ? ENOMEM : 0;
}
void free(void* block) {
  if (block != nullptr && malloc_usable_size(block) >= large) --alive;
  __libc_free(block);
}
void* realloc(void* block, std::size_t size) {
  if (refused(size)) return nullptr;
  const bool was_large = block != nullptr && malloc_usable_size(block) >= large;
  void* moved = __libc_realloc(block, size);
  if (moved == nullptr && size > 0) return nullptr;
  if (was_large) --alive;
  return counted(moved);
}
// NOLINTEND
}
#endif

namespace {

/// With the system that linear solvers are given.
struct System : Problem {
  Hermitian A = shifted();
  Dense b = Dense::Ones(A.rows(), 1);
  System(const MeshData& surface, int n) : Problem(problem_of(surface, n)) {}
};

/// What is tried, and what must hold of it afterwards.
struct Work {
  std::string name;
  std::function<void(const std::function<bool()>& cancel)> run;
  std::function<bool()> again;  ///< with the same objects: does it work now?
};

Work linear(const std::string& name, const System& p) {
  struct Shared {
    std::function<bool()> cancel;
    std::unique_ptr<LinearSolver<Z>> solver;
    Dense x;
  };
  const auto shared = std::make_shared<Shared>();
  shared->solver =
      make_linear_solver<Z>({.name = name, .cancel = [s = shared.get()] { return s->cancel && s->cancel(); }});
  shared->x.resize(p.b.rows(), 1);
  const auto solve = [shared, &p] {
    shared->solver->analyse(p.A);
    shared->solver->factorise(p.A);
    return shared->solver->solve(p.b, shared->x);
  };
  return {.name = name,
          .run =
              [=](const std::function<bool()>& cancel) {
                shared->cancel = cancel;
                (void)solve();
              },
          .again =
              [=, &p] {
                shared->cancel = nullptr;
                return solve().converged && residual<Z>(p.A, shared->x, p.b) <= 1e-9;
              }};
}

Work eigen(const std::string& method, const System& p) {
  const auto solve = [=, &p](const std::function<bool()>& cancel) {
    return smallest_eigenpair(p.S, p.M, p.area, {.method = method, .cancel = cancel});
  };
  return {.name = method,
          .run = [=](const std::function<bool()>& cancel) { (void)solve(cancel); },
          .again = [=] { return solve({}).report.converged; }};
}

std::vector<Work> everything(const System& p) {
  std::vector<Work> all;
  for (const std::string& name : linear_solvers()) all.push_back(linear(name, p));
  for (const std::string& method : eigen_solvers())
    if (method != "dense") all.push_back(eigen(method, p));
  return all;
}

}  // namespace

TEST_CASE("cancelled at any step: Cancelled, and the solver works afterwards") {
  const System p(jittered_sphere(3, 0.2, 1), 1);
  for (const Work& work : everything(p)) {
    CAPTURE(work.name);
    int steps = 0;
    work.run([&] { return ++steps < 0; });
    CHECK(steps >= 3);  // at least before every phase
    CHECK(work.again());
    const long before = alive;
    for (int k = 0; k < steps; ++k) {
      int asked = 0;
      bool stopped = false;
      try {
        work.run([&] { return asked++ == k; });
      } catch (const Cancelled&) {
        stopped = true;
      }
      // How many questions there are depends on time, but for those before every phase.
      CHECK(asked <= k + 1);
      CHECK(stopped == (asked == k + 1));
      if (k < 3) CHECK(stopped);
    }
    CHECK(work.again());
    CHECK(alive == before);
  }
}

TEST_CASE("what the question itself throws reaches the caller") {
  const System p(icosphere(2), 1);
  for (const Work& work : everything(p)) {
    CAPTURE(work.name);
    int asked = 0;
    CHECK_THROWS_WITH_AS(work.run([&]() -> bool {
      if (++asked == 2) throw std::runtime_error("enough");
      return false;
    }),
                         "enough", std::runtime_error);
    CHECK(work.again());
  }
}

TEST_CASE("cancelled from another thread in the middle of a solve") {
  const System p(jittered_sphere(4, 0.2, 1), 4);
  for (const Work& work : everything(p)) {
    CAPTURE(work.name);
    std::atomic<int> asked{0};
    std::atomic<bool> stop{false};
    std::thread other([&] {
      while (asked < 2) std::this_thread::yield();
      stop = true;
    });
    // The second question waits for the other thread, so that the order is the same every time.
    CHECK_THROWS_AS(work.run([&] {
      if (++asked == 2)
        while (!stop) std::this_thread::yield();
      return stop.load();
    }),
                    Cancelled);
    other.join();
    CHECK(work.again());
  }
}

TEST_CASE("a run is cancelled from its progress callback, in one piece or in many") {
  MeshData pieces{Positions<double>(12 * 162, 3), Faces(12 * 320, 3)};
  const MeshData sphere = jittered_sphere(2, 0.1, 3);
  for (Index k = 0; k < 12; ++k) {
    pieces.V.middleRows(162 * k, 162) = sphere.V;
    pieces.F.middleRows(320 * k, 320) = (sphere.F.array() + 162 * k).matrix();
  }
  for (const MeshData& surface : {jittered_sphere(4, 0.2, 1), pieces}) {
    std::atomic<bool> stop{false};
    FieldRunOptions options{.n = 4};
    options.eigen.cancel = [&] { return stop.load(); };
    options.progress = [&](std::string_view phase) { stop = phase == "solve"; };
    CHECK_THROWS_AS(static_cast<void>(run_field(surface.V, surface.F, options)), Cancelled);
    options.progress = {};
    stop = false;
    CHECK(run_field(surface.V, surface.F, options).certificate.holds());
  }
}

#ifdef ALCAP_TEST_ALLOCATOR
TEST_CASE(
    "out of memory at any large block: SolveError that says so, nothing leaked, and the solver works afterwards") {
  // OpenBLAS on several threads ends the process when it does not get its list of tasks; on one it needs none.
  using Set = void (*)(int);
  if (void* const found = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<Set>(found)(1);
  const System p(jittered_sphere(4, 0.2, 1), 1);
  for (const Work& work : everything(p)) {
    CAPTURE(work.name);
    CHECK(work.again());
    const long before = alive;
    int failures = 0;
    for (int k = 0;; ++k) {
      CAPTURE(k);
      bool failed = false;
      std::string what;
      allowed = k;
      try {
        work.run({});
      } catch (const SolveError& e) {
        failed = true;
        what = e.what();
      } catch (const std::exception& e) {
        allowed = 1L << 60;
        FAIL(std::string(e.what()));
      }
      const bool ran_out = allowed < 0;
      allowed = 1L << 60;
      CHECK(failed == ran_out);
      if (!ran_out) break;
      ++failures;
      CHECK(what.find("out of memory; ") != std::string::npos);  // and what to do
      if (work.name == "eigen-ldlt" || work.name.starts_with("cholmod"))
        CHECK(what.find("the solver 'multigrid'") != std::string::npos);
    }
    CHECK(failures >= 3);
    CHECK(work.again());
    CHECK(alive == before);
  }
}
#endif
