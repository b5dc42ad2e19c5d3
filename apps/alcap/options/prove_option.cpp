// SPDX-License-Identifier: MIT
#include "apps/alcap/options/prove_option.h"

namespace alcap::app {

void add_prove_option(cli::App& app, Prove& prove) {
  app.add_flag_function(
         "--prove,!--no-prove", [&prove](std::int64_t count) { prove = count > 0 ? Prove::always : Prove::never; },
         "Prove that no smaller eigenvalue exists, whatever the size, or do not; without either, where the proof "
         "costs less than the solve")
      ->group("Solver");
}

}  // namespace alcap::app
