// SPDX-License-Identifier: MIT
//
// portable.cpp: with ALCAP_PORTABLE, in the place of posix.cpp.
#include "apps/alcap/system/system.h"

namespace alcap::app {

bool stderr_is_terminal() { return false; }
void reserve_standard_streams() {}
void one_thread_for_blas() {}
bool may_write_into(const std::filesystem::path&) { return true; }
AddressSpace address_space() { return {}; }
void take_blas_buffer() {}

struct HeldSignals::Before {};
HeldSignals::HeldSignals() = default;
HeldSignals::~HeldSignals() = default;
bool HeldSignals::stop_requested() { return false; }

NewFolder::~NewFolder() = default;
bool NewFolder::make(const std::filesystem::path& path) { return std::filesystem::create_directory(path); }

FolderLock::~FolderLock() = default;
bool FolderLock::take(const std::filesystem::path&, std::chrono::milliseconds) { return true; }

}  // namespace alcap::app
