// SPDX-License-Identifier: MIT
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>
#include <tbb/global_control.h>

int main(int argc, char** argv) {
  // Up to eight threads on any machine, so that tests of thread independence mean something on two cores.
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 8);
  return doctest::Context(argc, argv).run();
}
