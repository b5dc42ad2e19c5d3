// SPDX-License-Identifier: MIT
//
// test_cancel.cpp: every long call asks often enough whether it is to stop, in all of its phases, stops cleanly, leaves
// everything usable, and stays within the threads it is given.
#include <doctest/doctest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <numeric>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "alcap/alcap.h"
#include "src/base/parallel.h"
#include "tests/support/folder.h"

#ifdef __GLIBC__
#include <sys/syscall.h>
#include <unistd.h>
#endif

using namespace alcap;

namespace {

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__) || !defined(NDEBUG)
constexpr bool slow = true;  // thread sanitizers take twenty times as long
#else
constexpr bool slow = false;
#endif
constexpr int usual_level = slow ? 3 : 5, large_level = slow ? 4 : 6, huge_level = slow ? 5 : 7;

#ifdef __GLIBC__
std::atomic<long> clock_step{0}, clock_moved{0};  // nanoseconds

/// While it lives, the clock by which checks tell whether a question is due moves on by `step` nanoseconds whenever
/// somebody looks. With the ten milliseconds between questions every check asks.
class OwnClock {
 public:
  explicit OwnClock(long step) { clock_step = step; }
  OwnClock(const OwnClock&) = delete;
  OwnClock& operator=(const OwnClock&) = delete;
  ~OwnClock() { clock_step = 0; }
};

}  // namespace

// In the C library's place: the steady clock of C++ looks here. NOLINTNEXTLINE
extern "C" int clock_gettime(clockid_t id, timespec* t) noexcept {
  const long code = ::syscall(SYS_clock_gettime, id, t);
  if (code != 0 || id != CLOCK_MONOTONIC || clock_step == 0) return static_cast<int>(code);
  constexpr long second = 1'000'000'000;
  const long now = clock_moved += clock_step;
  t->tv_sec = 1'000'000 + now / second;
  t->tv_nsec = now % second;
  return 0;
}

namespace {
#endif

/// A cancel that watches how often and by whom it is asked, and says yes from question number `yes` on.
class Watch {
 public:
  explicit Watch(int yes = -1) : yes_(yes) {}
  [[nodiscard]] std::function<bool()> cancel() {
    return [this] {
      const std::lock_guard lock(mutex_);
      threads_.insert(std::this_thread::get_id());
      return asked_++ >= yes_ && yes_ >= 0;
    };
  }
  [[nodiscard]] int asked() const { return asked_; }
  [[nodiscard]] const std::set<std::thread::id>& threads() const { return threads_; }

 private:
  std::mutex mutex_;
  int yes_, asked_ = 0;
  std::set<std::thread::id> threads_;
};

/// What long calls are made on; the solver is multigrid because a factorisation does not ask.
struct Scene {
  test::Folder folder;
  MeshData data;
  EigenOptions eigen{.solver = "multigrid", .method = "lobpcg"};
  FieldRun run;
  std::filesystem::path mesh_file, field_file;

