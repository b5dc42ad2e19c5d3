// SPDX-License-Identifier: MIT
//
// test_array.cpp: the owning array.
#include "src/base/array.h"

#include <doctest/doctest.h>

#include <complex>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>

#include "alcap/memory.h"
#include "alcap/mesh.h"

using alcap::detail::Array;

namespace {

/// Whether the program has asked for large pages at this address: the system's flag hg of its mapping.
bool in_large_pages(const void* address) {
  std::ifstream maps("/proc/self/smaps");
  bool inside = false;
  for (std::string line; std::getline(maps, line);) {
    std::istringstream in(line);
    std::uintptr_t begin = 0, end = 0;
    char dash = 0;
    if (in >> std::hex >> begin >> dash >> end && dash == '-')
      inside = begin <= reinterpret_cast<std::uintptr_t>(address) && reinterpret_cast<std::uintptr_t>(address) < end;
    else if (inside && line.starts_with("VmFlags:"))
      return line.find(" hg") != std::string::npos;
  }
  return false;
}

}  // namespace

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

TEST_CASE("large arrays, and vectors of Eigen, ask for large pages; small ones do not") {
  if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage")) return;  // this system has none
  constexpr std::int64_t large = std::int64_t{1} << 26;
  const Array<char> array(large);
  CHECK(in_large_pages(array.data() + large / 2));
  alcap::VectorX<double> vector;
  alcap::detail::resize_unset(vector, large / 8);
  CHECK(vector.size() == large / 8);
  CHECK(in_large_pages(vector.data() + vector.size() / 2));
  const Array<char> small(1 << 18);
  CHECK_FALSE(in_large_pages(small.data()));
}
