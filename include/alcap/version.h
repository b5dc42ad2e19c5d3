// SPDX-License-Identifier: MIT
//
// version.h: which alcap this is, and a check at link time that both sides of the API lay out Eigen's memory alike.
#pragma once

#include <Eigen/Core>

namespace alcap {

/// The version of the compiled library, "major.minor.patch".
[[nodiscard]] const char* version() noexcept;

namespace detail {

// Eigen picks its memory alignment, and with it how memory is freed, from the instruction set (-mavx,
// -march=native). A program compiled unlike the library would corrupt its heap; this reference to a function
// that the library defines for its own alignment only turns that into an error of the linker. Compile both
// alike, or define EIGEN_MAX_ALIGN_BYTES for both.
template <int bytes>
void alcap_was_compiled_with_another_eigen_alignment() noexcept;
template <>
void alcap_was_compiled_with_another_eigen_alignment<EIGEN_MAX_ALIGN_BYTES>() noexcept;
[[gnu::used]] inline constexpr auto eigen_alignment_check =
    &alcap_was_compiled_with_another_eigen_alignment<EIGEN_MAX_ALIGN_BYTES>;

}  // namespace detail
}  // namespace alcap
