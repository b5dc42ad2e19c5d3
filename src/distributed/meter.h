// SPDX-License-Identifier: MIT
//
// meter.h: what every phase takes, over the ranks. Internal to src/distributed.
#pragma once

#include <petscsys.h>

#include <string>
#include <vector>

#include "alcap/distributed.h"
#include "alcap/memory.h"
#include "src/base/clock.h"
#include "src/distributed/together.h"

namespace alcap::detail::distributed {

/// Counts from construction, or the end of the last phase, to done().
class Meter {
 public:
  Meter() { start(); }
  /// Collective.
  void done(const char* phase, std::vector<PhaseCost>& phases) {
    const double seconds = watch_.lap();
    const double bytes = petsc_isend_len + petsc_send_len - bytes_,
                 messages = petsc_isend_ct + petsc_send_ct - messages_;
    PhaseCost cost{.name = phase};
    spread(seconds, cost.seconds);
    spread(bytes, cost.bytes_sent);
    spread(messages, cost.messages);
    spread(static_cast<double>(memory_bytes()), cost.memory);
    phases.push_back(cost);
    start();
  }

 private:
  void start() {
    (void)watch_.lap();
    bytes_ = petsc_isend_len + petsc_send_len;
    messages_ = petsc_isend_ct + petsc_send_ct;
  }
  Stopwatch watch_;
  double bytes_ = 0, messages_ = 0;
};

}  // namespace alcap::detail::distributed
