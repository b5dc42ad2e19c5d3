// SPDX-License-Identifier: MIT
//
// version.cpp: the version, and the one alignment and the one width of Index that this build of the library answers to.
#include "alcap/version.h"

#include "alcap/index.h"

namespace alcap {

const char* version() noexcept { return ALCAP_VERSION; }

template <>
void detail::alcap_was_compiled_with_another_eigen_alignment<EIGEN_MAX_ALIGN_BYTES>() noexcept {}

template <>
void detail::alcap_was_compiled_with_an_index_of_another_width<8 * sizeof(Index)>() noexcept {}

}  // namespace alcap
