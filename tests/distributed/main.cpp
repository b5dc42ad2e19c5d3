// SPDX-License-Identifier: MIT
//
// One doctest run per rank; the ranks are started by mpirun.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "alcap/distributed.h"
#include "src/base/parallel.h"

int main(int argc, char** argv) {
  (void)alcap::distributed_rank();
  doctest::Context context(argc, argv);
  int result = 0;
  alcap::run_with_threads(1, [&] { result = context.run(); });
  // The others may wait for this rank in a collective call.
  if (result != 0) alcap::distributed_abort(result);
  return 0;
}