  explicit Scene(int level) : data(jittered_sphere(level, 0.2, 1)) {
    run = run_field(data.V, data.F, {.n = 4, .eigen = eigen});
    mesh_file = folder.path / "mesh.off";
    field_file = folder.path / "field.ply";
    write_mesh(mesh_file, data.V, data.F);
    write_field(output(), field_file);
  }
  [[nodiscard]] FieldOutput output() const {
    return {.surface = run.surface, .field = run.field, .singularities = run.singularities};
  }
  [[nodiscard]] DesignerOptions designer_options(const RunControl& control = {}) const {
    return {.n = 4, .guidance_weight = 1, .solver = "multigrid", .right_hand_sides = 1, .control = control};
  }
};

struct Call {
  const char* name;
  std::function<void(const RunControl&)> make;
  bool factorises = false;  // a factorisation that has begun does not ask
  // Seconds between checks, half as much again as promised: for machines that are slower than this one.
  double allowed = 0.15;
};

// Calls without options of their own are made under controlled().
Call inside(const char* name, const std::function<void()>& body) {
  return {name, [body](const RunControl& control) { controlled(control, body); }};
}

std::vector<Call> mesh_calls(const Scene& s) {
  const MeshData& d = s.data;
  const FieldRun& r = s.run;
  return {
      {"read_mesh", [&](const RunControl& c) { (void)read_mesh(s.mesh_file, {.control = c}); }},
      {"write_mesh", [&](const RunControl& c) { write_mesh(s.folder.path / "copy.obj", d.V, d.F, c); }},
      inside("icosphere", [] { (void)icosphere(huge_level); }),
      inside("Surface", [&] { (void)Surface(d.V, d.F); }),
      inside("find_defects", [&] { (void)find_defects(d.F, d.V.rows()); }),
      inside("find_defects in space", [&] { (void)find_defects(d.V, d.F); }),
      inside("repair_weld", [&] { (void)repair_weld(d.V, d.F); }),
      inside("repair_orientation", [&] { (void)repair_orientation(d.F, d.V.rows()); }),
      inside("find_topology", [&] { (void)find_topology(r.mesh()); }),
      inside("split_components", [&] { (void)split_components(r.mesh(), d.V, r.topology()); }),
      inside("SurfaceLocator", [&] { (void)SurfaceLocator(r.surface); }),
      inside("sharp_edges", [&] { (void)sharp_edges(r.surface); }),
      inside("stroke_along_vertices",
             [&] {
               (void)stroke_along_vertices(r.surface, {0, 3});
             }),
  };
}

std::vector<Call> field_calls(const Scene& s) {
  const MeshData& d = s.data;
  const FieldRun& r = s.run;
  return {
      inside("globally_optimal", [&] { (void)globally_optimal(r.mesh(), r.geometry()); }),
      inside("polar", [&] { (void)polar(r.mesh(), r.geometry()); }),
      {"trivial", [&](const RunControl& c) { controlled(c, [&] {
                                               (void)trivial(r.surface, {{0, 1}, {5, 1}});
                                             }); },
       true},
      inside("vertex_frames", [&] { (void)vertex_frames(r.mesh(), d.V, r.geometry(), r.connection()); }),
      inside("first_order_operators",
             [&] { (void)first_order_operators(r.mesh(), r.geometry(), r.connection(), {.n = 4}); }),
      inside("find_singularities", [&] { (void)find_singularities(r.surface, r.field); }),
      inside("at_faces and at_vertices", [&] { (void)at_vertices(r.surface, at_faces(r.surface, r.field)); }),
      {"run_field", [&](const RunControl& c) { (void)run_field(d.V, d.F, {.n = 4, .eigen = s.eigen, .control = c}); }},
      {"run_field by EigenOptions::cancel",
       [&](const RunControl& c) {
         FieldRunOptions options{.n = 4, .eigen = s.eigen, .threads = c.threads};
         options.eigen.cancel = c.cancel;
         (void)run_field(d.V, d.F, options);
       }},
      {"run_batch",
       [&](const RunControl& c) {
         run_batch(
             2, {.field = {.n = 4, .eigen = s.eigen}, .control = c},
             [&](Context& context, std::int64_t) { (void)context.run(d.V, d.F); },
             [](std::int64_t, const std::exception& e) { FAIL(std::string(e.what())); });
       }},
      {"write_field",
       [&](const RunControl& c) {
         const std::vector<std::filesystem::path> files{s.folder.path / "copy.vtp", s.folder.path / "copy.rawfield"};
         (void)write_field(s.output(), files, c);
       }},
      {"read_field", [&](const RunControl& c) { (void)read_field(s.field_file, c); }},
  };
}

std::vector<Call> design_calls(const Scene& s) {
  const FieldRun& r = s.run;
  return {
      {"Designer",
       [&](const RunControl& c) {
         Designer designer(r.surface, s.designer_options(c));
         (void)designer.add(SingularityTarget{.face = 10});
         (void)designer.solve();
       }},
      {"eigen_design",
       [&](const RunControl& c) { (void)eigen_design(r.surface, {}, {.n = 4, .eigen = s.eigen, .control = c}); }},
      {"streamlines",
       [&](const RunControl& c) {
         const CurveSet curves = streamlines(r.surface, r.field, {.spacing = 0.02, .control = c});
         write_curves(curves, 4, s.folder.path / "copy.json", c);
       }},
      {"separatrices",
       [&](const RunControl& c) { (void)separatrices(r.surface, r.field, r.singularities, {.control = c}); }},
      {"trace_curves",
       [&](const RunControl& c) {
         std::vector<CurveSeed> seeds;
         for (Index t = 0; t < r.mesh().faces(); t += 2000) seeds.push_back({{t, {0.4, 0.3, 0.3}}, 0});
         (void)trace_curves(r.surface, r.field, seeds, {.control = c});
       }},
  };
}

DesignFile small_design(DesignMethod method) {
  DesignFile design{.n = 4, .method = method};
  design.singularities = {{.face = 10}, {.face = 40, .kind = SingularityKind::saddle}};
  return design;
}

// Sums of matrices of half a million rows, and dense products of blocks with as many, are single steps.
constexpr double large_matrices = 1.5;

/// Those that solve with several steps, and the rest of what reads and writes.
std::vector<Call> compound_calls(const Scene& s) {
  const MeshData& d = s.data;
  const FieldRun& r = s.run;
  const auto design = [&](DesignMethod method) {
    return [&r, method](const RunControl& c) {
      (void)run_design(r.surface.surface(), small_design(method), {.solver = "multigrid", .control = c});
    };
  };
  return {
      {"run_design", design(DesignMethod::variational)},
      {"run_design by eigenvectors", design(DesignMethod::eigen), false, large_matrices},
      {"DesignSession",
       [&](const RunControl& c) {
         DesignSession session(r.surface.surface(), {.solver = "multigrid", .control = c});
         (void)session.solve(small_design(DesignMethod::variational));
       }},
      {"aligned_field",
       [&](const RunControl& c) {
         const AlignedOptions options{.fixed = {{.vertex = 7}}, .max_steps = 3, .eigen = s.eigen, .control = c};
         (void)aligned_field(r.surface, sharp_edges(r.surface), options);
       }},
      {"smoothest_modes",
       [&](const RunControl& c) {
         controlled(c, [&] { (void)smoothest_modes(r.surface, 3, {.n = 4, .eigen = s.eigen}); });
       },
       false, large_matrices},
      inside("intrinsic_delaunay", [&] { (void)intrinsic_delaunay(r.surface, {.min_angle = 0.4}); }),
      inside("target_edge_lengths", [&] { (void)target_edge_lengths(r.surface, sharp_edges(r.surface)); }),
      inside("repair_mesh", [&] { (void)repair_mesh(d.V, d.F, {.repairs = {Repair::automatic}}); }),
      inside("nearest_connection", [&] { (void)nearest_connection(r.surface, ConnectionTarget{}); }),
      inside("write_matrix",
             [&] { write_matrix(s.folder.path / "copy.mtx", energy_matrices(r.surface, 4).S, MatrixFormat::mtx); }),
      {"write_for",
       [&](const RunControl& c) {
         (void)write_for(Reader::directional, s.output(), nullptr, s.folder.path / "copy", c);
       }},
      {"update_streamlines",
       [&](const RunControl& c) {
         const CurveSet coarse = streamlines(r.surface, r.field, {.spacing = 0.06, .control = c});
         (void)update_streamlines(r.surface, r.field, coarse, {.spacing = 0.02, .control = c});
       }},
  };
}

std::vector<Call> all_calls(const Scene& s) {
  std::vector<Call> calls = mesh_calls(s);
  for (const auto& more : {field_calls(s), design_calls(s), compound_calls(s)})
    calls.insert(calls.end(), more.begin(), more.end());
  return calls;
}

#ifdef __GLIBC__
/// Seconds of processor time of this thread: what others do on the machine does not count, but for what it slows down.
double cpu() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// On one thread, the time from each check to the next one, from the beginning of the call to its end.
std::vector<double> gaps_between_checks(const Call& call) {
  std::vector<double> gaps;
  const OwnClock clock(10'000'000);
  double last = cpu();
  const auto mark = [&] {
    const double now = cpu();
    gaps.push_back(now - last);
    last = now;
  };
  call.make({.cancel =
                 [&] {
                   mark();
                   return false;
                 },
             .threads = 1});
  mark();
  return gaps;
}

double largest(const std::vector<double>& gaps) { return *std::max_element(gaps.begin(), gaps.end()); }
#endif

FieldRunOptions run_options(const Scene& s, const std::function<bool()>& cancel) {
  return {.n = 4, .eigen = s.eigen, .control = {.cancel = cancel}};
}

}  // namespace

