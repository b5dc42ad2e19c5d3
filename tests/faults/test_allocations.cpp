// SPDX-License-Identifier: MIT
//
// Memory that runs out at the k-th allocation, for one allocation or from then on, in every kind of call: an exception
// that says so, or the result as always; nothing is leaked, and the same call works afterwards. Every k of a few dozen
// per call; scripts/faults.sh takes all of them (ALCAP_EVERY_ALLOCATION=1).
//
// The C library's allocator is replaced by one that refuses when it is told to: memory of operator new, of Eigen, of
// CHOLMOD and of what TBB takes from it. Not under sanitizers, which bring their own.
#include <doctest/doctest.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "alcap/alcap.h"
#include "tests/support/folder.h"
#include "tests/support/libc_allocator.h"
#include "tests/support/mesh_helpers.h"
#include "tests/support/random_meshes.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <dlfcn.h>

namespace {

constexpr long never = std::numeric_limits<long>::max();
std::atomic<long> alive{0}, asked{0}, refuse_at{never};
std::atomic<bool> from_then_on{false};

}  // namespace

extern "C" {
// NOLINTBEGIN: the C library's own names.
// libgomp and OpenBLAS end the process when their few kilobytes are refused; nobody who links them can do otherwise.
static bool ends_the_process(const void* caller) {
  Dl_info info{};
  return dladdr(caller, &info) != 0 && info.dli_fname != nullptr &&
         (std::strstr(info.dli_fname, "libgomp") != nullptr || std::strstr(info.dli_fname, "openblas") != nullptr);
}
static bool refused(const void* caller) {
  const long k = asked.fetch_add(1, std::memory_order_relaxed), at = refuse_at.load(std::memory_order_relaxed);
  if (k != at && !(k > at && from_then_on.load(std::memory_order_relaxed))) return false;
  if (ends_the_process(caller)) return false;
  errno = ENOMEM;
  return true;
}
static void* counted(void* block) {
  if (block != nullptr) alive.fetch_add(1, std::memory_order_relaxed);
  return block;
}
void* malloc(std::size_t size) { return refused(__builtin_return_address(0)) ? nullptr : counted(__libc_malloc(size)); }
void* calloc(std::size_t count, std::size_t size) {
  return refused(__builtin_return_address(0)) ? nullptr : counted(__libc_calloc(count, size));
}
void* realloc(void* block, std::size_t size) {
  if (size != 0 && refused(__builtin_return_address(0))) return nullptr;
  void* const moved = __libc_realloc(block, size);
  if (block == nullptr) return counted(moved);
  if (size == 0) alive.fetch_sub(1, std::memory_order_relaxed);
  return moved;
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return refused(__builtin_return_address(0)) ? nullptr : counted(__libc_memalign(alignment, size));
}
void* memalign(std::size_t alignment, std::size_t size) {
  return refused(__builtin_return_address(0)) ? nullptr : counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = refused(__builtin_return_address(0)) ? nullptr : counted(__libc_memalign(alignment, size));
  return *out == nullptr ? ENOMEM : 0;
}
void free(void* block) {
  if (block != nullptr) alive.fetch_sub(1, std::memory_order_relaxed);
  __libc_free(block);
}
// NOLINTEND
}

using namespace alcap;

namespace {

/// A call, and its result as bytes; where it is a field that a factorisation makes it is not `exact`: one that gets no
/// memory is tried again with another shift, which gives other last bits.
struct Job {
  const char* name;
  std::function<std::string()> run;
  bool exact = true;
};

/// Whether two results are the same; of fields that are not exact, whether they point the same way at every vertex, up
/// to a factor for all of them, to the six digits that the residual promises.
bool agree(const Job& job, const std::string& result, const std::string& expected) {
  if (result == expected) return true;
  if (job.exact || result.size() != expected.size()) return false;
  using Values = Eigen::Map<const ComplexVectorX<double>, Eigen::Unaligned>;
  const auto values = [](const std::string& all) {
    return Values(reinterpret_cast<const std::complex<double>*>(all.data()),
                  static_cast<Eigen::Index>(all.size() / sizeof(std::complex<double>)));
  };
  const ComplexVectorX<double> a = values(result), b = values(expected);
  const std::complex<double> factor = b.dot(a) / b.squaredNorm();
  return (a - factor * b).norm() <= 1e-6 * a.norm();
}

template <class Matrix>
std::string bytes(const Matrix& m) {
  return {reinterpret_cast<const char*>(m.data()), static_cast<std::size_t>(m.size()) * sizeof(m.data()[0])};
}

std::string bytes(const std::filesystem::path& file) {
  const auto status = std::filesystem::file_size(file);
  std::string text(status, '\0');
  std::FILE* const stream = std::fopen(file.c_str(), "rb");
  if (stream == nullptr) throw std::bad_alloc();
  const std::size_t got = std::fread(text.data(), 1, text.size(), stream);
  (void)std::fclose(stream);
  text.resize(got);
  return text;
}

/// Its field fades along the chain.
MeshData chain_of_spheres() {
  test::Dice dice(1000022);
  return test::families.at("chain")(dice);
}

/// What calls are made on. The sphere is large enough for loops on several threads.
struct Scene {
  test::Folder folder;
  MeshData sphere = jittered_sphere(4, 0.2, 1), small = jittered_sphere(2, 0.2, 1), ring = torus(12, 8, 1, 0.4),
           plate = grid(8, 8), soup = test::soup(jittered_sphere(2, 0.2, 1)), chain = chain_of_spheres();
  ConnectedSurface connected = connect(Surface(small.V, small.F));
  FieldRun run = run_field(small.V, small.F, {.n = 4});

