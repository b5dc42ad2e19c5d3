// SPDX-License-Identifier: MIT
//
// design_lock.h: one studio per design.
#pragma once

#include <filesystem>

#include "apps/alcap/studio/passing_file.h"

namespace alcap::app {

/// Holds a design's file for this process: a lock on a hidden file beside it.
class DesignLock {
 public:
  /// Throws Failure(output) when another process holds it.
  explicit DesignLock(const std::filesystem::path& file);
  DesignLock(const DesignLock&) = delete;
  DesignLock& operator=(const DesignLock&) = delete;
  ~DesignLock();

 private:
  int descriptor_ = -1;
  PassingFile file_;
};

}  // namespace alcap::app