TEST_CASE("a cancel that is true before the call: asked once, nothing is done, no file appears") {
  const Scene scene(3);
  const std::set<std::string> files = scene.folder.names();
  for (const Call& call : all_calls(scene)) {
    CAPTURE(std::string(call.name));
    Watch watch(0);
    std::atomic<int> phases{0};
    CHECK_THROWS_AS(call.make({.cancel = watch.cancel(), .progress = [&](auto, double) { ++phases; }}), Cancelled);
    CHECK(watch.asked() == 1);
    CHECK(phases == 0);
    CHECK(scene.folder.names() == files);
  }
}

#ifdef __GLIBC__
TEST_CASE("every phase of every call checks again within a tenth of a second") {
  constexpr int level = slow ? 4 : 7;
  auto scene = std::make_unique<Scene>(level);
  const std::vector<Call> calls = all_calls(*scene);
  for (std::size_t k = 0; k < calls.size(); ++k) {
    const std::string name = calls[k].name;
    CAPTURE(name);
    std::vector<double> gaps = gaps_between_checks(calls[k]);
    MESSAGE(name << ": " << std::accumulate(gaps.begin(), gaps.end(), 0.0) << " s of processor time, " << gaps.size()
                 << " checks, longest gap " << largest(gaps) << " s");
    if (slow || calls[k].factorises) continue;
    // What others do on the machine makes a gap longer now here, now there: one of ours is there every time.
    const double allowed = calls[k].allowed;
    for (int again = 0; again < 4 && largest(gaps) > allowed; ++again) {
      const Scene fresh(level);  // nothing has been computed before
      const std::vector<double> others = gaps_between_checks(all_calls(fresh)[k]);
      REQUIRE(others.size() == gaps.size());  // one thread: the same checks
      std::transform(gaps.begin(), gaps.end(), others.begin(), gaps.begin(),
                     [](double a, double b) { return std::min(a, b); });
    }
    CHECK(largest(gaps) <= allowed);
  }
}