  [[nodiscard]] std::filesystem::path file(const char* name) const { return folder.path / name; }
};

Job field_job(const char* name, const MeshData& mesh, const FieldRunOptions& options) {
  return {name, [&mesh, options] { return bytes(run_field(mesh.V, mesh.F, options).field.u); }, false};
}

std::vector<Job> field_jobs(const Scene& s) {
  using enum ConnectionKind;
  return {
      field_job("globally optimal, large", s.sphere, {.n = 4}),
      field_job("multigrid", s.sphere, {.n = 2, .eigen = {.solver = "multigrid", .method = "lobpcg"}}),
      field_job("local, with proof", s.small,
                {.n = 4, .connection = {.kind = local}, .eigen = {.prove_smallest = Prove::always}}),
      field_job(
          "polar, inverse iteration", s.plate,
          {.n = 1, .connection = {.kind = polar}, .eigen = {.solver = "eigen-ldlt", .method = "inverse-iteration"}}),
      field_job("trivial, balanced", s.ring, {.n = 4, .connection = {.kind = trivial, .balance_cones = true}}),
      field_job("faded", s.chain, {.n = 5, .connection = {.kind = polar}}),
      field_job("modes", s.small, {.n = 4, .modes = 3}),
      field_job("aligned", s.plate, {.n = 4, .align = FieldAlignment{}}),
      field_job("repaired", s.soup, {.n = 4, .repairs = {Repair::automatic}}),
  };
}

std::vector<Job> file_jobs(const Scene& s) {
  std::vector<Job> jobs;
  for (const char* name : {"copy.obj", "copy.off", "copy.ply"}) {
    jobs.push_back({name, [&s, path = s.file(name)] {
                      write_mesh(path, s.small.V, s.small.F);
                      const MeshFile back = read_mesh(path);
                      return bytes(back.V) + bytes(back.F);
                    }});
  }
  for (const char* name : {"field.ply", "field.vtp", "field.rawfield", "field.vertex.rawfield", "field.rosy"}) {
    jobs.push_back({name, [&s, path = s.file(name)] {
                      write_field(
                          {.surface = s.run.surface, .field = s.run.field, .singularities = s.run.singularities}, path);
                      if (path.extension() == ".ply") return bytes(read_field(path).field.u);
                      return bytes(path);
                    }});
  }
  jobs.push_back({"curves", [&s] {
                    CurveSet curves = streamlines(s.run.surface, s.run.field, {.spacing = 0.1});
                    curves.append(separatrices(s.run.surface, s.run.field, s.run.singularities));
                    write_curves(curves, 4, s.file("curves.json"));
                    return bytes(curves.points) + bytes(s.file("curves.json"));
                  }});
  return jobs;
}

std::vector<Job> design_jobs(const Scene& s) {
  const std::string text = R"({"alcap_design":1,"n":4,"singularities":[{"face":5,"kind":"saddle","angle":20}],
    "fixed":[{"vertex":40,"direction":[1,0,0.2]}],"strokes":[{"vertices":[0,30]}]})";
  const DesignFile design = parse_design(text);
  DesignFile eigen = design;
  eigen.method = DesignMethod::eigen;
  eigen.fixed.clear();
  const auto solved = [&s](const DesignFile& d) {
    return [&s, d] { return bytes(run_design(s.connected, d).field.u); };
  };
  return {
      {"design", solved(design), false},
      {"eigen design", solved(eigen), false},
      {"design file", [text] { return design_text(parse_design(text)); }},
      {"edits",
       [&s] {
         Designer designer(s.connected, {.n = 4, .guidance_weight = 1});
         (void)designer.add(SingularityTarget{.face = 10, .sign = -1});
         (void)designer.solve();
         (void)designer.add(VertexConstraint{.vertex = 50});
         return bytes(designer.solve().field.u);
       }},
      {"batch",
       [&s] {
         std::string out(3, '\0');
         run_batch(
             3, {.field = {.n = 4}},
             [&](Context& context, std::int64_t i) {
               out[static_cast<std::size_t>(i)] = context.run(s.small.V, s.small.F).certificate.holds() ? 'y' : 'n';
             },
             [&out](std::int64_t, const std::exception& e) {
               if (dynamic_cast<const std::bad_alloc*>(&e) == nullptr && dynamic_cast<const SolveError*>(&e) == nullptr)
                 FAIL(std::string(e.what()));
               out.clear();
             });
         if (out.empty()) throw std::bad_alloc();
         return out;
       }},
  };
}

