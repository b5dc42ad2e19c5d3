// SPDX-License-Identifier: MIT
//
// version.cpp: the version, and the one alignment this build of the library answers to.
#include "alcap/version.h"

namespace alcap {

const char* version() noexcept { return ALCAP_VERSION; }

template <>
void detail::alcap_was_compiled_with_another_eigen_alignment<EIGEN_MAX_ALIGN_BYTES>() noexcept {}

}  // namespace alcap