TEST_CASE("a check asks when ten milliseconds have passed since the last question, and not before") {
  int asked = 0;
  const OwnClock clock(1'000'000);  // a millisecond each time somebody looks
  controlled({.cancel = [&] { return ++asked < 0; }, .threads = 1}, [] {
    for (int k = 0; k < 1000; ++k) detail::check_cancelled();
  });
  CHECK(asked == 101);  // the first one before anything is done
}
#endif

TEST_CASE("cancelled in the middle: Cancelled, no file appears, and the same call gives the same bits afterwards") {
  const Scene scene(large_level);
  const std::set<std::string> files = scene.folder.names();
  const ComplexVectorX<double> alone = scene.run.field.u;
  const auto remove_copies = [&] {
    for (const std::string& name : scene.folder.names()) {
      if (name.starts_with("copy")) std::filesystem::remove(scene.folder.path / name);
    }
  };
  int cancelled = 0;
  for (const Call& call : all_calls(scene)) {
    CAPTURE(std::string(call.name));
    Watch counting;
    call.make({.cancel = counting.cancel()});
    remove_copies();
    for (const int part : {1, 2}) {
      const int question = counting.asked() * part / 4;
      if (question < 1) continue;
      Watch watch(question);
      try {
        call.make({.cancel = watch.cancel()});
      } catch (const Cancelled&) {
        CHECK(watch.asked() <= question + 4);  // all threads know at once; one each may be asking just then
        ++cancelled;
        CHECK(scene.folder.names() == files);
      }
      remove_copies();  // a machine with less to do now may have ended before that question
    }
  }
  CHECK(cancelled >= 10);
  CHECK(run_field(scene.data.V, scene.data.F, run_options(scene, {})).field.u == alone);
}