/// What a call makes of its k-th allocation and, if `onwards`, those that follow being refused.
struct Outcome {
  std::string result, error;
  long asked = 0;
  bool typed = true;
};

Outcome attempt(const Job& job, long k, bool onwards) {
  Outcome out;
  out.error.reserve(200);
  asked = 0;
  from_then_on = onwards;
  refuse_at = k;
  try {
    out.result = job.run();
    refuse_at = never;
  } catch (const std::exception& e) {
    refuse_at = never;
    out.error = e.what();
    out.typed = dynamic_cast<const std::bad_alloc*>(&e) != nullptr || dynamic_cast<const SolveError*>(&e) != nullptr ||
                dynamic_cast<const FileError*>(&e) != nullptr;
  }
  out.asked = asked;
  return out;
}

/// Blocks that each of several further attempts leaves behind.
bool leaks(const Job& job, long k, bool onwards) {
  for (int repeat = 0; repeat < 4; ++repeat) {
    const long before = alive;
    (void)attempt(job, k, onwards);
    if (alive <= before) return false;
  }
  return true;
}

/// ALCAP_ONE_CALL=NAME: that call alone; with ALCAP_ONE_ALLOCATION=K (or K+) that refusal alone, for a debugger with a
/// breakpoint at dladdr.
bool left_out(const Job& job) {
  const char* const wanted = std::getenv("ALCAP_ONE_CALL");
  const char* const k = std::getenv("ALCAP_ONE_ALLOCATION");
  if (wanted == nullptr) return false;
  if (job.name != std::string(wanted)) return true;
  if (k == nullptr) return false;
  for (int warm = 0; warm < 2; ++warm) (void)job.run();
  MESSAGE(attempt(job, std::atol(k), std::strchr(k, '+') != nullptr).error);
  return true;
}

void check_every(const Job& job) {
  if (left_out(job)) return;
  CAPTURE(std::string(job.name));
  for (int warm = 0; warm < 2; ++warm) (void)job.run();
  const std::string expected = job.run();
  const Outcome whole = attempt(job, never, false);
  REQUIRE(whole.error.empty());
  const bool all = std::getenv("ALCAP_EVERY_ALLOCATION") != nullptr;
  const long step = all ? 1 : std::max(1L, whole.asked / 16);
  int refusals = 0;
  for (long k = 0; k < whole.asked; k += step) {
    for (const bool onwards : {false, true}) {
      CAPTURE(k);
      CAPTURE(onwards);
      const long before = alive;
      if (std::getenv("ALCAP_ONE_CALL") != nullptr) std::fprintf(stderr, "%ld%s\n", k, onwards ? "+" : "");
      {
        const Outcome out = attempt(job, k, onwards);
        CAPTURE(out.error);
        CHECK(out.typed);
        if (out.error.empty()) CHECK(agree(job, out.result, expected));
        refusals += out.error.empty() ? 0 : 1;
      }
      if (alive > before) CHECK_FALSE(leaks(job, k, onwards));
    }
  }
  CHECK(refusals > 0);
  CHECK(job.run() == expected);
  MESSAGE(std::string(job.name) << ": " << whole.asked << " allocations, " << refusals << " exceptions");
}

/// OpenBLAS on several threads ends the process when it does not get its list of tasks; on one it needs none.
void one_blas_thread() {
  using Set = void (*)(int);
  if (void* const found = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<Set>(found)(1);
}

}  // namespace

TEST_CASE("fields: memory that runs out anywhere is an exception, nothing is leaked, and the next run is as always") {
  one_blas_thread();
  const Scene scene;
  for (const Job& job : field_jobs(scene)) check_every(job);
}

TEST_CASE("files and curves: memory that runs out anywhere is an exception, and nothing is left behind") {
  const Scene scene;
  for (const Job& job : file_jobs(scene)) check_every(job);
  for (const std::string& name : scene.folder.names()) CHECK(name.front() != '.');
}

TEST_CASE("designs and batches: memory that runs out anywhere is an exception, and nothing is leaked") {
  one_blas_thread();
  const Scene scene;
  for (const Job& job : design_jobs(scene)) check_every(job);
}
#endif
