// SPDX-License-Identifier: MIT
//
// One call of the system that goes wrong while the tool runs: a full disk, an interrupted or short read or write,
// memory that runs out, a kill at this very point; at every call, counted up until the fault no longer happens.
// Whatever happens, an output is complete, or what it was before. Memory and kills are tried at a few dozen points;
// scripts/faults.sh tries all (ALCAP_EVERY_FAULT=1) and 200 kills at random times (ALCAP_KILLS=200).
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "tests/cli/cli_runner.h"

#if defined(ALCAP_FAULT_PRELOAD) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

using namespace alcap;
using test::CliFolder;
using test::Json;

namespace {

using Contents = std::map<std::string, std::string>;

bool everything() { return std::getenv("ALCAP_EVERY_FAULT") != nullptr; }

/// Files and their bytes, without hidden ones. Reports hold times, so only whether they are whole counts.
Contents contents(const CliFolder& folder) {
  Contents out;
  for (const std::string& name : folder.files()) {
    if (name.front() == '.' || std::filesystem::is_directory(folder.work() / name)) continue;
    std::string text = CliFolder::read(folder.work() / name);
    if (name.ends_with(".json") && Json::accept(text)) text = "whole";
    out[name] = text;
  }
  return out;
}

std::int64_t hidden(const CliFolder& folder) {
  std::int64_t count = 0;
  for (const std::string& name : folder.files()) count += name.front() == '.' && name.find('/') == std::string::npos;
  return count;
}

/// Exit code of the tool with a fault in it, and whether that happened. A signal is 128 and its number.
struct Run {
  int exit;
  bool happened;
};
Run run_with(const CliFolder& folder, const std::string& fault, const std::string& arguments) {
  const auto mark = folder.work().parent_path() / "mark";
  std::filesystem::remove(mark);
  const int exit = folder.shell(
      "exec 2>/dev/null; OPENBLAS_NUM_THREADS=1 ALCAP_FAULT=" + fault + " ALCAP_FAULT_MARK='" + mark.string() +
      "' LD_PRELOAD='" ALCAP_FAULT_PRELOAD "' $ALCAP " + arguments + " >../out 2>../err\nexit $?\n");
  return {exit, std::filesystem::exists(mark)};
}

/// Commands that write, what they read, and what is there already.
struct Scene {
  std::string arguments;
  bool replaces = false;
};
const std::vector<Scene> scenes{{"field a.ply -n 4 -q -o out"},
                                {"field a.ply -n 4 -q -o out", true},
                                {"field a.ply -n 4 -q -o x.ply --report r.json"},
                                {"field a.ply -n 4 -q -o x.vtp", true},
                                {"design a.ply -n 2 --saddle 5 -q -o out"}};

/// Sets a scene up again: inputs alone, or with an older output.
void reset(const CliFolder& folder, const Scene& scene) {
  for (const auto& entry : std::filesystem::directory_iterator(folder.work()))
    std::filesystem::remove_all(entry.path());
  folder.write("a.ply", icosphere(1));
  if (scene.replaces) (void)folder.run("field a.ply -n 1 -q " + scene.arguments.substr(scene.arguments.find("-o ")));
}

/// Before, and after without a fault.
struct Expected {
  Contents before, after;
};
Expected expect(const CliFolder& folder, const Scene& scene) {
  reset(folder, scene);
  Expected e;
  e.before = contents(folder);
  REQUIRE(folder.run(scene.arguments).exit == 0);
  e.after = contents(folder);
  REQUIRE(e.before != e.after);
  return e;
}

/// How many leftovers a run names.
std::int64_t leftovers_in(const Json& report) {
  return std::count_if(report["warnings"].begin(), report["warnings"].end(),
                       [](const Json& w) { return w["code"] == "leftover"; });
}

/// Every file is that of before or that of after, and a folder with a report is that of one of them as a whole.
bool whole(const Contents& now, const Expected& e) {
  const auto as_in = [](const Contents& all, const std::string& name, const std::string& text) {
    const auto found = all.find(name);
    return found != all.end() && found->second == text;
  };
  for (const auto& [name, text] : now)
    if (!as_in(e.before, name, text) && !as_in(e.after, name, text)) return false;
  if (!now.contains("out/report.json")) return true;
  const auto all_of = [&](const Contents& c) {
    return std::all_of(c.begin(), c.end(), [&](const auto& entry) { return as_in(now, entry.first, entry.second); });
  };
  return all_of(e.before) || all_of(e.after);
}

}  // namespace

TEST_CASE("a disk that is full, or fails, at any call: an error, nothing hidden left, and every output whole") {
  const CliFolder folder;
  for (const Scene& scene : scenes) {
    const Expected e = expect(folder, scene);
    for (const char* call : {"write", "fsync", "rename", "mkdir", "open", "close"}) {
      for (const char* error : {"ENOSPC", "EIO"}) {
        if (std::string(error) == "EIO" && call != std::string("fsync") && call != std::string("write")) continue;
        for (int k = 0;; k += everything() ? 1 : 3) {
          reset(folder, scene);
          const std::string fault = std::string(call) + ":" + std::to_string(k) + ":" + error;
          const Run run = run_with(folder, fault, scene.arguments);
          if (!run.happened) break;
          CAPTURE(scene.arguments);
          CAPTURE(fault);
          CAPTURE(CliFolder::read(folder.work().parent_path() / "err"));
          const Contents now = contents(folder);
          CHECK((run.exit == 6 || run.exit == 3 || run.exit == 7 || run.exit == 0));
          if (run.exit == 0) CHECK(now == e.after);
          CHECK(whole(now, e));
          CHECK(hidden(folder) == 0);
        }
      }
    }
  }
}