TEST_CASE("cancelled from another thread at any moment, and the run after it is as if nothing had been") {
  const Scene scene(usual_level);
  for (int k = 0; k < 12; ++k) {
    CAPTURE(k);
    std::atomic<bool> stop{false};
    std::thread other([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(5 * k));
      stop = true;
    });
    try {
      const FieldRun run = run_field(scene.data.V, scene.data.F, run_options(scene, [&] { return stop.load(); }));
      CHECK(run.field.u == scene.run.field.u);  // it came too late
    } catch (const Cancelled&) {
      CHECK(stop);
    }
    other.join();
  }
  CHECK(run_field(scene.data.V, scene.data.F, run_options(scene, {})).field.u == scene.run.field.u);
}

TEST_CASE("a designer that was stopped at any question gives the field of one that was not") {
  const Scene scene(usual_level);
  const FieldRun& r = scene.run;
  const auto edited = [&](Designer& designer, bool may_fail) {
    const auto attempt = [&](const std::function<void()>& step) {
      for (int tries = 0; tries < 50; ++tries) {
        try {
          return step();
        } catch (const Cancelled&) {
          if (!may_fail) throw;
        }
      }
      FAIL("never got through");
    };
    ControlId id{};
    attempt([&] { id = designer.add(SingularityTarget{.face = 10, .sign = -1}); });
    attempt([&] { designer.add(VertexConstraint{.vertex = 50}); });
    DesignResult result;
    attempt([&] { result = designer.solve(); });
    attempt([&] { designer.set(id, SingularityTarget{.face = 10, .sign = -1, .orientation = 0.3}); });
    attempt([&] { designer.set_guidance_weight(2); });
    attempt([&] { designer.set_guidance(r.field.u); });
    attempt([&] { result = designer.solve(); });
    return result.field.u;
  };
  Designer untouched(r.surface, scene.designer_options());
  const ComplexVectorX<double> expected = edited(untouched, false);
  for (const int first : {1, 2, 3}) {
    CAPTURE(first);
    // Each attempt gets further than the one before.
    std::atomic<int> asked{0}, last{first}, cancelled{0};
    std::atomic<bool> armed{false};
    const RunControl control{.cancel = [&] {
      if (!armed || ++asked < last) return false;
      asked = 0;
      last = last + 1 + last / 3;
      ++cancelled;
      return true;
    }};
    Designer designer(r.surface, scene.designer_options(control));
    armed = true;
    CHECK(edited(designer, true) == expected);
    CHECK(cancelled >= 2);  // each of the seven calls asks at least once
  }
}

TEST_CASE("two runs on two threads: one is cancelled, the other one does not notice") {
  const Scene scene(usual_level);
  std::atomic<int> cancelled{0};
  std::atomic<bool> stop{false};
  std::thread other([&] {
    for (int k = 0; k < 5; ++k) {
      Watch watch(k);
      try {
        (void)run_field(scene.data.V, scene.data.F, run_options(scene, watch.cancel()));
      } catch (const Cancelled&) {
        ++cancelled;
      }
    }
    stop = true;
  });
  int runs = 0;
  do {
    Watch never;
    CHECK(run_field(scene.data.V, scene.data.F, run_options(scene, never.cancel())).field.u == scene.run.field.u);
    ++runs;
  } while (!stop);
  other.join();
  CHECK(runs >= 1);
  CHECK(cancelled >= 1);
}

TEST_CASE("inside the caller's task_arena: its threads and no others, and the same bits") {
  const Scene scene(usual_level);
  for (const int width : {1, 4}) {
    for (const int threads : {0, 1, 8}) {
      CAPTURE(width);
      CAPTURE(threads);
      tbb::task_arena arena(width);
      Watch watch;
      arena.execute([&] {
        FieldRunOptions options = run_options(scene, watch.cancel());
        options.threads = threads;
        CHECK(run_field(scene.data.V, scene.data.F, options).field.u == scene.run.field.u);
        int seen = 0;
        controlled({.threads = threads}, [&] { seen = thread_limit(); });
        CHECK(seen == (threads == 0 ? width : std::min(threads, width)));
      });
      CHECK(static_cast<int>(watch.threads().size()) <= (threads == 0 ? width : std::min(threads, width)));
    }
  }
}

TEST_CASE("one thread means the caller's, in every call") {
  const Scene scene(usual_level);
  for (const Call& call : all_calls(scene)) {
    CAPTURE(std::string(call.name));
    Watch watch;
    call.make({.cancel = watch.cancel(), .threads = 1});
    CHECK(watch.threads() == std::set{std::this_thread::get_id()});
  }
  CHECK_THROWS_AS(controlled({.threads = -1}, [] {}), OptionError);
  CHECK_THROWS_AS(controlled({.threads = 5000}, [] {}), OptionError);
}

