// SPDX-License-Identifier: MIT
//
// One studio per design, however many start and end at the same time.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <string>

#include "apps/alcap/commands/command.h"
#include "apps/alcap/studio/design_lock.h"
#include "tests/support/portable.h"

namespace {

using namespace alcap;
using namespace alcap::app;
namespace fs = std::filesystem;

/// Takes the lock and gives it back for a while, with a folder that only one can have made meanwhile: 0, or 1 where
/// another process had it too, or 2 where the lock was never to be had.
int contend(const fs::path& design, const fs::path& mark) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  int had = 0;
  while (std::chrono::steady_clock::now() < end) {
    try {
      const DesignLock lock(design);
      if (::mkdir(mark.c_str(), 0700) != 0) return 1;
      ::rmdir(mark.c_str());
      ++had;
    } catch (const Failure&) {
    }
  }
  return had > 0 ? 0 : 2;
}

TEST_CASE("a design is held by one process at a time, also while another one lets go of it" *
          doctest::skip(test::portable)) {
  std::string name = (fs::temp_directory_path() / "alcap-lock-XXXXXX").string();
  REQUIRE(::mkdtemp(name.data()) != nullptr);
  const fs::path folder = name;
  std::array<pid_t, 4> children{};
  for (pid_t& child : children) {
    child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) ::_exit(contend(folder / "a.json", folder / "held"));
  }
  for (const pid_t child : children) {
    int status = -1;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
  }
  CHECK(fs::is_empty(folder));
  {
    const DesignLock lock(folder / "a.json");
    CHECK(fs::exists(folder / ".a.json.lock"));
    CHECK_THROWS_AS(DesignLock(folder / "a.json"), Failure);
    const DesignLock other(folder / "b.json");
  }
  CHECK(fs::is_empty(folder));
  fs::remove_all(folder);
}

}  // namespace