TEST_CASE("calls that are interrupted, and reads and writes of single bytes, change nothing") {
  const CliFolder folder;
  for (const Scene& scene : scenes) {
    const Expected e = expect(folder, scene);
    for (const char* call : {"write", "read", "open", "close"}) {
      for (int k = 0;; k += everything() ? 1 : 5) {
        reset(folder, scene);
        const std::string fault = std::string(call) + ":" + std::to_string(k) + ":EINTR";
        const Run run = run_with(folder, fault, scene.arguments);
        if (!run.happened) break;
        CAPTURE(scene.arguments);
        CAPTURE(fault);
        CAPTURE(CliFolder::read(folder.work().parent_path() / "err"));
        CHECK(run.exit == 0);
        CHECK(contents(folder) == e.after);
      }
    }
    for (const char* fault : {"write:0+:short", "read:0+:short"}) {
      reset(folder, scene);
      CAPTURE(scene.arguments);
      CAPTURE(fault);
      CHECK(run_with(folder, fault, scene.arguments).exit == 0);
      CHECK(contents(folder) == e.after);
      CHECK(hidden(folder) == 0);
    }
  }
}

TEST_CASE("killed before any call on a file: every output is whole, and what is left is recognised") {
  const CliFolder folder;
  for (const Scene& scene : scenes) {
    const Expected e = expect(folder, scene);
    int leftovers = 0;
    for (int k = 0;; k += everything() ? 1 : 4) {
      reset(folder, scene);
      const Run run = run_with(folder, "any:" + std::to_string(k) + ":kill", scene.arguments);
      if (!run.happened) break;
      CAPTURE(scene.arguments);
      CAPTURE(k);
      CHECK(run.exit == 128 + 9);
      CHECK(whole(contents(folder), e));
      const std::int64_t left = hidden(folder);
      if (left == 0) continue;
      ++leftovers;
      const test::CliResult next = folder.run(scene.arguments + " --json");
      CHECK(next.exit == 0);
      CHECK(leftovers_in(next.json()) == left);
      CHECK(hidden(folder) == left);  // nobody deletes what it did not create
    }
    CHECK(leftovers > 0);
  }
}

TEST_CASE("killed at random times: every output is whole") {
  const CliFolder folder;
  const char* const wanted = std::getenv("ALCAP_KILLS");
  const int trials = wanted == nullptr ? 20 : std::atoi(wanted);
  const Scene scene{"field b.ply -n 4 -q -o out", true};
  folder.write("b.ply", icosphere(4));
  REQUIRE(folder.run("field b.ply -n 4 -q -o out").exit == 0);
  Expected e;
  e.before = e.after = contents(folder);
  // As long as a run takes, so that kills come in all of its phases.
  REQUIRE(folder.shell(
              "s=$(date +%s%N); $ALCAP field b.ply -n 4 -q -o out; echo $(( ($(date +%s%N) - s) / 1000 )) >../t") == 0);
  const int run_us = std::atoi(CliFolder::read(folder.work().parent_path() / "t").c_str());
  int killed = 0, left = 0;
  for (int k = 0; k < trials; ++k) {
    CAPTURE(k);
    const double seconds = 1.2e-6 * run_us * ((k * 37) % 101) / 101.0;
    killed += folder.shell("$ALCAP field b.ply -n 4 -q -o out & p=$!; sleep " + std::to_string(seconds) +
                           "; kill -9 $p 2>/dev/null; wait $p 2>/dev/null; exit $(( $? == 137 ))");
    CHECK(whole(contents(folder), e));
    left = static_cast<int>(hidden(folder));
  }
  MESSAGE(killed << " of " << trials << " runs killed, " << left << " left something");
  CHECK(killed > trials / 2);
  const test::CliResult next = folder.run("field b.ply -n 4 -o out --json");
  CHECK(next.exit == 0);
  CHECK(leftovers_in(next.json()) == left);
}

TEST_CASE("memory that runs out anywhere in the tool: exit code 7, or a result as always") {
  const CliFolder folder;
  for (const char* arguments : {"field a.ply -n 4 -q -o out", "design a.ply -n 2 --saddle 5 -q -o out --json",
                                "field a.ply -n 4 -q -o x.vtp --curves c.json --threads 2"}) {
    const Scene scene{arguments};
    const Expected e = expect(folder, scene);
    for (const char* onwards : {"", "+"}) {
      for (int k = 0;; k += everything() ? 7 : 997) {
        reset(folder, scene);
        const std::string fault = "malloc:" + std::to_string(k) + onwards + ":ENOMEM";
        const Run run = run_with(folder, fault, arguments);
        if (!run.happened) break;
        const std::string said = CliFolder::read(folder.work().parent_path() / "err");
        // The C library's own last word, where a thread ends and there is no memory at all.
        if (*onwards == '+' && said.find("libgcc_s") != std::string::npos) continue;
        CAPTURE(std::string(arguments));
        CAPTURE(fault);
        CAPTURE(said);
        CHECK((run.exit == 7 || run.exit == 6 || run.exit == 3 || run.exit == 0));
        CHECK(whole(contents(folder), e));
        CHECK(said.find("Options::") == std::string::npos);  // advice is given in flags
        // Where nothing can be thrown any more a hidden folder stays, which the next run names.
        CHECK((hidden(folder) == 0 || said.starts_with("alcap: out of memory")));
      }
    }
  }
}
#endif
