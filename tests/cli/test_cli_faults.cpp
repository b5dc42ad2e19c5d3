// SPDX-License-Identifier: MIT
//
// What goes wrong around the tool and not in it: streams that are closed or full, signals, names that collide, pipes,
// little address space, runs that are killed.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "tests/cli/cli_runner.h"
#include "tests/support/portable.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

namespace {

bool has_warning(const Json& report, const char* code) {
  return std::any_of(report["warnings"].begin(), report["warnings"].end(),
                     [&](const Json& w) { return w["code"] == code; });
}

/// Names that begin with a dot.
std::int64_t hidden(const CliFolder& folder) {
  std::int64_t count = 0;
  for (const std::string& name : folder.files()) count += name.front() == '.' ? 1 : 0;
  return count;
}

/// Begins scripts whose runs may not write files, or are killed. A build that counts lines (preset coverage) writes its
/// counts when a run ends: these lose theirs, which would end the run or be cut in the middle.
constexpr const char* uncounted = "export GCOV_PREFIX=/dev/null/none; ";

}  // namespace

TEST_CASE("exit codes hold when nobody can read what is said") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(1));
  for (const char* stream : {"2>&-", "2>/dev/full", "2>&- >&-"}) {
    CAPTURE(stream);
    CHECK(folder.shell(std::string("$ALCAP field none.ply ") + stream) == 3);
    CHECK(folder.shell(std::string("$ALCAP field none.ply --json ") + stream) == 3);
    CHECK(folder.shell(std::string("$ALCAP field a.ply -n 0 ") + stream) == 2);
    CHECK(folder.shell(std::string("$ALCAP ") + stream) == 2);
    CHECK(folder.shell(std::string("$ALCAP field a.ply -q -o none/x.ply ") + stream) == 6);
  }
  CHECK(folder.shell("$ALCAP field a.ply -q 2>&- >&-") == 0);
  for (const char* what : {"--help", "field --help", "--version", "info a.ply", "info a.ply --json"}) {
    CAPTURE(what);
    CHECK(folder.shell(std::string("$ALCAP ") + what + " >/dev/full 2>/dev/null") == 6);
    CHECK(folder.shell(std::string("$ALCAP ") + what + " >&- 2>/dev/null") == 6);
  }
  // Nothing that was written took the place of a closed stream.
  CHECK(folder.shell("$ALCAP field a.ply -n 1 -o b.ply 2>&- >&- <&-") == 6);
  CHECK(folder.run("info b.ply").exit == 0);
}

TEST_CASE("signals while writing leave nothing behind, and those that are ignored stay so" *
          doctest::skip(test::portable)) {
  const CliFolder folder;
  folder.write("a.ply", icosphere(4));
  REQUIRE(folder.shell("mkfifo r.json c.json") == 0);
  // Opening a pipe waits for a reader: the tool is certainly writing then.
  const auto wait = std::string("$ALCAP field a.ply -q --report r.json & p=$!; sleep 1.5; ");
  CHECK(folder.shell("trap '' HUP; " + wait + "kill -HUP $p; sleep 0.3; cat r.json >read; wait $p") == 0);
  CHECK(Json::parse(CliFolder::read(folder.work() / "read"))["ok"] == true);
  CHECK(folder.shell("trap '' TERM; " + wait + "kill -TERM $p; sleep 0.3; cat r.json >read; wait $p") == 0);
  for (const char* signal : {"INT", "TERM", "HUP", "QUIT", "XCPU", "ALRM", "USR1"}) {
    CAPTURE(signal);
    // A shell without job control starts jobs that ignore INT and QUIT.
    CHECK(folder.shell("set -m; " + wait + "kill -" + signal + " $p; wait $p 2>/dev/null") == 130);
  }
  // A reader that leaves, and a file that may not grow.
  CHECK(folder.shell("head -c 1 c.json >/dev/null & $ALCAP field a.ply -q --curves c.json 2>/dev/null") == 6);
  const std::string limited = std::string(uncounted) + "ulimit -f 8; $ALCAP field a.ply -q -o ";
  CHECK(folder.shell(limited + "out 2>/dev/null") == 6);
  CHECK(folder.shell(limited + "out.ply 2>/dev/null") == 6);
  CHECK(hidden(folder) == 0);
  CHECK_FALSE(folder.files().contains("out"));
  CHECK_FALSE(folder.files().contains("out.ply"));
}

