// SPDX-License-Identifier: MIT
//
// batch.h: many meshes at once, each on one thread. For meshes of a few thousand triangles this is several times faster
// than one mesh after the other on all threads, and the results are the same to the last bit. A BLAS with threads of
// its own (OpenBLAS) should be set to one: meshes that are factorised would wait for each other.
//
//   alcap::run_batch(meshes.size(), {.field = {.n = 4}},
//                    [&](alcap::Context& context, std::int64_t i) {
//                      const alcap::FieldRun& run = context.run(meshes[i].V, meshes[i].F);
//                      lambda[i] = run.eigen[0].lambda;
//                    },
//                    [&](std::int64_t i, const std::exception& error) { bad[i] = error.what(); });
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <utility>

#include "alcap/field_run.h"

namespace alcap {

/// One thread's workplace: computes fields on the calling thread alone and keeps the last one. Several contexts may
/// work at the same time; one context belongs to one thread at a time.
class Context {
 public:
  /// `threads`, `progress` and those of `control` are not used; control.cancel is.
  explicit Context(FieldRunOptions options = {});

  /// run_field() on this thread, of a surface or of points and triangles; throws what it throws. The reference holds
  /// until the next call.
  const FieldRun& run(const Surface& surface);
  template <class Points, class Triangles>
  const FieldRun& run(Points&& V, Triangles&& F) {
    return run(as_positions(std::forward<Points>(V)), as_faces(std::forward<Triangles>(F)));
  }
  const FieldRun& run(Positions<double>&& V, Faces&& F);

  /// Those it was made with.
  [[nodiscard]] const FieldRunOptions& options() const { return options_; }

 private:
  FieldRunOptions options_;
  FieldRun run_;
};

/// How a batch runs.
struct BatchOptions {
  FieldRunOptions field = {};  // of every context
  int jobs = 0;                // meshes at a time; 0: as many as the machine has threads
  /// Of the whole batch: cancel ends it with Cancelled, also in the middle of a mesh; progress is told "batch" and the
  /// part of the meshes that is done. `threads` counts where `jobs` is 0.
  RunControl control = {};
};

/// Calls work(context, i) for every i in [0, count), `jobs` at a time, in about this order, each on one thread with
/// that thread's context. What work throws goes to failed(i, error), one call at a time, and the others go on; an
/// exception thrown by `failed` ends the batch and reaches the caller. Anything thrown that is not a std::exception
/// ends it as well, and so does Cancelled when the batch itself was cancelled. Throws OptionError for negative count or
/// jobs.
void run_batch(std::int64_t count, const BatchOptions& options,
               const std::function<void(Context& context, std::int64_t i)>& work,
               const std::function<void(std::int64_t i, const std::exception& error)>& failed);

}  // namespace alcap