TEST_CASE("progress: phases in order on the caller's thread, parts between 0 and 1 that grow") {
  const Scene scene(huge_level);
  const auto caller = std::this_thread::get_id();
  std::vector<std::string> phases;
  double last = 0;
  RunControl control;
  control.progress = [&](std::string_view phase, double fraction) {
    CHECK(std::this_thread::get_id() == caller);
    CHECK(fraction >= 0);
    CHECK(fraction <= 1);
    if (fraction == 0) {
      phases.emplace_back(phase);
    } else {
      CHECK(phase == phases.back());
      CHECK(fraction >= last);
    }
    last = fraction;
  };
  controlled(control, [&] {
    const MeshFile file = read_mesh(scene.mesh_file);
    CHECK(last > 0.5);  // of the file, when it was told last
    (void)run_field(file.V, file.F, {.n = 4, .eigen = scene.eigen});
    write_mesh(scene.folder.path / "again.ply", file.V, file.F);
  });
  CHECK(phases == std::vector<std::string>{"read", "mesh", "connection", "solve", "analysis", "write"});

  phases.clear();
  run_batch(
      3, {.field = {.n = 2}, .control = control},
      [](Context& context, std::int64_t) {
        const MeshData d = icosphere(2);
        (void)context.run(d.V, d.F);
      },
      [](std::int64_t, const std::exception& e) { FAIL(std::string(e.what())); });

  control.progress = [](std::string_view, double) { throw std::runtime_error("enough"); };
  CHECK_THROWS_WITH_AS((void)run_field(scene.data.V, scene.data.F, {.control = control}), "enough", std::runtime_error);
  CHECK(run_field(icosphere(2).V, icosphere(2).F).certificate.holds());
}

TEST_CASE("scopes: nested ones both count, the inner one ends with its call, exceptions of the question come through") {
  bool outer = false, inner = false;
  controlled({.cancel = [&] { return outer; }}, [&] {
    controlled({.cancel = [&] { return inner; }}, [] { detail::check_cancelled(); });
    inner = true;
    CHECK_THROWS_AS(controlled({.cancel = [&] { return inner; }}, [] {}), Cancelled);
    detail::check_cancelled();  // that was the inner one's
    outer = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(11));
    CHECK_THROWS_AS(controlled({}, [] { detail::check_cancelled(); }), Cancelled);
    CHECK_THROWS_AS(detail::check_cancelled(), Cancelled);
  });
  detail::check_cancelled();
  CHECK(controlled({}, [] { return std::string("value"); }) == "value");
  CHECK_THROWS_WITH_AS(controlled({.cancel = []() -> bool { throw std::logic_error("broken"); }}, [] {}), "broken",
                       std::logic_error);
}

TEST_CASE("one thread at a time asks, also while an answer takes long") {
  std::atomic<int> inside{0}, most{0};
  int asked = 0;  // without a lock: that is the promise
  const auto slow_answer = [&] {
    most = std::max(most.load(), ++inside);
    ++asked;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    --inside;
    return false;
  };
  controlled({.cancel = slow_answer}, [] {
    parallel_for(
        40, [](std::int64_t) { std::this_thread::sleep_for(std::chrono::milliseconds(5)); }, 1);
  });
  CHECK(asked > 1);
  CHECK(most == 1);
}

TEST_CASE("a loop inside of another loop's body does all of its work or throws, whatever other bodies throw") {
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> incomplete{0};
    const auto body = [&](std::int64_t i) {
      if (i == 17) throw std::runtime_error("one of many");
      std::vector<int> seen(20000, 0);
      parallel_for(
          20000, [&](std::int64_t k) { seen[static_cast<std::size_t>(k)] = 1; }, 100);
      if (std::count(seen.begin(), seen.end(), 1) != 20000) ++incomplete;
    };
    CHECK_THROWS_WITH_AS(run_with_threads(4, [&] { parallel_for(64, body, 1); }), "one of many", std::runtime_error);
    CHECK(incomplete == 0);
  }
}
