// SPDX-License-Identifier: MIT
//
// test_array.cpp: the owning array.
#include "src/base/array.h"

#include <doctest/doctest.h>

#include <complex>
#include <numeric>

#include "alcap/memory.h"

using alcap::detail::Array;

TEST_CASE("an array owns its elements and hands them on when it is moved") {
  Array<int> a(5, 7);
  CHECK(a.size() == 5);
  CHECK(std::accumulate(a.begin(), a.end(), 0) == 35);
  a[3] = 1;
  const int* const place = a.data();
  Array<int> b = std::move(a);
  CHECK(b.data() == place);
  CHECK(b[3] == 1);
  Array<int> c(2, 0);
  c = std::move(b);
  CHECK(c.size() == 5);
  CHECK(c[4] == 7);
  CHECK(Array<int>(0).empty());
  CHECK(Array<int>().data() == nullptr);
}

TEST_CASE("elements start unset: making a large array touches no memory") {
  const std::int64_t before = alcap::memory_bytes();
  Array<std::complex<double>> large(std::int64_t{1} << 26);  // 1 GB, which a constructor of zeros would write
  large[large.size() - 1] = {1, 2};
  CHECK(large[large.size() - 1].imag() == 2);
  CHECK(alcap::memory_bytes() - before < (std::int64_t{1} << 28));
}