TEST_CASE("a run that is killed leaves complete results or none, and what it leaves is recognised" *
          doctest::skip(test::portable)) {
  const CliFolder folder;
  folder.write("a.ply", icosphere(4));
  CHECK(folder.shell(std::string(uncounted) +
                     "for i in $(seq 1 12); do $ALCAP field a.ply -n 4 -q -o out & p=$!; "
                     "sleep 0.0$((RANDOM % 10))$((RANDOM % 10)); kill -9 $p 2>/dev/null; wait $p 2>/dev/null; "
                     "if [ -e out ]; then $ALCAP view out -q --curves x.obj || exit 1; fi; done; exit 0") == 0);
  const std::set<std::string> before = folder.files();
  CHECK(folder.shell("mkdir .out.tmp-0123456789abcdef && echo x >.out.tmp-0123456789abcdef/field.ply") == 0);
  const CliResult result = folder.run("field a.ply -n 4 -o out --json");
  CHECK(result.exit == 0);
  CHECK(has_warning(result.json(), "leftover"));
  // Recognised, and not touched.
  CHECK(folder.files().contains(".out.tmp-0123456789abcdef/field.ply"));
  // One that is being written is none.
  CHECK(folder.shell("rm -r .out.tmp-*; mkdir .out.tmp-0; exec 9<.out.tmp-0; flock 9; "
                     "$ALCAP field a.ply -n 4 -o out --json >report") == 0);
  CHECK_FALSE(has_warning(folder.read_json("report"), "leftover"));
}

TEST_CASE("the dense method says what it takes on a mesh that is too large for it, and ends when it is told to" *
          doctest::skip(test::portable)) {
  const CliFolder folder;
  folder.write("a.ply", icosphere(4));
  const std::string begin =
      "set -m; $ALCAP field a.ply --method dense -o o.ply 2>err & p=$!; "
      "for i in $(seq 200); do grep -q 'for small meshes' err && break; sleep 0.1; done; ";
  CHECK(folder.shell(begin + "kill -INT $p; wait $p 2>/dev/null") == 130);
  CHECK(folder.shell("grep -q 'with 2,562 vertices it takes some 0.42 GB' err") == 0);
  CHECK_FALSE(folder.files().contains("o.ply"));
  // A small one is nothing to speak of.
  folder.write("b.ply", icosphere(2));
  CHECK(folder.run("field b.ply --method dense -o b2.ply").err.find("for small meshes") == std::string::npos);
}

TEST_CASE("outputs that would replace each other or an input are refused before anything is computed") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(1));
  folder.write("b.obj", icosphere(1));
  REQUIRE(folder.run("field a.ply -n 2 -q -o out").exit == 0);
  REQUIRE(folder.shell("ln -s a.ply link.ply; ln b.obj hard.vtp; cp out/field.ply f.ply; mkdir sub") == 0);
  const auto before = folder.files();
  for (const char* arguments :
       {"field a.ply -o x.ply --report x.ply", "field a.ply -o x.ply --report ./x.ply", "field a.ply -o a.ply",
        "field a.ply -o sub/../a.ply", "field a.ply -o link.ply", "field b.obj -o hard.vtp",
        "field a.ply --report a.ply", "field a.ply -o x.vtp --curves x.vtp",
        "field a.ply -o out --curves out/field.vtp", "field a.ply -o x.rawfield --report x.sings",
        "field a.ply --html x.html --report x.html", "ops a.ply f.ply -o x.csv --report x.csv",
        "ops a.ply f.ply --report f.ply", "view f.ply -o f.ply", "view out -o x.html --report x.html",
        "info a.ply --report a.ply", "design a.ply --source 1 --sink 9 -o x.ply --report x.ply"}) {
    CAPTURE(arguments);
    const CliResult result = folder.run(arguments);
    CAPTURE(result.err);
    CHECK(result.exit == 2);
    CHECK(folder.files() == before);
  }
  // Different names, and a pipe for both, are fine.
  CHECK(folder.run("field a.ply -n 1 -q -o x.ply --report x.json").exit == 0);
  CHECK(folder.run("field a.ply -n 1 -q -o out --report out/report.json").exit == 0);
  CHECK(folder.run("field a.ply -n 1 -q --report /dev/null").exit == 0);
}

