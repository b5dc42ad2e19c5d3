// SPDX-License-Identifier: MIT
//
// portable.h: tests of what a build without calls of the operating system (ALCAP_PORTABLE) does not have:
//
//   TEST_CASE("a pipe is read like a file" * doctest::skip(test::portable)) { ... }
#pragma once

namespace alcap::test {

/// No pipes, no locks, no waits for the disk, no signals, no bounds of memory, no pictures, no studio.
#ifdef ALCAP_PORTABLE
inline constexpr bool portable = true;
#else
inline constexpr bool portable = false;
#endif

}  // namespace alcap::test
