// SPDX-License-Identifier: MIT
#include "src/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

// ThreadSanitizer cannot find the line of every access in code that was inlined into the scheduler. Bodies have frames
// of their own, as they are called by their address, and tests/support/tsan.supp silences the scheduler by the name of
// its functions; what it passes to a body, which it synchronises in ways that are not seen, is read without checks.
#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#define ALCAP_UNCHECKED __attribute__((no_sanitize("thread")))
#else
#define ALCAP_UNCHECKED
#endif

namespace alcap {
namespace detail {
namespace {

/// Tells ThreadSanitizer what it cannot see inside TBB: what was written before a parallel region is visible in its
/// bodies, and what they wrote is visible after it, also where an exception ends them. Races between the bodies stay
/// visible. Compiles to nothing otherwise.
class Region {
#if defined(__SANITIZE_THREAD__)
 public:
  Region() { __tsan_release(&start_); }
  ~Region() { __tsan_acquire(&end_); }
  Region(const Region&) = delete;
  Region& operator=(const Region&) = delete;

  class Inside {
   public:
    explicit Inside(Region& region) : region_(region) { __tsan_acquire(&region_.start_); }
    ~Inside() { __tsan_release(&region_.end_); }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;

   private:
    Region& region_;
  };

 private:
  char start_ = 0;
  char end_ = 0;
#else
 public:
  struct Inside {
    explicit Inside(Region&) {}
  };
#endif
};

/// body(begin, end) for the range; inside a scope in pieces of `grain`, a check before each.
void run_range(const RangeBody& body, std::int64_t begin, std::int64_t end, std::int64_t grain) {
  if (cancel::current == nullptr) {
    body.run(body.body, begin, end);
    return;
  }
  for (; begin < end; begin += grain) {
    check_cancelled();
    body.run(body.body, begin, std::min(end, begin + grain));
  }
}

}  // namespace

void run_ranges(std::int64_t n, std::int64_t grain, RangeBody body) {
  const std::int64_t chunks = (n + grain - 1) / grain;
  if (chunks == 1 || thread_limit() == 1) {
    run_range(body, 0, n, grain);
    return;
  }
  Region region;
  ControlScope* const scope = cancel::current;
  const auto run = [&](const tbb::blocked_range<std::int64_t>& r) ALCAP_UNCHECKED {
    const Region::Inside inside(region);
    const CarriedScope carried(scope);
    run_range(body, r.begin() * grain, std::min(n, r.end() * grain), grain);
  };
  // A group of its own: one that hangs on the group around it would, when another body of that throws, end here early
  // and without a word, and the body around this loop would go on with half of the results.
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, chunks), run, own);
}

void run_in_arena(int threads, PlainBody body) {
  const int here = thread_limit();
  if (threads <= 0 || (threads == 1 && here == 1)) {
    body.run(body.body);
    return;
  }
  const auto allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const int most = here == tbb::info::default_concurrency() ? static_cast<int>(allowed) : here;
  tbb::task_arena arena(std::min(threads, most));
  Region region;
  ControlScope* const scope = cancel::current;
  arena.execute([&]() ALCAP_UNCHECKED {
    const Region::Inside inside(region);
    const CarriedScope carried(scope);
    body.run(body.body);
  });
}

void run_apart(PlainBody body) {
  tbb::this_task_arena::isolate([&] { body.run(body.body); });
}

}  // namespace detail

int thread_limit() { return tbb::this_task_arena::max_concurrency(); }

#undef ALCAP_UNCHECKED

}  // namespace alcap