TEST_CASE("a batch of nothing is an error") {
  const CliFolder folder;
  folder.write("list", std::string("# none\n\n"));
  CHECK(folder.run("field --batch list").exit == 3);
  CHECK(folder.run("field --batch none").exit == 3);
  CHECK(folder.run("field --batch /dev/zero").exit == 3);
}

TEST_CASE("symbolic links are followed to what is there, and refused before anything is computed where nothing is") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(1));
  REQUIRE(
      folder.shell("mkdir sub; touch sub/x.ply; ln -s sub/x.ply to.ply; ln -s none/x.ply lost.ply; ln -s none lost; "
                   "ln -s c.ply c.ply; ln -s sub/none.ply absent.ply; ln -s sub/none.json absent.json") == 0);
  CHECK(folder.run("field a.ply -n 1 -q -o to.ply").exit == 0);
  CHECK(std::filesystem::file_size(folder.work() / "sub/x.ply") > 0);
  CHECK(std::filesystem::is_symlink(folder.work() / "to.ply"));
  for (const char* name : {"lost.ply", "lost", "lost/", "c.ply", "absent.ply", "new.ply --report absent.json"}) {
    CAPTURE(name);
    CHECK(folder.run(std::string("field a.ply -n 1 -q -o ") + name).exit == 6);
  }
  CHECK_FALSE(folder.files().contains("sub/none.ply"));
  CHECK_FALSE(folder.files().contains("new.ply"));
  CHECK(hidden(folder) == 0);
}

TEST_CASE("names are shown without their control characters") {
  const CliFolder folder;
  folder.write("a\x1b[31m.ply", icosphere(1));
  for (const char* arguments : {"info $'a\\x1b[31m.ply'", "field $'a\\x1b[31m.ply' -o $'b\\x1b[2J.ply'",
                                "field $'no\\x1b\\nne.ply'", "field $'a\\x1b[31m.ply' -o $'c\\x1b\\x07.x'"}) {
    CAPTURE(arguments);
    (void)folder.shell(std::string("$ALCAP ") + arguments + " >said 2>&1");
    const std::string said = CliFolder::read(folder.work() / "said");
    CHECK(!said.empty());
    CHECK(said.find('\x1b') == std::string::npos);
    CHECK(said.find('\x07') == std::string::npos);
    if (!std::string(arguments).starts_with("info")) CHECK(said.find("\\x1b") != std::string::npos);
  }
}

TEST_CASE("pipes as inputs: read once, and given up when nobody writes" * doctest::skip(test::portable)) {
  const CliFolder folder;
  folder.write("a.ply", icosphere(2));
  REQUIRE(folder.run("field a.ply -n 2 -q -o out").exit == 0);
  CHECK(folder.shell("$ALCAP info <(cat a.ply) >/dev/null") == 0);
  CHECK(folder.shell("$ALCAP ops <(cat a.ply) <(cat out/field.ply) >/dev/null") == 0);
  CHECK(folder.shell("$ALCAP view <(cat out/field.ply) -q --curves x.obj >/dev/null") == 0);
  CHECK(folder.shell("$ALCAP design a.ply -n 2 --source 5 -q --guidance <(cat out/field.ply) >/dev/null") != 3);
  for (const char* arguments :
       {"info /dev/zero", "ops a.ply /dev/zero", "view /dev/zero --curves x.obj", "design a.ply --design /dev/zero",
        "design a.ply --stroke /dev/zero", "design a.ply --guidance /dev/zero --source 5"}) {
    CAPTURE(arguments);
    CHECK(folder.run(arguments).exit == 3);
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("with little address space the program ends and says so" * doctest::skip(test::portable)) {
  const CliFolder folder;
  folder.write("a.ply", icosphere(3));
  for (const char* limit : {"150000", "200000", "300000"}) {
    CAPTURE(limit);
    CHECK(folder.shell(std::string("ulimit -v ") + limit + "; timeout 20 $ALCAP --version >/dev/null 2>&1") == 0);
    const int code =
        folder.shell(std::string("ulimit -v ") + limit + "; timeout 20 $ALCAP field a.ply -q 2>said >/dev/null");
    CHECK((code == 0 || code == 7));
    CHECK((code == 0 || CliFolder::read(folder.work() / "said").starts_with("alcap")));
  }
}
#endif
